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

mod clock;
mod path;
mod quad;

use crate::arena::Grid;
use crate::descent::first_exit;
use crate::lanes::{Lanes, axes, lesser};
pub(crate) use clock::{Clock, Limit};
pub(crate) use path::{Clip, Path};
pub(crate) use quad::Quad;

/// The margin of the voxels of a structure that is walked in f64, relative to the size of the scene.
pub(crate) const LIST_MARGIN: f64 = 1.0 / (1u64 << 30) as f64;

/// The margin of the voxels and boxes of a structure of bricks, whose times are f32.
pub(crate) const BRICK_MARGIN: f64 = 1.0 / (1u64 << 19) as f64;

/// A voxel of the top grid on the path.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Dda {
    /// When the path leaves the voxel along each axis.
    pub(crate) exit: [f64; 3],
    /// How many voxels of the grid follow along each axis.
    left: [u32; 3],
    /// The index of the voxel.
    pub(crate) voxel: u32,
}

/// What steps of a [`Dda`] add.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Steps {
    /// The time from plane to plane along each axis.
    pub(crate) width: [f64; 3],
    /// The distance between the indices of neighbours.
    stride: [i32; 3],
    /// When the path leaves the grid: a little before it leaves the last voxel, so that no step leads out of
    /// the grid, unless that is at the very start.
    pub(crate) end: f64,
}

impl Dda {
    /// The voxel of the grid in which the path starts, and the steps from there.
    #[inline(always)]
    pub(crate) fn new<L: Lanes>(lanes: L, path: &Path<L>, grid: &Grid) -> (Self, Steps) {
        let (zero, half, one) = (lanes.splat4(0.0), lanes.splat4(0.5), lanes.splat4(1.0));
        let strides = lanes.load4(&grid.axes.strides);
        let last = lanes.load4(&grid.axes.dims) - one;
        // To the nearest integer, half a cell back: the start may be on the voxel's planes.
        let rounding = lanes.splat4(ROUNDING);
        let index = lanes.min4(lanes.max4(path.origin - half, zero), last) + rounding - rounding;
        let left = last - index;
        let exit = (index + one - path.origin) * path.width;
        let [ex, ey, ez, _] = lanes.store4(exit + left * path.width);
        let across = lanes.store4(lanes.select4(path.mirrored, left, index) * strides);
        let strides = lanes.store4(lanes.select4(path.mirrored, -strides, strides) + rounding);
        let left = lanes.store4(left + rounding);
        let (exit, width) = (lanes.store4(exit), lanes.store4(path.width));
        let dda = Self {
            exit: axes(|axis| exit[axis]),
            left: axes(|axis| integer(left[axis]) as u32),
            voxel: integer(across[0] + across[1] + across[2] + ROUNDING) as u32,
        };
        let steps = Steps {
            width: axes(|axis| width[axis]),
            stride: axes(|axis| integer(strides[axis])),
            end: lesser(lesser(ex, ey), ez) * EARLY,
        };
        (dda, steps)
    }

    /// The axis along which the path leaves first.
    #[inline(always)]
    pub(crate) fn axis(&self) -> usize {
        first_exit(&self.exit)
    }

    /// Steps to the next voxel; false where the path leaves after `limit`, which is no later than its end.
    #[inline(always)]
    pub(crate) fn advance(&mut self, limit: f64, steps: &Steps) -> bool {
        // Before the axis: most walks end here, and no processor foresees along which.
        let [x, y, z] = self.exit;
        if limit < lesser(lesser(x, y), z) {
            return false;
        }
        // Constant indices keep the state in registers.
        match self.axis() {
            0 => self.cross(0, steps),
            1 => self.cross(1, steps),
            _ => self.cross(2, steps),
        }
    }

    #[inline(always)]
    fn cross(&mut self, axis: usize, steps: &Steps) -> bool {
        self.exit[axis] += steps.width[axis];
        self.voxel = self.voxel.wrapping_add_signed(steps.stride[axis]);
        true
    }

    /// Steps to the next voxel along `axis`; false where the grid ends there.
    #[inline(always)]
    pub(crate) fn step(&mut self, axis: usize, steps: &Steps) -> bool {
        if self.left[axis] == 0 {
            return false;
        }
        self.left[axis] -= 1;
        self.cross(axis, steps)
    }
}

/// Rounding moves a plane that is left last by less, and the scene is inside the grid by more.
const EARLY: f64 = 1.0 - 1.0 / (1u64 << 40) as f64;

/// What is added to an integer of 32 bits, with sign, to have it in the low bits; a number is rounded to it.
const ROUNDING: f64 = 1.5 * (1u64 << 52) as f64;

/// The integer to which [`ROUNDING`] was added.
#[inline(always)]
fn integer(x: f64) -> i32 {
    x.to_bits() as i32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arena::LIST_LEVELS;
    use crate::descent::General;
    use crate::lanes::Portable;
    use crate::ray::Ray;

    /// The voxels that a path through a grid of 1 x 1 x 1 cells visits.
    fn visited(ray: Ray, dims: [u32; 3]) -> Vec<[u32; 3]> {
        let grid = Grid::new([0.0; 3], 1.0, dims);
        let Clip::Path(path) = Path::clip(Portable, &ray, &grid) else { return vec![] };
        let (mut dda, steps) = Dda::new(Portable, &path, &grid);
        let mut voxels = vec![];
        loop {
            let i = dda.voxel;
            voxels.push([i % dims[0], i / dims[0] % dims[1], i / dims[0] / dims[1]]);
            if !dda.step(dda.axis(), &steps) {
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
    fn rays_start_before_their_origin_whatever_their_length() {
        for length in [1e-30, 1.0, 1e35] {
            let ray =
                Ray::new([2.5, 0.5, 0.5], [length, 0.0, 0.0]).with_interval(-2.0 / length, f32::INFINITY);
            assert_eq!(visited(ray, [4, 1, 1]).len(), 4, "{length}");
        }
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
        let from = |x: f32| Path::clip(Portable, &Ray::new([-x, 0.5, 0.5], [1.0, 0.0, 0.0]), &grid);
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
