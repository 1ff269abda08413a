//! The walk through the hybrid: a DDA over the top grid, masks within bricks, boxes before clusters.
//!
//! The paper's future work: a regular grid on top, and below it levels of N = 2, two of which make a
//! 4 x 4 x 4 brick, fitted to what it holds. Empty voxels of a brick are never stepped through: the mask of
//! those that the path meets, ANDed with that of the occupied ones, is popped from its lowest bit, which is the
//! next voxel.
//!
//! # Errors
//! Times of bricks and boxes are f32. That of a box's side is its place times `slope` plus `delay`: their
//! roundings, and those of product and sum, misplace it by less than 2^-22 of the grid, a plane in a brick by less
//! than 2^-20.8; voxels and boxes are built larger by 2^-19, see [`BRICK_MARGIN`](crate::dda::BRICK_MARGIN).

use std::ops::ControlFlow;

use super::brick::{BrickPath, Line, mirror, mirror_index};
use super::{Visit, Walker};
use crate::arena::{Arena, BRICK_LEVELS, BoxGroup, Grid, Voxel, VoxelWord};
use crate::dda::{Clock, Dda, Limit, Path, Quad, Steps};
use crate::filter::above;
use crate::lanes::{Lanes, axes};

/// The walk, with bricks or through the top grid alone.
pub(crate) struct Hybrid<const BRICKS: bool>;

impl<const BRICKS: bool> Walker for Hybrid<BRICKS> {
    #[inline(always)]
    fn walk<L: Lanes, V: Visit>(lanes: L, arena: &Arena, path: &Path<L>, visit: &mut V) -> ControlFlow<()> {
        Self::walk_from(lanes, arena, Start::of(lanes, path, &arena.grid), visit)
    }
}

/// Where a walk starts, and what it adds from there.
pub(super) struct Start {
    dda: Dda,
    steps: Steps,
    octant: u32,
    clock: Clock,
    /// Time a cell, with the sign of the direction.
    slope: [f32; 3],
    /// Minus the time at which the path passes the grid's lower corner.
    delay: [f32; 3],
}

impl Start {
    #[inline(always)]
    fn of<L: Lanes>(lanes: L, path: &Path<L>, grid: &Grid) -> Self {
        let (dda, steps) = Dda::new(lanes, path, grid);
        let (octant, clock) = (path.octant, path.clock);
        let (slope, delay) = (rounded(lanes, path.slope(lanes)), rounded(lanes, path.delay(lanes, grid)));
        Self { dda, steps, octant, clock, slope, delay }
    }

    /// That of one of four rays.
    #[inline(always)]
    pub(super) fn of_quad(quad: &Quad, ray: usize) -> Self {
        let (dda, steps) = quad.dda(ray);
        Self {
            dda,
            steps,
            octant: quad.octant(ray),
            clock: quad.clock(ray),
            slope: axes(
                #[inline(always)]
                |axis| quad.slope(axis, ray),
            ),
            delay: axes(
                #[inline(always)]
                |axis| quad.delay(axis, ray),
            ),
        }
    }
}

/// Three of four values.
#[inline(always)]
fn rounded<L: Lanes>(lanes: L, x: L::F64) -> [f32; 3] {
    let x = lanes.store4(x);
    axes(
        #[inline(always)]
        |axis| x[axis] as f32,
    )
}

/// Each value in all lanes.
#[inline(always)]
fn splat<L: Lanes>(lanes: L, x: [f32; 3]) -> [L::F32x16; 3] {
    axes(
        #[inline(always)]
        |axis| lanes.splat16(x[axis]),
    )
}

impl<const BRICKS: bool> Hybrid<BRICKS> {
    /// Visits the voxels from there on.
    #[inline(always)]
    pub(super) fn walk_from<L: Lanes, V: Visit>(
        lanes: L,
        arena: &Arena,
        start: Start,
        visit: &mut V,
    ) -> ControlFlow<()> {
        let (mut dda, steps) = (start.dda, start.steps);
        let mut cells = Cells::new(lanes, arena, &start, visit);
        loop {
            // A loop of its own for empty voxels, which need few registers.
            let word = loop {
                cells.visit.enter();
                // A path that starts where it leaves the grid may step out of it.
                let Some(word) = arena.words.get(dda.voxel as usize) else {
                    return ControlFlow::Continue(());
                };
                cells.visit.read(word);
                if *word != VoxelWord::EMPTY {
                    break word;
                }
                if !dda.advance(cells.limit.time, &steps) {
                    return ControlFlow::Continue(());
                }
            };
            match word.get() {
                Voxel::Leaf(first) => cells.groups(first)?,
                Voxel::Node(brick) if BRICKS => cells.descend(brick)?,
                Voxel::Empty | Voxel::Node(_) => {}
            }
            if !dda.advance(cells.limit.time, &steps) {
                return ControlFlow::Continue(());
            }
        }
    }
}

/// A brick on the stack: its voxels that are still to be visited.
#[derive(Clone, Copy)]
struct Frame {
    brick: u32,
    times: BrickPath,
    mask: u64,
}

/// What the walk needs within the cells of the top grid.
struct Cells<'a, L: Lanes, V> {
    lanes: L,
    arena: &'a Arena,
    octant: u32,
    clock: Clock,
    visit: &'a mut V,
    limit: Limit,
    /// The time of the limit, rounded up. It is finite, as the path leaves the grid: boxes of no cluster are
    /// met at infinity.
    last: f32,
    /// When the path leaves the grid, rounded up.
    end: f32,
    /// As in [`Start`].
    slope: [L::F32x16; 3],
    delay: [L::F32x16; 3],
    /// The same for bricks.
    line: Line,
    /// The sides of boxes that the path enters and leaves by.
    near: [usize; 3],
    far: [usize; 3],
}

impl<'a, L: Lanes, V: Visit> Cells<'a, L, V> {
    #[inline(always)]
    fn new(lanes: L, arena: &'a Arena, start: &Start, visit: &'a mut V) -> Self {
        let &Start { octant, clock, slope, delay, .. } = start;
        let limit = Limit::new(clock, start.steps.end, visit.t_max());
        let (last, end) = (above(limit.time), above(start.steps.end));
        let near = axes(
            #[inline(always)]
            |axis| (octant >> axis & 1) as usize,
        );
        let far = axes(
            #[inline(always)]
            |axis| (!octant >> axis & 1) as usize,
        );
        let line = Line::new(slope, delay, octant);
        let (slope, delay) = (splat(lanes, slope), splat(lanes, delay));
        Self { lanes, arena, octant, clock, visit, limit, last, end, slope, delay, line, near, far }
    }

    /// Follows the query's `t_max`, and says whether it has changed.
    #[inline(always)]
    fn narrow(&mut self) -> bool {
        let t_max = self.visit.t_max();
        let changed = self.limit.update(self.clock, t_max);
        if changed {
            let last = self.clock.rounded_time(t_max);
            self.last = if last < self.end { last } else { self.end };
        }
        changed
    }

    /// Visits the occupied voxels of a brick that the path meets, front to back, and what is below.
    #[inline(always)]
    fn descend(&mut self, brick: u32) -> ControlFlow<()> {
        let flip = mirror_index(self.octant);
        let mut frame = self.frame(brick);
        let mut stack = [frame; BRICK_LEVELS as usize];
        let mut depth = 0;
        loop {
            while frame.mask == 0 {
                if depth == 0 {
                    return ControlFlow::Continue(());
                }
                depth -= 1;
                frame = stack[depth];
            }
            let index = frame.mask.trailing_zeros();
            frame.mask &= frame.mask - 1;
            if frame.times.start(index) > self.last {
                continue;
            }
            let brick = &self.arena.bricks[frame.brick as usize];
            let before = brick.occupied & ((1 << (index ^ flip)) - 1);
            let word = &self.arena.words[(brick.first + before.count_ones()) as usize];
            self.visit.enter();
            self.visit.read(word);
            match word.get() {
                Voxel::Empty => {}
                Voxel::Leaf(first) => self.groups(first)?,
                Voxel::Node(brick) => {
                    stack[depth] = frame;
                    depth += 1;
                    frame = self.frame(brick);
                }
            }
        }
    }

    #[inline(always)]
    fn frame(&mut self, index: u32) -> Frame {
        let brick = &self.arena.bricks[index as usize];
        self.visit.read(brick);
        let times = BrickPath::new(&self.line, brick);
        let occupied = mirror(brick.occupied, self.octant);
        Frame { brick: index, times, mask: occupied & times.mask(self.lanes, self.last) }
    }

    /// Tests the box groups of a leaf from `first` on, and the clusters whose boxes the path meets.
    #[inline(always)]
    fn groups(&mut self, first: u32) -> ControlFlow<()> {
        let mut groups = self.arena.groups[first as usize..].iter();
        loop {
            // A loop of its own for groups that are missed, which need few registers.
            let (group, start, mut met) = loop {
                let Some(group) = groups.next() else { return ControlFlow::Continue(()) };
                self.visit.read(group);
                let (start, end) = self.boxes(group);
                let met = self.overlapping(start, end);
                if met != 0 {
                    break (group, start, met);
                }
                if group.clusters[0].is_last() {
                    return ControlFlow::Continue(());
                }
            };
            while met != 0 {
                let lane = met.trailing_zeros() as usize;
                met &= met - 1;
                self.visit.only(group.clusters[lane].cluster())?;
                if self.narrow() {
                    met &= self.overlapping(start, self.lanes.splat16(self.last));
                }
            }
            if group.clusters[0].is_last() {
                return ControlFlow::Continue(());
            }
        }
    }

    /// When the path enters and leaves sixteen boxes, from time 0 to the limit.
    #[inline(always)]
    fn boxes(&self, group: &BoxGroup) -> (L::F32x16, L::F32x16) {
        let lanes = self.lanes;
        let (mut start, mut end) = (lanes.splat16(0.0), lanes.splat16(self.last));
        for axis in 0..3 {
            let (near, far) = (self.near[axis] & 1, self.far[axis] & 1);
            let (near, far) =
                (lanes.load16(&group.planes[near][axis]), lanes.load16(&group.planes[far][axis]));
            start = lanes.max16(start, lanes.mul_add16(near, self.slope[axis], self.delay[axis]));
            end = lanes.min16(end, lanes.mul_add16(far, self.slope[axis], self.delay[axis]));
        }
        (start, end)
    }

    /// The lanes whose interval is not empty, as bits.
    #[inline(always)]
    fn overlapping(&self, start: L::F32x16, end: L::F32x16) -> u32 {
        !self.lanes.bits16(self.lanes.less16(end, start)) & 0xffff
    }
}
