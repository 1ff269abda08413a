//! Moving through a grid: a ray clipped to it, and the 3D digital differential analyser.
//!
//! Source: J. Amanatides and A. Woo, "A Fast Voxel Traversal Algorithm for Ray Tracing", 1987, in the
//! form of the paper: for each axis the time at which the ray leaves the voxel (`exit`; the paper's
//! `remain` counted from the start) and the time between two planes (`width`; its `tot_remain`).
//!
//! The grid is mirrored so that every component of the direction is positive. Lengths are in cells of
//! the top grid; times count from the [`Path`]'s start, at a speed of one cell along the steepest axis.
//!
//! # Errors
//! With S the size of the grid in cells, the start is off by 2^-38 S at most, and each step of `exit` by
//! 2^-53 of itself: after 2^10 steps through the top grid a plane is misplaced by less than 2^-42 S, after
//! the 2^22 steps through the smallest voxels of a list structure by less than 2^-30.9 S. A component of
//! the direction below 2^-60 of the largest is raised to that, which moves the ray by less than 2^-47 S.
//! Voxels are built larger than that, see [`LIST_MARGIN`] and "Error analysis" in ARCHITECTURE.md.

use crate::arena::Grid;
use crate::descent::first_exit;
use crate::exact::{two_product, two_sum};
use crate::lanes::axes;
use crate::ray::Ray;

/// The margin of the voxels of a structure that is walked in f64, relative to the size of the scene.
pub(crate) const LIST_MARGIN: f64 = 1.0 / (1u64 << 30) as f64;

/// The margin of the voxels and boxes of a structure of bricks, whose times are f32.
pub(crate) const BRICK_MARGIN: f64 = 1.0 / (1u64 << 19) as f64;

/// The part of a ray from where it enters the grid.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Path {
    /// Where it starts, in cells of the mirrored grid.
    pub(crate) origin: [f64; 3],
    /// The time that it takes to cross one cell along each axis, at least 1.
    pub(crate) width: [f64; 3],
    /// Bit `axis` is set where the axis is mirrored.
    pub(crate) octant: u32,
    /// Time a unit of t.
    speed: f64,
    /// The time of t = 0, rounded up.
    zero: f64,
}

/// How a ray meets a grid.
pub(crate) enum Clip {
    /// Certainly not.
    Miss,
    /// Along this path, if at all.
    Path(Path),
    /// Its origin is so far away (more than about 2^63 sizes of the grid) that f64 can't place it.
    TooFar,
}

impl Path {
    /// Clips a valid ray to the grid.
    #[inline(always)]
    pub(crate) fn clip(ray: &Ray, grid: &Grid) -> Clip {
        // Origins so near, in sizes of the grid, that rounding stays within what the grid is larger than
        // the scene.
        const NEAR: f64 = 256.0;
        let steepest = f64::from(ray.dir.abs().max_element());
        let speeds = axes(|axis| f64::from(ray.dir[axis]).abs().max(steepest * LEAST_SPEED));
        let inverse = axes(|axis| 1.0 / speeds[axis]);
        let octant = ray.octant();
        let size = axes(|axis| f64::from(grid.dims[axis]) * grid.cell);
        let position = axes(|axis| f64::from(ray.origin[axis]) - grid.lo[axis]);
        let position = axes(|axis| mirror(octant, axis, position[axis], size[axis]));
        if (0..3).any(|axis| position[axis].abs() > NEAR * size[axis]) {
            return Self::clip_far(ray, grid);
        }
        let enter = axes(|axis| -position[axis] * inverse[axis]);
        let leave = axes(|axis| (size[axis] - position[axis]) * inverse[axis]);
        let start = f64::from(ray.t_min).max(enter[0]).max(enter[1]).max(enter[2]);
        if start > rounds_to(ray.t_max).min(leave[0]).min(leave[1]).min(leave[2]) {
            return Clip::Miss;
        }
        let cells = 1.0 / grid.cell;
        let speed = steepest * cells;
        Clip::Path(Self {
            origin: axes(|axis| (position[axis] + start * speeds[axis]) * cells),
            width: axes(|axis| steepest * inverse[axis]),
            octant,
            speed,
            zero: zero(speed, start, 0.0),
        })
    }

    /// The same for an origin anywhere.
    #[cold]
    #[inline(never)]
    fn clip_far(ray: &Ray, grid: &Grid) -> Clip {
        // Bounds the error of a quotient of differences, but for 2^-52 of the grid's width, by which the scene
        // is certainly inside.
        const SLACK: f64 = 1.0 / (1u64 << 51) as f64;
        let (mut enter, mut leave) = (f64::from(ray.t_min), rounds_to(ray.t_max));
        for axis in 0..3 {
            let size = f64::from(grid.dims[axis]) * grid.cell;
            let position = f64::from(ray.origin[axis]) - grid.lo[axis];
            let d = f64::from(ray.dir[axis]);
            if d == 0.0 {
                if position < -SLACK * size || position > (1.0 + SLACK) * size {
                    return Clip::Miss;
                }
                continue;
            }
            let (a, b) = (-position / d, (size - position) / d);
            let (near, far) = if d < 0.0 { (b, a) } else { (a, b) };
            enter = enter.max(near - SLACK * near.abs());
            leave = leave.min(far + SLACK * far.abs());
        }
        if enter <= leave { Self::from_far(ray, grid, enter) } else { Clip::Miss }
    }

    fn from_far(ray: &Ray, grid: &Grid, start: f64) -> Clip {
        /// Places in units S of the grid's size up to which their errors stay below 2^-38 S.
        const FAR: f64 = 4096.0;
        let octant = ray.octant();
        let steepest = f64::from(ray.dir.abs().max_element());
        let least = steepest * LEAST_SPEED;
        let mut path = Self {
            origin: axes(|axis| {
                let position = advance(ray, axis, start, grid.lo[axis]) / grid.cell;
                mirror(octant, axis, position, f64::from(grid.dims[axis]))
            }),
            width: axes(|axis| steepest / f64::from(ray.dir[axis]).abs().max(least)),
            octant,
            speed: steepest / grid.cell,
            zero: 0.0,
        };
        let far = path.origin.iter().any(|&p| p.is_nan() || p.abs() > FAR * f64::from(grid.longest()));
        if far {
            return Clip::TooFar;
        }
        // Rounding puts the start before the grid.
        let delay = (0..3).map(|axis| -path.origin[axis] * path.width[axis]).fold(0.0, f64::max);
        for axis in 0..3 {
            path.origin[axis] += delay / path.width[axis];
        }
        path.zero = zero(path.speed, start, delay);
        Clip::Path(path)
    }

    /// A time no hit comes after whose distance rounds to `t` or less.
    #[inline(always)]
    fn time(&self, t: f32) -> f64 {
        let time = f64::from(t) * self.speed;
        // Twice half a unit in the last place of t, so that rounding here is covered.
        time + time.abs() * (2.0 * HALF_ULP) + self.zero
    }
}

/// The time of t = 0, rounded up, on a path that starts `delay` after the time of t = `start`.
#[inline(always)]
fn zero(speed: f64, start: f64, delay: f64) -> f64 {
    const SLACK: f64 = 1.0 / (1u64 << 50) as f64;
    let back = start * speed;
    (back.abs() + delay) * SLACK + LEAST * speed - (back + delay)
}

/// The time after which a walk finds nothing more: that of the query's `t_max`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limit {
    t_max: f32,
    /// No hit that rounds to `t_max` or less comes later.
    pub(crate) time: f64,
}

impl Limit {
    #[inline(always)]
    pub(crate) fn new(path: &Path, t_max: f32) -> Self {
        Self { t_max, time: path.time(t_max) }
    }

    /// Follows `t_max`, and says whether it has changed.
    #[inline(always)]
    pub(crate) fn update(&mut self, path: &Path, t_max: f32) -> bool {
        let changed = t_max != self.t_max;
        if changed {
            *self = Self::new(path, t_max);
        }
        changed
    }
}

/// The least speed along an axis, relative to the largest.
const LEAST_SPEED: f64 = 1.0 / (1u64 << 60) as f64;

/// A position in a grid of a given size, seen from the corner where the octant's rays come from.
#[inline(always)]
fn mirror(octant: u32, axis: usize, position: f64, size: f64) -> f64 {
    if octant >> axis & 1 != 0 { size - position } else { position }
}

/// No less than the largest distance that rounds to `t`: hits count if their rounded distance is within.
#[inline(always)]
fn rounds_to(t: f32) -> f64 {
    let t = f64::from(t);
    t + (t.abs() * HALF_ULP + LEAST)
}

/// Half a unit in the last place of an f32, relative to it, and half the least f32.
const HALF_ULP: f64 = 1.0 / (1u64 << 24) as f64;
const LEAST: f64 = 0.5 * f32::from_bits(1) as f64;

/// origin - lo + t * dir along one axis, to 2^-53 of the result and 2^-105 of the origin's distance: in two
/// terms, since for an origin far away the sum cancels.
#[inline]
fn advance(ray: &Ray, axis: usize, t: f64, lo: f64) -> f64 {
    let (position, position_error) = two_sum(f64::from(ray.origin[axis]), -lo);
    let (step, step_error) = two_product(t, f64::from(ray.dir[axis]));
    let (sum, sum_error) = two_sum(position, step);
    sum + (sum_error + position_error + step_error)
}

/// A voxel on the path, one of a block of voxels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Dda {
    /// When the path leaves the voxel along each axis.
    pub(crate) exit: [f64; 3],
    /// How many voxels of the block follow along each axis.
    pub(crate) left: [u32; 3],
    /// The index of the voxel in the block.
    pub(crate) voxel: u32,
}

impl Dda {
    /// The voxel of the grid in which the path starts.
    #[inline(always)]
    pub(crate) fn new(path: &Path, grid: &Grid) -> Self {
        let strides = grid.strides();
        let index = axes(|axis| (path.origin[axis] as u32).min(grid.dims[axis] - 1));
        let left = axes(|axis| grid.dims[axis] - 1 - index[axis]);
        let offset =
            axes(|axis| strides[axis] * if path.octant >> axis & 1 != 0 { left[axis] } else { index[axis] });
        let exit = axes(|axis| (f64::from(index[axis] + 1) - path.origin[axis]) * path.width[axis]);
        Self { exit, left, voxel: offset[0] + offset[1] + offset[2] }
    }

    /// The axis along which the path leaves first.
    #[inline(always)]
    pub(crate) fn axis(&self) -> usize {
        first_exit(&self.exit)
    }

    /// Steps to the next voxel; false where the block ends there, or the path leaves after `limit`.
    #[inline(always)]
    pub(crate) fn advance(&mut self, limit: f64, width: &[f64; 3], stride: &[i32; 3]) -> bool {
        // Constant indices keep the state in registers.
        match self.axis() {
            0 => self.exit[0] <= limit && self.step(0, width, stride),
            1 => self.exit[1] <= limit && self.step(1, width, stride),
            _ => self.exit[2] <= limit && self.step(2, width, stride),
        }
    }

    /// Steps to the next voxel along `axis`; false where the block ends there.
    #[inline(always)]
    pub(crate) fn step(&mut self, axis: usize, width: &[f64; 3], stride: &[i32; 3]) -> bool {
        if self.left[axis] == 0 {
            return false;
        }
        self.left[axis] -= 1;
        self.exit[axis] += width[axis];
        self.voxel = self.voxel.wrapping_add_signed(stride[axis]);
        true
    }
}

/// The distance between the indices of neighbours along each axis, in the direction of the path.
#[inline(always)]
pub(crate) fn signed_strides(strides: [u32; 3], octant: u32) -> [i32; 3] {
    std::array::from_fn(|axis| {
        let stride = strides[axis] as i32;
        if octant >> axis & 1 != 0 { -stride } else { stride }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arena::LIST_LEVELS;
    use crate::descent::General;

    /// The voxels that a path through a grid of 1 x 1 x 1 cells visits.
    fn visited(ray: Ray, dims: [u32; 3]) -> Vec<[u32; 3]> {
        let grid = Grid::new([0.0; 3], 1.0, dims);
        let Clip::Path(path) = Path::clip(&ray, &grid) else { return vec![] };
        let mut dda = Dda::new(&path, &grid);
        let strides = signed_strides(grid.strides(), path.octant);
        let mut voxels = vec![];
        loop {
            let i = dda.voxel;
            voxels.push([i % dims[0], i / dims[0] % dims[1], i / dims[0] / dims[1]]);
            if !dda.step(dda.axis(), &path.width, &strides) {
                return voxels;
            }
        }
    }

    #[test]
    fn a_diagonal_visits_neighbours_in_order() {
        let ray = Ray::new([-1.0, -0.5, 0.5], [2.0, 1.0, 0.0]);
        assert_eq!(visited(ray, [3, 2, 1]), [[0, 0, 0], [1, 0, 0], [2, 0, 0], [2, 1, 0]]);
        let back = Ray::new([3.5, 2.5, 0.5], [-2.0, -2.0, -0.0]);
        assert_eq!(visited(back, [3, 2, 1]), [[2, 1, 0], [1, 1, 0], [1, 0, 0], [0, 0, 0]]);
    }

    #[test]
    fn parallel_rays_keep_their_row() {
        for (d, first, last) in [(1.0, 0, 3), (-1.0, 3, 0)] {
            let row = visited(Ray::new([2.0 - 9.0 * d, 1.5, 0.5], [d, 0.0, -0.0]), [4, 3, 1]);
            assert_eq!((row.len(), row[0], row[3]), (4, [first, 1, 0], [last, 1, 0]));
        }
        assert!(visited(Ray::new([-1.0, 3.5, 0.5], [1.0, 0.0, 0.0]), [4, 3, 1]).is_empty());
        let behind = Ray::new([5.0, 1.5, 0.5], [1.0, 0.0, 0.0]);
        assert!(visited(behind, [4, 3, 1]).is_empty());
    }

    /// The finest voxels of an octree, one after the other through the whole grid.
    #[test]
    fn planes_keep_their_place_over_all_steps() {
        for width in [1.0, 1.1, 1.3, 1.7, 1e6 / 3.0] {
            let mut part = General::<2>::whole([width; 3], [width; 3]);
            for _ in 0..LIST_LEVELS {
                part = part.descend(0.0, 0b111);
            }
            let step = part.width[0];
            for i in 1..=1u32 << LIST_LEVELS {
                let error = (part.exit[0] - f64::from(i) * step).abs() / width;
                assert!(error < 0.5 * LIST_MARGIN, "after {i} steps of {step}");
                part.step(0, 0b111);
            }
        }
    }

    #[test]
    fn too_far_is_told() {
        let grid = Grid::new([0.0; 3], 1.0, [2, 2, 1]);
        let from = |x: f32| Path::clip(&Ray::new([-x, 0.5, 0.5], [1.0, 0.0, 0.0]), &grid);
        assert!(matches!(from(1e18), Clip::Path(_)));
        assert!(matches!(from(1e30), Clip::TooFar));
    }

    #[test]
    fn far_origins_enter_where_they_should() {
        let ray = Ray::new([-1e18, -1e18, 0.5], [1e-3, 1e-3, 0.0]);
        assert_eq!(visited(ray, [2, 2, 1])[0], [0, 0, 0]);
        assert_eq!(visited(ray, [2, 2, 1]).last(), Some(&[1, 1, 0]));
    }
}
