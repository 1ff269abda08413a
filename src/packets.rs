//! Packets: rays and hits as structures of arrays, up to 64 at a time.

use crate::hit::{Hit, HitPacket};
use crate::query::{Any, Closest};
use crate::ray::{Ray, RayPacket};
use crate::scene::Scene;
use crate::traverse::{self, FEWEST, Group, Outcome, PACKETS, Packet, PerRay};

impl Scene {
    /// [`Scene::closest`] of each ray of N packets, traced together where they go alike: a packet of 16 rays
    /// is `[RayPacket; 2]`. N is 1 to 8.
    ///
    /// Lanes whose ray is not valid, such as those with an empty interval, miss.
    ///
    /// ```
    /// use octogrid::{Ray, RayPacket, Scene, builtin};
    /// let scene = Scene::build(&builtin::cube().mesh()?, &Default::default())?;
    /// let rays: Vec<Ray> = (0..16).map(|i| Ray::new([0.01 * i as f32, 0.2, 9.0], [0.0, 0.0, -1.0])).collect();
    /// let [low, high] = scene.closest_packet(&[RayPacket::new(&rays), RayPacket::new(&rays[8..])]);
    /// assert_eq!(low.get(3), scene.closest(&rays[3]));
    /// assert_eq!(high.get(0), scene.closest(&rays[8]));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn closest_packet<const N: usize>(&self, packets: &[RayPacket; N]) -> [HitPacket; N] {
        let mut hits = [[Hit::MISS; RayPacket::LEN]; N];
        self.trace::<Closest, N>(packets, |packet, lane, hit| hits[packet][lane] = hit);
        hits.map(|hits| HitPacket::new(&hits))
    }

    /// [`Scene::occluded`] of each ray of N packets, as [`Scene::closest_packet`] does it: a bit a lane, set
    /// where there is a hit.
    pub fn occluded_packet<const N: usize>(&self, packets: &[RayPacket; N]) -> [u8; N] {
        let mut occluded = [0; N];
        self.trace::<Any, N>(packets, |packet, lane, found| occluded[packet] |= u8::from(found) << lane);
        occluded
    }

    fn trace<Q: PerRay, const N: usize>(
        &self,
        packets: &[RayPacket; N],
        mut answer: impl FnMut(usize, usize, Q::Answer),
    ) {
        const { assert!(1 <= N && N <= PACKETS, "one to eight packets") };
        let mut rays = [[Ray::new([0.0; 3], [0.0; 3]); RayPacket::LEN]; N];
        let mut lanes = [[(0, 0); RayPacket::LEN]; N];
        let mut answers = [[Q::up_to(0.0).answer(); RayPacket::LEN]; N];
        let (rays, lanes) = (rays.as_flattened_mut(), lanes.as_flattened_mut());
        let mut len = 0;
        for (i, packet) in packets.iter().enumerate() {
            for lane in 0..RayPacket::LEN {
                let ray = packet.get(lane);
                if ray.is_valid() {
                    (rays[len], lanes[len]) = (ray, (i, lane));
                    len += 1;
                }
            }
        }
        let (rays, answers) = (&rays[..len], &mut answers.as_flattened_mut()[..len]);
        if !self.trace_together::<Q, N>(rays, answers) {
            self.each_ray::<Q>(rays, answers);
        }
        answers.iter().zip(lanes).for_each(|(&found, &mut (packet, lane))| answer(packet, lane, found));
    }

    /// False where the rays don't go alike, and nothing is answered. Groups are large: none is made for rays apart.
    fn trace_together<Q: PerRay, const N: usize>(&self, rays: &[Ray], answers: &mut [Q::Answer]) -> bool {
        if rays.len() < FEWEST || !point_alike(rays) {
            return false;
        }
        let mut packets = [Packet::ZERO; N];
        let mut group = Group::new(&mut packets);
        traverse::group::<Q>(self.isa, &self.arena, &mut group, rays, answers) == Outcome::Answered
    }
}

/// Whether all directions are near the first: cheap where they are not, as the first that is not ends it.
fn point_alike(rays: &[Ray]) -> bool {
    const COSINE: f32 = 0.9;
    let first = rays[0].dir.normalize_or_zero();
    rays.iter().all(|ray| ray.dir.dot(first) > COSINE * ray.dir.length())
}
