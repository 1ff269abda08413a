//! The walk of a group of rays through the hybrid.
//!
//! The cells and voxels between the [`Frustum`]'s lines are visited slice by slice along the main axis, in the
//! order in which the rays come to the slices; within a slice in any order, as the closest hit is decided by
//! (t, index) alone. What a group meets is found in four steps, each on eight lanes:
//!
//! 1. eight cluster boxes against the frustum,
//! 2. one box against eight rays, packet by packet,
//! 3. the cluster's eight triangles against the [`Bundle`] of all lines,
//! 4. one triangle against eight rays ([`Prepared`]).
//!
//! Most hits are decided last, eight rays at a time ([`Nearest`](super::nearest::Nearest)). Where fewer than
//! [`MANY`] rays of a packet meet a box, the cluster is tested ray by ray instead of 3 and 4.
//!
//! Source: I. Wald, T. Ize, A. Kensler, A. Knoll, S. G. Parker, "Ray Tracing Animated Scenes using Coherent
//! Grid Traversal", 2006, for walking slices with a frustum; the steps are ours.
//!
//! # Errors
//! What is left out is certainly not met: see [`group`](super::group) for rays against boxes, [`frustum`](
//! super::frustum) for groups against voxels, [`Bundle`] and [`Prepared`] for triangles. Decisions are those
//! of single rays.

use std::marker::PhantomData;

use super::frustum::{Frustum, span};
use super::group::{Group, LONGEST, Packet, SCALED};
use super::nearest::Source;
use crate::arena::{Arena, BoxGroup, Voxel};
use crate::bundle::Bundle;
use crate::filter::{Certain, RayLanes, products};
use crate::lanes::{Doubles, Lanes, WIDTH};
use crate::prepared::Prepared;
use crate::query::{EdgeRule, Query, Wanted};
use crate::triangle::intersect;

/// Clusters tested last, with the rays that have been tested.
struct Mailbox {
    recent: [(u32, u64); 8],
    next: usize,
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

/// Groups that spread farther, in sizes of the grid, are not traced together.
const WIDEST: f32 = 0.2;

/// What a group may do for each of its rays: visit a voxel, test a group of boxes, or test a box against its
/// rays. Where it does more, as with rays that are far apart in the scale of what they meet, they are faster
/// alone.
const EFFORT: u32 = 8;

/// Traces a group.
pub(crate) struct Coherent<'a, 'b, L, Q> {
    lanes: L,
    arena: &'a Arena,
    group: &'a mut Group<'b>,
    mailbox: Mailbox,
    frustum: Frustum,
    bundle: Bundle,
    changed: bool,
    /// What of the [`EFFORT`] is left.
    effort: u32,
    query: PhantomData<Q>,
}

impl<'a, 'b, L: Doubles, Q: Query> Coherent<'a, 'b, L, Q> {
    /// Traces a group; false where it spreads too far, and its hits mean nothing.
    #[inline(always)]
    pub(crate) fn run(lanes: L, arena: &'a Arena, group: &'a mut Group<'b>) -> bool {
        let longest = arena.grid.longest() as f32;
        let Some(frustum) = Frustum::around(lanes, group, longest) else { return true };
        if frustum.width() > WIDEST * longest {
            return false;
        }
        let bundle = frustum.bundle(&arena.grid);
        let effort = EFFORT * group.len as u32;
        let mailbox = Mailbox { recent: [(u32::MAX, 0); 8], next: 0 };
        let mut walk = Self {
            lanes,
            arena,
            group,
            mailbox,
            frustum,
            bundle,
            changed: false,
            effort,
            query: PhantomData,
        };
        walk.slices();
        if walk.effort > 0 {
            walk.finish();
        }
        walk.effort > 0
    }

    /// Decides which hits are the closest.
    #[inline(always)]
    fn finish(&mut self) {
        for i in 0..self.group.packets() {
            let Packet { nearest, origin, dir, .. } = &mut self.group.packets[i];
            nearest.finish(self.lanes, self.arena, origin, dir);
        }
    }

    /// Does a part of the effort; false where there was none left.
    #[inline(always)]
    fn spend(&mut self) -> bool {
        self.effort = self.effort.saturating_sub(1);
        self.effort > 0
    }

    /// Slice after slice of the top grid.
    #[inline(always)]
    fn slices(&mut self) {
        let grid = &self.arena.grid;
        let strides = grid.strides();
        let (main, [u, v]) = (self.group.main, self.group.others);
        let last = (grid.dims[main] - 1) as f32;
        let ends = self.frustum.span.map(|x| x.clamp(0.0, last) as u32);
        let (mut slice, count) = if self.group.rises {
            (ends[0], ends[1] - ends[0] + 1)
        } else {
            (ends[1], ends[1] - ends[0] + 1)
        };
        for _ in 0..count {
            if self.changed && !self.narrow() {
                return;
            }
            let (a, b) = (slice as f32, slice as f32 + 1.0);
            let (a, b) = (a.max(self.frustum.span[0]), b.min(self.frustum.span[1]));
            // Beyond the first and last cell is the grid's border, which rounding may reach.
            if a <= b {
                let range = |side: usize| {
                    let most = grid.dims[self.group.others[side]] as f32;
                    let [low, high] = self.frustum.range(side, a, b);
                    (low < most && high >= 0.0).then(|| low.max(0.0) as u32..=high.min(most - 1.0) as u32)
                };
                if let (Some(us), Some(vs)) = (range(0), range(1)) {
                    for j in vs {
                        for i in us.clone() {
                            if !self.spend() {
                                return;
                            }
                            let index = slice * strides[main] + i * strides[u] + j * strides[v];
                            match self.arena.words[index as usize].get() {
                                Voxel::Empty => {}
                                Voxel::Leaf(first) => self.groups(first),
                                Voxel::Node(brick) => {
                                    let mut lo = [0.0; 3];
                                    lo[main] = slice as f32;
                                    lo[u] = i as f32;
                                    lo[v] = j as f32;
                                    self.brick(brick, lo, 0.25);
                                }
                            }
                        }
                    }
                }
            }
            slice = if self.group.rises { slice + 1 } else { slice.wrapping_sub(1) };
        }
    }

    /// Fits the frustum to the rays that go on; false where there are none.
    #[inline(always)]
    fn narrow(&mut self) -> bool {
        self.changed = false;
        let span = span(self.lanes, self.group);
        self.frustum.span = span;
        span[0] <= span[1]
    }

    /// The voxels of a brick, slice after slice.
    fn brick(&mut self, brick: u32, lo: [f32; 3], side: f32) {
        self.lanes.vectorize(
            #[inline(always)]
            || self.voxels(brick, lo, side),
        );
    }

    #[inline(always)]
    fn voxels(&mut self, brick: u32, lo: [f32; 3], side: f32) {
        let brick = self.arena.bricks[brick as usize];
        let (main, [u, v]) = (self.group.main, self.group.others);
        for k in 0..4 {
            if self.changed && !self.narrow() {
                return;
            }
            let slice = if self.group.rises { k } else { 3 - k };
            let a = lo[main] + slice as f32 * side;
            let (from, to) = (a.max(self.frustum.span[0]), (a + side).min(self.frustum.span[1]));
            if from > to {
                continue;
            }
            let range = |s: usize, axis: usize| {
                let [low, high] = self.frustum.range(s, from, to);
                let (low, high) = ((low - lo[axis]) / side, (high - lo[axis]) / side);
                if low < 4.0 && high >= 0.0 {
                    let (low, high) = (low.max(0.0) as u32, high.min(3.0) as u32);
                    (2u32 << high) - (1 << low)
                } else {
                    0
                }
            };
            let mask =
                SPREAD[main][1 << slice] & SPREAD[u][range(0, u) as usize] & SPREAD[v][range(1, v) as usize];
            let mut mask = mask & brick.occupied;
            while mask != 0 {
                if !self.spend() {
                    return;
                }
                let bit = mask.trailing_zeros();
                mask &= mask - 1;
                let word = brick.first + (brick.occupied & ((1 << bit) - 1)).count_ones();
                match self.arena.words[word as usize].get() {
                    Voxel::Empty => {}
                    Voxel::Leaf(first) => self.groups(first),
                    Voxel::Node(below) => {
                        let at = |axis: usize| lo[axis] + (bit >> (2 * axis) & 3) as f32 * side;
                        self.brick(below, [at(0), at(1), at(2)], 0.25 * side);
                    }
                }
            }
        }
    }

    /// The clusters of a leaf.
    #[inline(never)]
    fn groups(&mut self, first: u32) {
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
        let lanes = self.lanes;
        let plane = |side: usize, axis: usize| lanes.splat(group.planes[side][axis][lane]);
        let (main, [u, v]) = (self.group.main, self.group.others);
        let (x0, x1) = (plane(0, main), plane(1, main));
        let (u0, u1, v0, v1) = (plane(0, u), plane(1, u), plane(0, v), plane(1, v));
        let mut rays = 0;
        for (i, packet) in self.group.packets[..self.group.packets()].iter().enumerate() {
            let a = lanes.max(x0, lanes.load(&packet.span[0]));
            let b = lanes.min(x1, lanes.load(&packet.span[1]));
            let line = |side: usize, x: L::F32| {
                lanes.mul_add(x, lanes.load(&packet.slope[side]), lanes.load(&packet.at[side]))
            };
            let (p, q) = (line(0, a), line(0, b));
            let (r, s) = (line(1, a), line(1, b));
            let apart = lanes.less(b, a)
                | lanes.less(lanes.max(p, q), u0)
                | lanes.less(u1, lanes.min(p, q))
                | lanes.less(lanes.max(r, s), v0)
                | lanes.less(v1, lanes.min(r, s));
            rays |= u64::from(!lanes.bits(apart) & 0xff) << (8 * i);
        }
        rays
    }

    /// A cluster against the rays that meet its box.
    #[inline(always)]
    fn cluster(&mut self, index: u32, rays: u64) {
        let mut many = 0u32;
        for i in 0..self.group.packets() {
            let mut active = (rays >> (8 * i)) as u32 & 0xff;
            if active.count_ones() >= MANY {
                many |= 1 << i;
                continue;
            }
            let mut closer = false;
            while active != 0 {
                let lane = active.trailing_zeros() as usize;
                active &= active - 1;
                closer |= self.single(index, i, lane);
            }
            self.narrow_packet(i, closer);
        }
        if many != 0 {
            self.packets(index, rays, many);
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
            closer |= self.hit(i, lane, Source { cluster: index, lane: triangle }, certain.at(triangle));
        }
        closer
    }

    /// The triangles of a cluster against the packets in `many`.
    #[inline(always)]
    fn packets(&mut self, index: u32, rays: u64, many: u32) {
        let (lanes, cluster) = (self.lanes, &self.arena.clusters[index as usize]);
        let mut triangles = self.bundle.candidates(lanes, cluster) & u32::from(cluster.occupied());
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
                let mut bits = bounded.possible(lanes, &ray) & (rays >> (8 * i)) as u32 & 0xff;
                if bits != 0 {
                    let (unit, after) = (lanes.load(&packet.unit), lanes.load(&packet.after));
                    let certain = Unscaled::new(lanes, &bounded.certain(lanes, &ray), unit, after);
                    while bits != 0 {
                        let lane = bits.trailing_zeros();
                        bits &= bits - 1;
                        let closer = self.hit(i, lane as usize, source, certain.at(lane));
                        narrower |= u32::from(closer) << i;
                    }
                }
            }
        }
        while narrower != 0 {
            let i = narrower.trailing_zeros() as usize;
            narrower &= narrower - 1;
            self.narrow_packet(i, true);
        }
    }

    /// A ray may hit a triangle, or does so with t between two bounds; whether the hit is closer than those before.
    #[inline(always)]
    fn hit(&mut self, i: usize, lane: usize, source: Source, certain: Option<[f32; 2]>) -> bool {
        let prim = self.arena.clusters[source.cluster as usize].ids()[source.lane as usize];
        let packet = &mut self.group.packets[i];
        if let Some(bounds) = certain {
            if Q::WANTED == Wanted::Any {
                packet.nearest.note(lane, prim);
                return true;
            }
            if let Some(closer) = packet.nearest.defer(lane, bounds, prim, source) {
                return closer;
            }
        }
        self.decide(i, lane, source, prim)
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
    fn narrow_packet(&mut self, i: usize, closer: bool) {
        if closer {
            self.changed = true;
            let (rises, slack) = (self.group.rises, self.group.slack);
            let packet = &mut self.group.packets[i];
            if Q::WANTED == Wanted::Any { packet.finish() } else { packet.shorten(self.lanes, rises, slack) }
        }
    }
}

/// [`Certain`] hits in units of the rays' own t.
struct Unscaled {
    lanes: u32,
    low: [f32; WIDTH],
    high: [f32; WIDTH],
}

impl Unscaled {
    /// Powers of two scale without rounding, where nothing overflows or underflows; what is not after the open
    /// end of the interval, which the scaled one contains, is not certain.
    #[inline(always)]
    fn new<L: Lanes>(lanes: L, certain: &Certain<L>, unit: L::F32, after: L::F32) -> Self {
        let (low, high) = (certain.low * unit, certain.high * unit);
        let within = lanes.less(lanes.max(after, lanes.splat(2f32.powi(-LONGEST))), low)
            & lanes.less(high, lanes.splat(2f32.powi(LONGEST)));
        Self { lanes: certain.lanes & lanes.bits(within), low: lanes.store(low), high: lanes.store(high) }
    }

    /// The bounds of t in a lane that is certain.
    #[inline(always)]
    fn at(&self, lane: u32) -> Option<[f32; 2]> {
        (self.lanes >> lane & 1 != 0).then(|| [self.low[lane as usize], self.high[lane as usize]])
    }
}

/// Packets of which fewer rays meet a cluster's box are tested ray by ray.
const MANY: u32 = 4;

/// By axis and four bits along it: the voxels of a brick with such an index.
const SPREAD: [[u64; 16]; 3] = {
    let mut spread = [[0; 16]; 3];
    let mut axis = 0;
    while axis < 3 {
        let mut bits = 0;
        while bits < 16 {
            let mut voxel = 0;
            while voxel < 64 {
                if bits >> (voxel >> (2 * axis) & 3) & 1 != 0 {
                    spread[axis][bits] |= 1 << voxel;
                }
                voxel += 1;
            }
            bits += 1;
        }
        axis += 1;
    }
    spread
};
