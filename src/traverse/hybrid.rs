//! The walk through the hybrid: a DDA over the top grid, masks within bricks, boxes before clusters.
//!
//! The paper's future work: a regular grid on top, and below it levels of N = 2, two of which make a
//! 4 x 4 x 4 brick. Empty voxels of a brick are never stepped through: the mask of those that the path
//! meets, ANDed with that of the occupied ones, is popped from its lowest bit, which is the next voxel.
//!
//! # Errors
//! Times within bricks are f32. The slack of [`BrickPath`] makes up for their rounding, so that a voxel is
//! visited at all times at which the path is in it. A side of a box lies at most 2^10 cells from the start:
//! the roundings of the start, of the difference and of its product with `slope` misplace it by less than
//! 2^-22 of the grid; voxels and boxes are built larger by 8 times that, see
//! [`BRICK_MARGIN`](crate::dda::BRICK_MARGIN).

use std::ops::ControlFlow;

use super::Visit;
use super::brick::{BrickPath, mirror, mirror_index};
use crate::arena::{Arena, BRICK_LEVELS, BoxGroup, Voxel};
use crate::dda::{Dda, Path, signed_strides};
use crate::lanes::{Lanes, axes};
use crate::triangle::Vec3Lanes;

#[inline(always)]
pub(crate) fn walk<L: Lanes, V: Visit>(
    lanes: L,
    arena: &Arena,
    path: &Path,
    visit: &mut V,
) -> ControlFlow<()> {
    let strides = signed_strides(arena.grid.strides(), path.octant);
    let mut dda = Dda::new(path, &arena.grid);
    let mut bricks = Bricks::new(lanes, arena, path, visit);
    loop {
        bricks.visit.enter();
        let word = &arena.words[dda.voxel as usize];
        bricks.visit.read(word);
        match word.get() {
            Voxel::Empty => {}
            Voxel::Leaf(first) => bricks.groups(first)?,
            Voxel::Node(brick) => {
                let times = BrickPath::new(
                    std::array::from_fn(|axis| (dda.exit[axis] - path.width[axis]) as f32),
                    path.width.map(|w| 0.25 * w as f32),
                );
                bricks.descend(brick, times)?;
            }
        }
        let axis = dda.axis();
        if dda.exit[axis] > f64::from(bricks.limit) || !dda.step(axis, &path.width, &strides) {
            return ControlFlow::Continue(());
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

/// What the walk needs below the top grid.
struct Bricks<'a, L: Lanes, V> {
    lanes: L,
    arena: &'a Arena,
    path: &'a Path,
    visit: &'a mut V,
    /// No hit comes after this time.
    limit: f32,
    /// Where time is 0, relative to the grid's lower corner.
    origin: Vec3Lanes<L>,
    /// Time a cell, with the sign of the direction.
    slope: Vec3Lanes<L>,
}

impl<'a, L: Lanes, V: Visit> Bricks<'a, L, V> {
    #[inline(always)]
    fn new(lanes: L, arena: &'a Arena, path: &'a Path, visit: &'a mut V) -> Self {
        let mirrored = |axis: usize| path.octant >> axis & 1 != 0;
        let origin = axes(
            #[inline(always)]
            |axis| {
                let p = path.origin[axis];
                lanes.splat(if mirrored(axis) { f64::from(arena.grid.dims[axis]) - p } else { p } as f32)
            },
        );
        let slope = axes(
            #[inline(always)]
            |axis| {
                let w = path.width[axis] as f32;
                lanes.splat(if mirrored(axis) { -w } else { w })
            },
        );
        let mut bricks = Self { lanes, arena, path, visit, limit: 0.0, origin, slope };
        bricks.update_limit();
        bricks
    }

    #[inline(always)]
    fn update_limit(&mut self) {
        self.limit = (self.path.time(self.visit.limit()) as f32).next_up();
    }

    /// Visits the occupied voxels of a brick that the path meets, front to back, and what is below.
    #[inline(always)]
    fn descend(&mut self, brick: u32, times: BrickPath) -> ControlFlow<()> {
        let flip = mirror_index(self.path.octant);
        let mut frame = self.frame(brick, times);
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
            let times = frame.times.child(index);
            if times.earliest() > self.limit {
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
                    frame = self.frame(brick, times);
                }
            }
        }
    }

    #[inline(always)]
    fn frame(&mut self, index: u32, times: BrickPath) -> Frame {
        let brick = &self.arena.bricks[index as usize];
        self.visit.read(brick);
        let occupied = mirror(brick.occupied, self.path.octant);
        Frame { brick: index, times, mask: occupied & times.mask(self.lanes, self.limit) }
    }

    /// Tests the box groups of a leaf from `first` on, and the clusters whose boxes the path meets.
    #[inline(always)]
    fn groups(&mut self, first: u32) -> ControlFlow<()> {
        for group in &self.arena.groups[first as usize..] {
            self.visit.read(group);
            let mut met = self.boxes(group);
            while met != 0 {
                let lane = met.trailing_zeros() as usize;
                met &= met - 1;
                self.visit.cluster(group.clusters[lane].cluster())?;
            }
            self.update_limit();
            if group.clusters[0].is_last() {
                break;
            }
        }
        ControlFlow::Continue(())
    }

    /// The boxes that the path meets up to the limit, as bits: the slabs of eight boxes at once.
    #[inline(always)]
    fn boxes(&self, group: &BoxGroup) -> u32 {
        let lanes = self.lanes;
        let (mut start, mut end) = (lanes.splat(0.0), lanes.splat(self.limit));
        for axis in 0..3 {
            let mirrored = (self.path.octant >> axis & 1) as usize;
            let time =
                |side: usize| (lanes.load(&group.planes[side][axis]) - self.origin[axis]) * self.slope[axis];
            start = lanes.max(start, time(mirrored));
            end = lanes.min(end, time(1 - mirrored));
        }
        !lanes.bits(lanes.less(end, start)) & 0xff
    }
}
