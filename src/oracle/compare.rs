//! Comparing one scene's answers, and those of brute force, with what they must be.

#[cfg(feature = "parallel")]
use std::collections::BTreeMap;
use std::fmt::Debug;
#[cfg(feature = "parallel")]
use std::sync::{Arc, Mutex};

#[cfg(feature = "parallel")]
use rayon::{ThreadPool, ThreadPoolBuilder};

use super::disagreement::Disagreement;
use super::scan::Answer;
use crate::hit::Hit;
use crate::lanes::Isa;
use crate::mesh::TriMesh;
use crate::query::{All, Any, Closest, Counting};
use crate::ray::{Ray, RayPacket};
use crate::scene::{AllHits, Scene};

/// Compares brute force with exact arithmetic: t and triangles bit for bit, u and v (both rounded) to
/// within one unit in the last place plus 2^-27.
pub(super) fn with_exact(
    mesh: &TriMesh<'_>,
    ray: &Ray,
    brute: &Answer,
    exact: &Answer,
) -> Result<(), Box<Disagreement>> {
    let near = brute.all.len() == exact.all.len() && brute.all.iter().zip(&exact.all).all(close);
    if close((&brute.closest, &exact.closest)) && brute.occluded == exact.occluded && near {
        return Ok(());
    }
    let prims = prims(brute).chain(prims(exact));
    Err(Disagreement::new("brute force", "exact answers", exact, brute).on(ray, mesh, prims))
}

fn close((a, b): (&Hit, &Hit)) -> bool {
    let within = |x: f32, y: f32| {
        let unit = f64::from(y.abs().next_up()) - f64::from(y.abs());
        (f64::from(x) - f64::from(y)).abs() <= unit + 0.5f64.powi(27)
    };
    a.prim == b.prim && a.t.to_bits() == b.t.to_bits() && within(a.u, b.u) && within(a.v, b.v)
}

/// A scene under test.
pub(super) struct Subject<'a> {
    scene: Scene,
    mesh: TriMesh<'a>,
    name: String,
}

impl<'a> Subject<'a> {
    /// Takes a scene whose own invariants hold.
    pub(super) fn new(scene: Scene, mesh: &TriMesh<'a>, isa: Isa) -> Result<Self, Box<Disagreement>> {
        let name = format!("{}, {isa}", scene.structure());
        match scene.validate() {
            Ok(_) => Ok(Self { scene, mesh: *mesh, name }),
            Err(violation) => Err(Disagreement::new(name, "validate", &"a valid structure", &violation)),
        }
    }

    /// The same, saved and loaded.
    #[cfg(feature = "file")]
    pub(super) fn reload(self) -> Result<Self, crate::LoadError> {
        let mut file = Vec::new();
        self.scene.save(&mut file)?;
        let mut scene = Scene::load(&file[..])?;
        // What it is queried with is not of the file.
        (scene.isa, scene.walk) = (self.scene.isa, self.scene.walk);
        Ok(Self { scene, name: format!("{}, loaded", self.name), ..self })
    }

    /// Every query on one ray. The number of comparisons.
    pub(super) fn one_by_one(&self, ray: &Ray, answer: &Answer) -> Result<usize, Box<Disagreement>> {
        self.closest("closest", ray, answer, self.scene.closest(ray))?;
        self.occluded("occluded", ray, answer, self.scene.occluded(ray))?;
        let mut hits = vec![Hit::MISS; answer.all.len() + 1];
        let result = self.scene.all(ray, &mut hits);
        self.all("all", ray, answer, result, &hits)?;
        Ok(3)
    }

    /// Counting queries, and buffers that are just large enough and too small, on one ray. The number
    /// of comparisons.
    pub(super) fn decorated(&self, ray: &Ray, answer: &Answer) -> Result<usize, Box<Disagreement>> {
        let mut query = Counting::new(Closest::new(ray.t_max));
        self.scene.query(ray, &mut query);
        self.closest("counted closest", ray, answer, query.query().hit())?;
        let mut query = Counting::new(Any::new(ray.t_max));
        self.scene.query(ray, &mut query);
        self.occluded("counted occluded", ray, answer, query.query().found())?;

        let len = answer.all.len();
        let rooms = [len, len / 2, len.saturating_sub(1)];
        for room in rooms {
            let mut hits = vec![Hit::MISS; room];
            let result = self.scene.all(ray, &mut hits);
            self.all("all", ray, answer, result, &hits)?;

            let mut hits = vec![Hit::MISS; room];
            let mut query = Counting::new(All::new(ray.t_max, &mut hits));
            self.scene.query(ray, &mut query);
            let result = AllHits { len: query.query().len(), complete: query.query().is_complete() };
            self.all("counted all", ray, answer, result, &hits)?;
        }
        Ok(2 + 2 * rooms.len())
    }

    /// Every query on all rays at once in a pool of that many threads. The number of comparisons.
    #[cfg(feature = "parallel")]
    pub(super) fn batches(
        &self,
        threads: usize,
        rays: &[Ray],
        answers: &[Answer],
    ) -> Result<usize, Box<Disagreement>> {
        let mut closest = vec![Hit::MISS; rays.len()];
        let mut occluded = vec![false; rays.len()];
        let (mut streamed, mut shadowed) = (closest.clone(), occluded.clone());
        let lists = pool(threads).install(|| {
            self.scene.closest_batch(rays, &mut closest);
            self.scene.occluded_batch(rays, &mut occluded);
            self.scene.closest_stream(rays, &mut streamed);
            self.scene.occluded_stream(rays, &mut shadowed);
            self.scene.all_batch(rays)
        });
        let (ends, expected) = (lists.offsets.len(), rays.len() + 1);
        if ends != expected {
            return Err(Disagreement::new(&self.name, "number of offsets of all_batch", &expected, &ends));
        }
        let names = ["closest_batch", "occluded_batch", "all_batch", "closest_stream", "occluded_stream"];
        let names = names.map(|query| format!("{query}, {threads} threads"));
        for (i, (ray, answer)) in rays.iter().zip(answers).enumerate() {
            self.closest(&names[0], ray, answer, closest[i])?;
            self.occluded(&names[1], ray, answer, occluded[i])?;
            self.closest(&names[3], ray, answer, streamed[i])?;
            self.occluded(&names[4], ray, answer, shadowed[i])?;
            let hits = lists.hits.get(lists.offsets[i]..lists.offsets[i + 1]).unwrap_or(&[]);
            if !equal(hits, &answer.all) {
                return self.differ(&names[2], ray, answer, &answer.all, &hits, hits);
            }
        }
        Ok(5 * rays.len())
    }

    /// Packets of two and eight times eight rays. The number of comparisons.
    pub(super) fn packets(&self, rays: &[Ray], answers: &[Answer]) -> Result<usize, Box<Disagreement>> {
        Ok(self.packets_of::<2>(rays, answers)? + self.packets_of::<8>(rays, answers)?)
    }

    fn packets_of<const N: usize>(
        &self,
        rays: &[Ray],
        answers: &[Answer],
    ) -> Result<usize, Box<Disagreement>> {
        let len = N * RayPacket::LEN;
        let names = ["closest_packet", "occluded_packet"].map(|query| format!("{query} of {len} rays"));
        for (rays, answers) in rays.chunks(len).zip(answers.chunks(len)) {
            let part = |i: usize| rays.get(i * RayPacket::LEN..).unwrap_or(&[]);
            let packets = std::array::from_fn::<_, N, _>(|i| RayPacket::new(part(i)));
            let (hits, occluded) =
                (self.scene.closest_packet(&packets), self.scene.occluded_packet(&packets));
            for (i, (ray, answer)) in rays.iter().zip(answers).enumerate() {
                let (packet, lane) = (i / RayPacket::LEN, i % RayPacket::LEN);
                self.closest(&names[0], ray, answer, hits[packet].get(lane))?;
                self.occluded(&names[1], ray, answer, occluded[packet] >> lane & 1 != 0)?;
            }
        }
        Ok(2 * rays.len())
    }

    fn closest(&self, query: &str, ray: &Ray, answer: &Answer, found: Hit) -> Result<(), Box<Disagreement>> {
        match bits(&found) == bits(&answer.closest) {
            true => Ok(()),
            false => self.differ(query, ray, answer, &answer.closest, &found, &[found]),
        }
    }

    fn occluded(
        &self,
        query: &str,
        ray: &Ray,
        answer: &Answer,
        found: bool,
    ) -> Result<(), Box<Disagreement>> {
        match found == answer.occluded {
            true => Ok(()),
            false => self.differ(query, ray, answer, &answer.occluded, &found, &[]),
        }
    }

    /// All hits in a buffer, which may have had room for the first ones only.
    fn all(
        &self,
        query: &str,
        ray: &Ray,
        answer: &Answer,
        result: AllHits,
        buffer: &[Hit],
    ) -> Result<(), Box<Disagreement>> {
        let first = &answer.all[..buffer.len().min(answer.all.len())];
        let expected = AllHits { len: first.len(), complete: first.len() == answer.all.len() };
        let found = &buffer[..result.len.min(buffer.len())];
        if result == expected && equal(found, first) {
            return Ok(());
        }
        let query = format!("{query}, room for {}", buffer.len());
        self.differ(&query, ray, answer, &(expected, first), &(result, found), found)
    }

    /// The error of a scene that answers `found`, with the triangles of `hits`.
    fn differ<T>(
        &self,
        query: &str,
        ray: &Ray,
        answer: &Answer,
        expected: &dyn Debug,
        found: &dyn Debug,
        hits: &[Hit],
    ) -> Result<T, Box<Disagreement>> {
        let prims = prims(answer).chain(hits.iter().map(|hit| hit.prim));
        Err(Disagreement::new(&self.name, query, expected, found).on(ray, &self.mesh, prims))
    }
}

/// A pool of that many threads. Starting one takes longer than a small case, so each is kept.
#[cfg(feature = "parallel")]
fn pool(threads: usize) -> Arc<ThreadPool> {
    static POOLS: Mutex<BTreeMap<usize, Arc<ThreadPool>>> = Mutex::new(BTreeMap::new());
    let start =
        || Arc::new(ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool of threads"));
    POOLS.lock().expect("all pools have started").entry(threads).or_insert_with(start).clone()
}

/// The triangles of an answer.
fn prims(answer: &Answer) -> impl Iterator<Item = u32> {
    answer.all.iter().map(|hit| hit.prim).chain([answer.closest.prim])
}

fn equal(a: &[Hit], b: &[Hit]) -> bool {
    a.len() == b.len() && a.iter().map(bits).eq(b.iter().map(bits))
}

fn bits(hit: &Hit) -> [u32; 4] {
    bytemuck::cast(*hit)
}
