//! The clusters of a leaf against a group of rays, in four steps:
//!
//! 1. sixteen cluster boxes against the frustum,
//! 2. one box against sixteen rays, two packets at a time,
//! 3. the cluster's eight triangles against the [`Bundle`](crate::bundle::Bundle) of all lines,
//! 4. one triangle against eight rays ([`Prepared`]).
//!
//! Most hits are decided last, eight rays at a time ([`Nearest`](crate::traverse::nearest::Nearest)). A cluster that
//! fewer than [`FEW`] rays meet is tested ray by ray instead of 3 and 4, and one with many triangles left after 3
//! against the packets of which few rays meet it instead of 4.
//!
//! # Errors
//! What is left out is certainly not met: see [`group`](crate::traverse::group) for rays against boxes, `Bundle` and
//! `Prepared` for triangles. Decisions are those of single rays.

use super::Coherent;
use crate::arena::BoxGroup;
use crate::filter::{Certain, RayLanes, products};
use crate::lanes::{Doubles, Lanes, WIDTH};
use crate::prepared::Prepared;
use crate::query::{EdgeRule, Query, Wanted};
use crate::traverse::group::{EXPONENT, Packet, SCALED};
use crate::traverse::nearest::Source;
use crate::triangle::intersect;

/// Fewer rays that meet a cluster's box are tested one by one.
const FEW: u32 = 12;

/// Clusters tested last, with the rays that have been tested.
pub(super) struct Mailbox {
    recent: [(u32, u64); 8],
    next: usize,
}

impl Default for Mailbox {
    #[inline(always)]
    fn default() -> Self {
        Self { recent: [(u32::MAX, 0); 8], next: 0 }
    }
}

impl Mailbox {
    /// The rays of `rays` that have not been tested against a cluster; they count as tested afterwards.
    #[inline(always)]
    fn new_ones(&mut self, cluster: u32, rays: u64) -> u64 {
        for entry in &mut self.recent {
            if entry.0 == cluster {
                let new = rays & !entry.1;
                entry.1 |= rays;
                return new;
            }
        }
        self.recent[self.next] = (cluster, rays);
        self.next = (self.next + 1) % self.recent.len();
        rays
    }
}

impl<L: Doubles, Q: Query> Coherent<'_, '_, L, Q> {
    /// The clusters of a leaf.
    #[inline(never)]
    pub(super) fn groups(&mut self, first: u32) {
        self.lanes.vectorize(
            #[inline(always)]
            || self.leaf(first),
        );
    }

    #[inline(always)]
    fn leaf(&mut self, first: u32) {
        let arena = self.arena;
        for group in &arena.groups[first as usize..] {
            if !self.spend() {
                return;
            }
            let mut met = self.frustum.boxes(self.lanes, group);
            while met != 0 {
                let lane = met.trailing_zeros() as usize;
                met &= met - 1;
                if !self.spend() {
                    return;
                }
                let rays = self.meet(group, lane);
                if rays == 0 {
                    continue;
                }
                let index = group.clusters[lane].cluster();
                let rays = self.mailbox.new_ones(index, rays);
                if rays != 0 {
                    self.cluster(index, rays);
                }
            }
            if group.clusters[0].is_last() {
                break;
            }
        }
    }

    /// The rays that meet a box, as bits.
    #[inline(always)]
    fn meet(&self, group: &BoxGroup, lane: usize) -> u64 {
        let mut rays = 0;
        for (i, two) in self.group.packets[..self.group.packets()].chunks(2).enumerate() {
            let bits = self.two_packets(group, lane, &two[0], &two[two.len() - 1]);
            let there = if two.len() == 2 { 0xffff } else { 0xff };
            rays |= u64::from(bits & there) << (2 * WIDTH * i);
        }
        rays
    }

    /// Those of two packets.
    #[inline(always)]
    fn two_packets(&self, group: &BoxGroup, lane: usize, first: &Packet, second: &Packet) -> u32 {
        let lanes = self.lanes;
        let plane = |side: usize, axis: usize| lanes.splat16(group.planes[side][axis][lane]);
        // Not stored as sixteen: spans change eight at a time, and a load waits for two stores.
        let load = |a: &[f32; WIDTH], b: &[f32; WIDTH]| lanes.join(lanes.load(a), lanes.load(b));
        let (main, others) = (self.group.main, self.group.others);
        let from = lanes.max16(plane(0, main), load(&first.span[0], &second.span[0]));
        let to = lanes.min16(plane(1, main), load(&first.span[1], &second.span[1]));
        let mut apart = lanes.less16(to, from);
        for side in 0..2 {
            let slope = load(&first.slope[side], &second.slope[side]);
            let at = load(&first.at[side], &second.at[side]);
            let (p, q) = (lanes.mul_add16(from, slope, at), lanes.mul_add16(to, slope, at));
            let (low, high) = (plane(0, others[side]), plane(1, others[side]));
            apart = apart | lanes.less16(lanes.max16(p, q), low) | lanes.less16(high, lanes.min16(p, q));
        }
        !lanes.bits16(apart)
    }

    /// A cluster against the rays that meet its box.
    #[inline(always)]
    fn cluster(&mut self, index: u32, rays: u64) {
        let cluster = &self.arena.clusters[index as usize];
        let triangles = if rays.count_ones() < FEW {
            None
        } else {
            Some(self.bundle.candidates(self.lanes, cluster) & u32::from(cluster.occupied()))
        };
        let (mut many, mut singles) = (0u32, rays);
        if let Some(triangles) = triangles {
            for i in 0..self.group.packets() {
                let packet = rays & 0xff << (8 * i);
                // A triangle against a packet takes some 0.8 of the time of a cluster against a ray.
                if packet != 0 && 4 * triangles.count_ones() <= 5 * packet.count_ones() {
                    many |= 1 << i;
                    singles &= !packet;
                }
            }
        }
        let mut narrower = 0u32;
        while singles != 0 {
            let ray = singles.trailing_zeros() as usize;
            singles &= singles - 1;
            let (i, lane) = (ray / WIDTH, ray % WIDTH);
            narrower |= u32::from(self.single(index, i, lane)) << i;
        }
        if let Some(triangles) = triangles
            && many != 0
        {
            narrower |= self.packets(index, triangles, rays, many);
        }
        while narrower != 0 {
            let i = narrower.trailing_zeros() as usize;
            narrower &= narrower - 1;
            self.narrow_packet(i);
        }
    }

    /// A cluster against one ray; whether a hit is closer than those before.
    #[inline(always)]
    fn single(&mut self, index: u32, i: usize, lane: usize) -> bool {
        let (lanes, cluster) = (self.lanes, &self.arena.clusters[index as usize]);
        let packet = &self.group.packets[i];
        let three = |v: &[[f32; WIDTH]; 3]| {
            [lanes.splat(v[0][lane]), lanes.splat(v[1][lane]), lanes.splat(v[2][lane])]
        };
        let ray = RayLanes {
            origin: three(&packet.origin),
            dir: three(&packet.scaled),
            bound: lanes.splat(SCALED),
            t_min: lanes.splat(packet.t_min[lane]),
            t_max: lanes.splat(packet.t_max[lane]),
        };
        let bounded = products(lanes, &ray, cluster.lanes(lanes)).bounded(lanes, &ray);
        let mut bits = bounded.possible(lanes, &ray) & u32::from(cluster.occupied());
        if bits == 0 {
            return false;
        }
        let after = lanes.splat(packet.after[lane]);
        let certain =
            Unscaled::new(lanes, &bounded.certain(lanes, &ray), lanes.splat(packet.unit[lane]), after);
        let mut closer = false;
        while bits != 0 {
            let triangle = bits.trailing_zeros();
            bits &= bits - 1;
            let sure = if certain.lanes >> triangle & 1 != 0 { 1 << lane } else { 0 };
            let at = |x: L::F32| lanes.splat(lanes.lane(x, triangle as usize));
            let bounds = [at(certain.low), at(certain.high)];
            closer |= self.hits(i, 1 << lane, sure, bounds, Source { cluster: index, lane: triangle }) != 0;
        }
        closer
    }

    /// Triangles of a cluster against the packets in `many`; those in which a hit is closer than those before.
    #[inline(always)]
    fn packets(&mut self, index: u32, mut triangles: u32, rays: u64, many: u32) -> u32 {
        let (lanes, cluster) = (self.lanes, &self.arena.clusters[index as usize]);
        let mut narrower = 0u32;
        while triangles != 0 {
            let triangle = triangles.trailing_zeros();
            triangles &= triangles - 1;
            let source = Source { cluster: index, lane: triangle };
            let prepared = Prepared::new(lanes, cluster.triangle(triangle as usize));
            let mut left = many;
            while left != 0 {
                let i = left.trailing_zeros() as usize;
                left &= left - 1;
                let packet = &self.group.packets[i];
                let ray = packet.lanes(lanes);
                let bounded = prepared.bounded(lanes, &ray);
                let bits = bounded.possible(lanes, &ray) & (rays >> (8 * i)) as u32 & 0xff;
                if bits != 0 {
                    let (unit, after) = (lanes.load(&packet.unit), lanes.load(&packet.after));
                    let certain = Unscaled::new(lanes, &bounded.certain(lanes, &ray), unit, after);
                    let bounds = [certain.low, certain.high];
                    let closer = self.hits(i, bits, bits & certain.lanes, bounds, source);
                    narrower |= u32::from(closer != 0) << i;
                }
            }
        }
        narrower
    }

    /// Rays of a packet may hit a triangle; some certainly do, with t between two bounds. The lanes whose hit is closer
    /// than those before.
    #[inline(always)]
    fn hits(&mut self, i: usize, possible: u32, certain: u32, bounds: [L::F32; 2], source: Source) -> u32 {
        let lanes = self.lanes;
        let prim = self.arena.clusters[source.cluster as usize].ids()[source.lane as usize];
        let nearest = &mut self.group.packets[i].nearest;
        let [mut closer, unclear] = match Q::WANTED {
            Wanted::Any => nearest.note(lanes, certain, bounds[1], prim),
            _ => nearest.defer(lanes, certain, bounds, prim, source),
        };
        let mut left = possible & !certain | unclear;
        while left != 0 {
            let lane = left.trailing_zeros();
            left &= left - 1;
            closer |= u32::from(self.decide(i, lane as usize, source, prim)) << lane;
        }
        closer
    }

    #[cold]
    #[inline(never)]
    fn decide(&mut self, i: usize, lane: usize, source: Source, prim: u32) -> bool {
        let ray = self.group.line(i, lane);
        let corners = self.arena.clusters[source.cluster as usize].triangle(source.lane as usize);
        let packet = &mut self.group.packets[i];
        match intersect(&ray, corners, EdgeRule::Closed) {
            Some(at) if at.t > packet.after[lane] => packet.nearest.take(self.arena, &ray, lane, at, prim),
            _ => false,
        }
    }

    /// Follows hits that are closer.
    #[inline(always)]
    fn narrow_packet(&mut self, i: usize) {
        self.changed = true;
        let (rises, slack) = (self.group.rises, self.group.slack);
        let packet = &mut self.group.packets[i];
        if Q::WANTED == Wanted::Any {
            packet.finish(self.lanes)
        } else {
            packet.shorten(self.lanes, rises, slack)
        }
    }
}

/// [`Certain`] hits in units of the rays' own t.
struct Unscaled<L: Lanes> {
    lanes: u32,
    low: L::F32,
    high: L::F32,
}

impl<L: Lanes> Unscaled<L> {
    /// Powers of two scale without rounding, where nothing overflows or underflows; what is not after the open
    /// end of the interval, which the scaled one contains, is not certain. The other end is left to [`Nearest`](
    /// crate::traverse::nearest::Nearest).
    #[inline(always)]
    fn new(lanes: L, certain: &Certain<L>, unit: L::F32, after: L::F32) -> Self {
        let (low, high) = (certain.low * unit, certain.high * unit);
        let within = lanes.less(lanes.max(after, lanes.splat(2f32.powi(-EXPONENT))), low)
            & lanes.less(high, lanes.splat(2f32.powi(EXPONENT)));
        Self { lanes: certain.lanes & lanes.bits(within), low, high }
    }
}
