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

mod quad;

use crate::arena::Grid;
use crate::descent::first_exit;
use crate::exact::{two_product, two_sum};
use crate::lanes::{Lanes, axes};
use crate::ray::Ray;
pub(crate) use quad::Quad;

/// The margin of the voxels of a structure that is walked in f64, relative to the size of the scene.
pub(crate) const LIST_MARGIN: f64 = 1.0 / (1u64 << 30) as f64;

/// The margin of the voxels and boxes of a structure of bricks, whose times are f32.
pub(crate) const BRICK_MARGIN: f64 = 1.0 / (1u64 << 19) as f64;

/// The part of a ray from where it enters the scene's box or the grid; an axis a lane.
#[derive(Clone, Copy)]
pub(crate) struct Path<L: Lanes> {
    /// Where it starts, in cells of the mirrored grid.
    pub(crate) origin: L::F64,
    /// The time that it takes to cross one cell along each axis, at least 1.
    pub(crate) width: L::F64,
    /// Where the axis is mirrored.
    pub(crate) mirrored: L::Mask4,
    /// The same as bits.
    pub(crate) octant: u32,
    pub(crate) clock: Clock,
}

/// How a ray meets a grid.
pub(crate) enum Clip<L: Lanes> {
    /// Certainly not.
    Miss,
    /// Along this path, if at all.
    Path(Path<L>),
    /// Its origin is so far away (more than about 2^63 sizes of the grid) that f64 can't place it.
    TooFar,
}

impl<L: Lanes> Path<L> {
    /// Clips a ray to the scene's box in the grid, or to the grid; one that is not valid misses.
    #[inline(always)]
    pub(crate) fn clip(lanes: L, ray: &Ray, grid: &Grid) -> Clip<L> {
        let ([ox, oy, oz], [dx, dy, dz]) = (ray.origin.to_array(), ray.dir.to_array());
        let steepest = f64::from(ray.dir.abs().max_element());
        // In the fourth lane, whose lower plane is passed at t_min.
        let origin = lanes.load4(&[ox, oy, oz, -ray.t_min].map(f64::from));
        let dir = lanes.load4(&[dx, dy, dz, 1.0].map(f64::from));
        let mirrored = lanes.less4(dir, lanes.splat4(0.0));
        let size = lanes.load4(&grid.axes.size);
        let position = origin - lanes.load4(&grid.axes.lo);
        let position = lanes.select4(mirrored, size - position, position);
        let near = lanes.less4(lanes.abs4(position), lanes.splat4(NEAR) * size);
        let finite = lanes.less4(lanes.abs4(dir), lanes.splat4(f64::INFINITY));
        if lanes.bits4(near & finite) != 0b1111 || steepest == 0.0 || ray.t_min >= ray.t_max {
            return Self::clip_any(lanes, ray, grid, mirrored);
        }
        let least = steepest * LEAST_SPEED;
        let speeds = lanes.max4(lanes.abs4(dir), lanes.load4(&[least, least, least, 0.0]));
        let inverse = lanes.splat4(1.0) / speeds;
        let (near, far) = (lanes.load4(&grid.axes.near), lanes.load4(&grid.axes.far));
        let start = lanes.greatest4((near - position) * inverse);
        let end = lesser(lanes.least4((far - position) * inverse), rounds_to(ray.t_max));
        // Not where t_max is NaN.
        let meets = start <= end;
        if !meets {
            return Clip::Miss;
        }
        Clip::Path(Self {
            origin: (position + lanes.splat4(start) * speeds) * lanes.splat4(grid.axes.per_length),
            width: lanes.splat4(steepest) * inverse,
            mirrored,
            octant: lanes.bits4(mirrored),
            clock: Clock::new(steepest * grid.axes.per_length, start, 0.0),
        })
    }

    /// The same for any ray.
    #[inline(always)]
    fn clip_any(lanes: L, ray: &Ray, grid: &Grid, mirrored: L::Mask4) -> Clip<L> {
        match FarPath::clip(ray, grid) {
            Ok(Some(FarPath { origin, width, clock })) => Clip::Path(Self {
                origin: lanes.load4(&origin),
                width: lanes.load4(&width),
                mirrored,
                octant: lanes.bits4(mirrored),
                clock,
            }),
            Ok(None) => Clip::Miss,
            Err(TooFar) => Clip::TooFar,
        }
    }
}

/// A [`Path`] of a ray whose origin may be far away.
struct FarPath {
    origin: [f64; 4],
    width: [f64; 4],
    clock: Clock,
}

/// f64 can't place the origin.
struct TooFar;

impl FarPath {
    #[cold]
    #[inline(never)]
    fn clip(ray: &Ray, grid: &Grid) -> Result<Option<Self>, TooFar> {
        // Bounds the error of a quotient of differences, but for 2^-52 of the grid's width, by which the scene
        // is certainly inside.
        const SLACK: f64 = 1.0 / (1u64 << 51) as f64;
        if !ray.is_valid() {
            return Ok(None);
        }
        let (mut enter, mut leave) = (f64::from(ray.t_min), rounds_to(ray.t_max));
        for axis in 0..3 {
            let size = grid.axes.size[axis];
            let position = f64::from(ray.origin[axis]) - grid.lo[axis];
            let d = f64::from(ray.dir[axis]);
            if d == 0.0 {
                if position < -SLACK * size || position > (1.0 + SLACK) * size {
                    return Ok(None);
                }
                continue;
            }
            let (a, b) = (-position / d, (size - position) / d);
            let (near, far) = if d < 0.0 { (b, a) } else { (a, b) };
            enter = enter.max(near - SLACK * near.abs());
            leave = leave.min(far + SLACK * far.abs());
        }
        if enter <= leave { Self::from(ray, grid, enter).map(Some) } else { Ok(None) }
    }

    fn from(ray: &Ray, grid: &Grid, start: f64) -> Result<Self, TooFar> {
        /// Places in units S of the grid's size up to which their errors stay below 2^-38 S.
        const FAR: f64 = 4096.0;
        let octant = ray.octant();
        let steepest = f64::from(ray.dir.abs().max_element());
        let (mut origin, mut width, mut delay) = ([0.0; 4], [1.0; 4], 0f64);
        for axis in 0..3 {
            let speed = f64::from(ray.dir[axis]).abs().max(steepest * LEAST_SPEED);
            width[axis] = steepest / speed;
            let place = advance(ray, axis, start, grid.lo[axis]) / grid.cell;
            let place = if octant >> axis & 1 != 0 { f64::from(grid.dims[axis]) - place } else { place };
            if place.is_nan() || place.abs() > FAR * f64::from(grid.longest()) {
                return Err(TooFar);
            }
            origin[axis] = place;
            // Rounding puts the start before the grid.
            delay = delay.max(-place * width[axis]);
        }
        for axis in 0..3 {
            origin[axis] += delay / width[axis];
        }
        Ok(Self { origin, width, clock: Clock::new(steepest / grid.cell, start, delay) })
    }
}

/// Turns t into time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Clock {
    /// Time a unit of t.
    speed: f64,
    /// The time of t = 0, rounded up.
    zero: f64,
}

impl Clock {
    /// Bounds the rounding of the time of t = 0.
    const SLACK: f64 = 1.0 / (1u64 << 50) as f64;

    /// Of a path that starts `delay` after the time of t = `start`.
    #[inline(always)]
    fn new(speed: f64, start: f64, delay: f64) -> Self {
        let back = start * speed;
        Self { speed, zero: (back.abs() + delay) * Self::SLACK + LEAST * speed - (back + delay) }
    }

    /// A time no hit comes after whose distance rounds to `t` or less.
    #[inline(always)]
    fn time(self, t: f32) -> f64 {
        // Twice half a unit in the last place of t, so that rounding here is covered.
        self.later(t, 2.0 * HALF_ULP) + self.zero
    }

    /// The same in f32, later by a few ulps of its terms. Short, as the walk waits for it.
    #[inline(always)]
    pub(crate) fn rounded_time(self, t: f32) -> f32 {
        const MORE: f64 = 4.0 * HALF_ULP;
        (self.later(t, MORE) + (self.zero + (self.zero.abs() * MORE + 2.0 * LEAST))) as f32
    }

    /// The time from t = 0 to `t`, raised by `more` of itself.
    #[inline(always)]
    fn later(self, t: f32, more: f64) -> f64 {
        let t = f64::from(t);
        greater(t * (self.speed * (1.0 + more)), t * (self.speed * (1.0 - more)))
    }
}

/// The time after which a walk finds nothing more: that of the query's `t_max`, or when it leaves the grid.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limit {
    t_max: f32,
    end: f64,
    /// No hit that rounds to `t_max` or less comes later.
    pub(crate) time: f64,
}

impl Limit {
    /// `end` is when the path leaves the grid, or infinity.
    #[inline(always)]
    pub(crate) fn new(clock: Clock, end: f64, t_max: f32) -> Self {
        Self { t_max, end, time: lesser(clock.time(t_max), end) }
    }

    /// Follows `t_max`, and says whether it has changed.
    #[inline(always)]
    pub(crate) fn update(&mut self, clock: Clock, t_max: f32) -> bool {
        let changed = t_max != self.t_max;
        if changed {
            *self = Self::new(clock, self.end, t_max);
        }
        changed
    }
}

/// Origins so near, in sizes of the grid, that rounding stays within what the grid is larger than the scene.
const NEAR: f64 = 256.0;

/// Rounding moves a plane that is left last by less, and the scene is inside the grid by more.
const EARLY: f64 = 1.0 - 1.0 / (1u64 << 40) as f64;

/// The least speed along an axis, relative to the largest.
const LEAST_SPEED: f64 = 1.0 / (1u64 << 60) as f64;

/// The lesser one of two numbers, `b` where one is NaN: one instruction, as f64's own is not.
#[inline(always)]
fn lesser(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// The greater one of two numbers, likewise.
#[inline(always)]
fn greater(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
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
        // Constant indices keep the state in registers.
        match self.axis() {
            0 => self.exit[0] <= limit && self.cross(0, steps),
            1 => self.exit[1] <= limit && self.cross(1, steps),
            _ => self.exit[2] <= limit && self.cross(2, steps),
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
