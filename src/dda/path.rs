//! A ray clipped to a grid.

use super::clock::{Clock, rounds_to};
use crate::arena::Grid;
use crate::exact::{two_product, two_sum};
use crate::lanes::{Lanes, lesser};
use crate::ray::Ray;

/// Origins so near, in sizes of the grid, that rounding stays within what the grid is larger than the scene.
pub(super) const NEAR: f64 = 256.0;

/// The least speed along an axis, relative to the largest.
pub(super) const LEAST_SPEED: f64 = 1.0 / (1u64 << 60) as f64;

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

    /// Time a cell, with the sign of the direction.
    #[inline(always)]
    pub(crate) fn slope(&self, lanes: L) -> L::F64 {
        lanes.select4(self.mirrored, -self.width, self.width)
    }

    /// Minus the time at which the path passes the grid's lower corner along each axis.
    #[inline(always)]
    pub(crate) fn delay(&self, lanes: L, grid: &Grid) -> L::F64 {
        let dims = lanes.load4(&grid.axes.dims);
        -self.slope(lanes) * lanes.select4(self.mirrored, dims - self.origin, self.origin)
    }

    /// [`Path::clip`] of any ray.
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

/// origin - lo + t * dir along one axis, to 2^-53 of the result and 2^-105 of the origin's distance: in two
/// terms, since for an origin far away the sum cancels.
#[inline]
fn advance(ray: &Ray, axis: usize, t: f64, lo: f64) -> f64 {
    let (position, position_error) = two_sum(f64::from(ray.origin[axis]), -lo);
    let (step, step_error) = two_product(t, f64::from(ray.dir[axis]));
    let (sum, sum_error) = two_sum(position, step);
    sum + (sum_error + position_error + step_error)
}
