//! The walk of a group of rays through the hybrid.
//!
//! The cells and voxels between the [`Frustum`]'s lines are visited slice by slice along the main axis, in the
//! order in which the rays come to the slices; within a slice in any order, as the closest hit is decided by
//! (t, index) alone. Leaves are in [`leaf`].
//!
//! Source: I. Wald, T. Ize, A. Kensler, A. Knoll, S. G. Parker, "Ray Tracing Animated Scenes using Coherent
//! Grid Traversal", 2006, for walking slices with a frustum; the steps are ours.
//!
//! # Errors
//! What is left out is certainly not met: see [`frustum`](super::frustum) for groups against voxels.

mod leaf;

use std::marker::PhantomData;

use super::Outcome;
use super::frustum::{Frustum, span};
use super::group::{Group, Packet};
use crate::arena::{Arena, Voxel};
use crate::bundle::Bundle;
use crate::lanes::{Doubles, greater, lesser};
use crate::query::Query;
use leaf::Mailbox;

/// Groups that spread farther, in sizes of the grid, are not traced together.
const WIDEST: f32 = 0.2;

/// What a group may do for each of its rays: visit a voxel, test a group of boxes, or test a box against its
/// rays. Where it does more, as with rays that are far apart in the scale of what they meet, they are faster
/// alone.
const EFFORT: u32 = 24;

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
    /// Traces a group.
    #[inline(always)]
    pub(crate) fn run(lanes: L, arena: &'a Arena, group: &'a mut Group<'b>) -> Outcome {
        let longest = arena.grid.longest() as f32;
        let Some(frustum) = Frustum::around(lanes, group, longest) else { return Outcome::Answered };
        if frustum.width() > WIDEST * longest {
            return Outcome::Apart;
        }
        let bundle = frustum.bundle(&arena.grid);
        let effort = EFFORT * group.len as u32;
        let mailbox = Mailbox::default();
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
        if walk.effort == 0 {
            return Outcome::GivenUp;
        }
        walk.finish();
        Outcome::Answered
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
            let (a, b) = (greater(a, self.frustum.span[0]), lesser(b, self.frustum.span[1]));
            // Beyond the first and last cell is the grid's border, which rounding may reach.
            if a <= b {
                let range = |side: usize| {
                    let most = grid.dims[self.group.others[side]] as f32;
                    let [low, high] = self.frustum.range(side, a, b);
                    (low < most && high >= 0.0)
                        .then(|| greater(low, 0.0) as u32..=lesser(high, most - 1.0) as u32)
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
                                Voxel::Node(brick) => self.brick(brick),
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
    fn brick(&mut self, brick: u32) {
        self.lanes.vectorize(
            #[inline(always)]
            || self.voxels(brick),
        );
    }

    #[inline(always)]
    fn voxels(&mut self, brick: u32) {
        let brick = self.arena.bricks[brick as usize];
        let (lo, side) = (brick.lo.to_array(), brick.side.to_array());
        let (main, [u, v]) = (self.group.main, self.group.others);
        for k in 0..4 {
            if self.changed && !self.narrow() {
                return;
            }
            let slice = if self.group.rises { k } else { 3 - k };
            let ends = [slice, slice + 1].map(|i| lo[main] + i as f32 * side[main]);
            let (from, to) = (greater(ends[0], self.frustum.span[0]), lesser(ends[1], self.frustum.span[1]));
            if from > to {
                continue;
            }
            let range = |s: usize, axis: usize| {
                let [low, high] = self.frustum.range(s, from, to);
                let (low, high) = ((low - lo[axis]) / side[axis], (high - lo[axis]) / side[axis]);
                if low < 4.0 && high >= 0.0 {
                    let (low, high) = (greater(low, 0.0) as u32, lesser(high, 3.0) as u32);
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
                    Voxel::Node(below) => self.brick(below),
                }
            }
        }
    }
}

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
