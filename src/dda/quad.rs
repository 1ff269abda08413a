//! Four rays clipped to a grid at once, a lane each: a third of the instructions a ray.
//!
//! The operations and their order are those of [`Path::clip`](super::Path::clip) and [`Dda::new`], which have an
//! axis a lane, so that errors are the same.

use super::clock::{Clock, HALF_ULP, LEAST};
use super::path::{LEAST_SPEED, NEAR};
use super::{Dda, EARLY, ROUNDING, Steps, integer};
use crate::arena::{Grid, GridAxes};
use crate::lanes::{Lanes, axes};
use crate::ray::Ray;

/// Where four rays start, and what their steps add: by axis and ray.
pub(crate) struct Quad {
    /// The rays that meet the scene's box, as bits.
    pub(crate) entering: u32,
    /// The rays that have to be clipped alone.
    pub(crate) alone: u32,
    mirrored: [u32; 3],
    exit: [[f64; 4]; 3],
    width: [[f64; 4]; 3],
    /// With [`ROUNDING`] added, as is the voxel.
    stride: [[f64; 4]; 3],
    voxel: [f64; 4],
    end: [f64; 4],
    slope: [[f64; 4]; 3],
    delay: [[f64; 4]; 3],
    speed: [f64; 4],
    zero: [f64; 4],
}

impl Quad {
    /// Clips rays to the scene's box in the grid.
    #[inline(always)]
    pub(crate) fn new<L: Lanes>(lanes: L, rays: &[Ray; 4], grid: &Grid) -> Self {
        let grid = &grid.axes;
        let clipped = Clipped::new(lanes, rays, grid);
        let per_length = lanes.splat4(grid.per_length);
        let speed = clipped.steepest * per_length;
        let back = clipped.start * speed;
        let slack = lanes.abs4(back) * lanes.splat4(Clock::SLACK);
        let mut quad = Self {
            entering: clipped.entering,
            alone: clipped.alone,
            mirrored: axes(
                #[inline(always)]
                |axis| lanes.bits4(clipped.mirrored[axis]),
            ),
            exit: [[0.0; 4]; 3],
            width: [[0.0; 4]; 3],
            stride: [[0.0; 4]; 3],
            voxel: [0.0; 4],
            end: [0.0; 4],
            slope: [[0.0; 4]; 3],
            delay: [[0.0; 4]; 3],
            speed: lanes.store4(speed),
            zero: lanes.store4(slack + lanes.splat4(LEAST) * speed - back),
        };
        let (rounding, one) = (lanes.splat4(ROUNDING), lanes.splat4(1.0));
        let (mut voxel, mut end) = (rounding, lanes.splat4(f64::INFINITY));
        for axis in 0..3 {
            let mirrored = clipped.mirrored[axis];
            let origin = (clipped.position[axis] + clipped.start * clipped.speed[axis]) * per_length;
            let width = clipped.steepest * clipped.inverse[axis];
            let dims = lanes.splat4(grid.dims[axis]);
            let index = lanes.max4(origin - lanes.splat4(0.5), lanes.splat4(0.0));
            let index = lanes.min4(index, dims - one) + rounding - rounding;
            let left = dims - one - index;
            let exit = (index + one - origin) * width;
            end = lanes.min4(end, exit + left * width);
            let stride = lanes.splat4(grid.strides[axis]);
            voxel = voxel + lanes.select4(mirrored, left, index) * stride;
            let slope = lanes.select4(mirrored, -width, width);
            quad.exit[axis] = lanes.store4(exit);
            quad.width[axis] = lanes.store4(width);
            quad.stride[axis] = lanes.store4(lanes.select4(mirrored, -stride, stride) + rounding);
            quad.slope[axis] = lanes.store4(slope);
            quad.delay[axis] = lanes.store4(-slope * lanes.select4(mirrored, dims - origin, origin));
        }
        quad.voxel = lanes.store4(voxel);
        quad.end = lanes.store4(end * lanes.splat4(EARLY));
        quad
    }

    /// What [`Dda::new`] is for a ray that meets the box, but for the count of voxels.
    #[inline(always)]
    pub(crate) fn dda(&self, ray: usize) -> (Dda, Steps) {
        let exit = axes(
            #[inline(always)]
            |axis| self.exit[axis][ray],
        );
        let width = axes(
            #[inline(always)]
            |axis| self.width[axis][ray],
        );
        let stride = axes(
            #[inline(always)]
            |axis| integer(self.stride[axis][ray]),
        );
        let voxel = integer(self.voxel[ray]) as u32;
        (Dda { exit, left: [0; 3], voxel }, Steps { width, stride, end: self.end[ray] })
    }

    #[inline(always)]
    pub(crate) fn clock(&self, ray: usize) -> Clock {
        Clock { speed: self.speed[ray], zero: self.zero[ray] }
    }

    /// Bit a: axis a is mirrored.
    #[inline(always)]
    pub(crate) fn octant(&self, ray: usize) -> u32 {
        let [x, y, z] = self.mirrored;
        x >> ray & 1 | (y >> ray & 1) << 1 | (z >> ray & 1) << 2
    }

    /// Time a cell along an axis, with the sign of the direction.
    #[inline(always)]
    pub(crate) fn slope(&self, axis: usize, ray: usize) -> f32 {
        self.slope[axis][ray] as f32
    }

    /// Minus the time at which the path passes the grid's lower corner along an axis.
    #[inline(always)]
    pub(crate) fn delay(&self, axis: usize, ray: usize) -> f32 {
        self.delay[axis][ray] as f32
    }
}

/// Four rays where they enter the scene's box; lanes as in [`Path`](super::Path), lengths as in the scene.
struct Clipped<L: Lanes> {
    entering: u32,
    alone: u32,
    steepest: L::F64,
    start: L::F64,
    mirrored: [L::Mask4; 3],
    position: [L::F64; 3],
    speed: [L::F64; 3],
    inverse: [L::F64; 3],
}

impl<L: Lanes> Clipped<L> {
    #[inline(always)]
    fn new(lanes: L, rays: &[Ray; 4], grid: &GridAxes) -> Self {
        let rays = bytemuck::cast_ref(rays);
        let (t_min, t_max) = (values(lanes, rays, 3), values(lanes, rays, 7));
        let dir = [values(lanes, rays, 4), values(lanes, rays, 5), values(lanes, rays, 6)];
        let size = [lanes.abs4(dir[0]), lanes.abs4(dir[1]), lanes.abs4(dir[2])];
        let (none, infinity) = (lanes.splat4(0.0), lanes.splat4(f64::INFINITY));
        let steepest = lanes.max4(lanes.max4(size[0], size[1]), size[2]);
        let least = steepest * lanes.splat4(LEAST_SPEED);
        let mut fit = lanes.less4(none, steepest)
            & lanes.less4(t_min, t_max)
            & lanes.less4(lanes.abs4(t_min), infinity);
        let mut start = t_min;
        let mut end = t_max + (lanes.abs4(t_max) * lanes.splat4(HALF_ULP) + lanes.splat4(LEAST));
        let mirrored = [lanes.less4(dir[0], none), lanes.less4(dir[1], none), lanes.less4(dir[2], none)];
        let (mut positions, mut speeds, mut inverses) = ([none; 3], [none; 3], [none; 3]);
        for axis in 0..3 {
            let width = lanes.splat4(grid.size[axis]);
            let position = values(lanes, rays, axis) - lanes.splat4(grid.lo[axis]);
            let position = lanes.select4(mirrored[axis], width - position, position);
            let near = lanes.less4(lanes.abs4(position), lanes.splat4(NEAR) * width);
            fit = fit & near & lanes.less4(size[axis], infinity);
            let speed = lanes.max4(size[axis], least);
            let inverse = lanes.splat4(1.0) / speed;
            start = lanes.max4(start, (lanes.splat4(grid.near[axis]) - position) * inverse);
            end = lanes.min4(end, (lanes.splat4(grid.far[axis]) - position) * inverse);
            (positions[axis], speeds[axis], inverses[axis]) = (position, speed, inverse);
        }
        let fit = lanes.bits4(fit) & 0xf;
        Self {
            entering: fit & !lanes.bits4(lanes.less4(end, start)),
            alone: !fit & 0xf,
            steepest,
            start,
            mirrored,
            position: positions,
            speed: speeds,
            inverse: inverses,
        }
    }
}

/// One value of each ray, in the order of [`Ray`].
#[inline(always)]
fn values<L: Lanes>(lanes: L, rays: &[[f32; 8]; 4], at: usize) -> L::F64 {
    lanes.load4(&[
        f64::from(rays[0][at]),
        f64::from(rays[1][at]),
        f64::from(rays[2][at]),
        f64::from(rays[3][at]),
    ])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dda::{Clip, Path};
    use crate::lanes::{Isa, dispatch};
    use crate::rng::Rng;

    /// A ray to a point in a box of 5 from around it, some of them unusual.
    fn ray(rng: &mut Rng) -> Ray {
        let point = |rng: &mut Rng, size: f64| [(); 3].map(|()| rng.range(-size, size) as f32);
        let (origin, target) = (point(rng, 9.0), point(rng, 2.5));
        let unusual = [0.0, -0.0, 1e-30, f32::NAN, f32::INFINITY];
        let dir = [0, 1, 2].map(|axis| match rng.below(16) {
            0 => unusual[rng.below(5)],
            _ => target[axis] - origin[axis],
        });
        let far = if rng.below(8) == 0 { 1e9 } else { 1.0 };
        let t = [0.0, f32::INFINITY, 4.0, -3.0, f32::NAN];
        let [t_min, t_max] =
            if rng.below(4) == 0 { [t[rng.below(5)], t[rng.below(5)]] } else { [0.0, f32::INFINITY] };
        Ray::new(origin.map(|x| far * x), dir).with_interval(t_min, t_max)
    }

    #[test]
    fn four_rays_are_clipped_as_each_is() {
        let grid = Grid::new([-2.5, -2.0, -1.0], 0.5, [10, 8, 4]);
        let rng = &mut Rng::new(1);
        let (mut entering, mut alone) = (0, 0);
        for _ in 0..5000 {
            let rays = [(); 4].map(|()| ray(rng));
            for isa in Isa::available() {
                dispatch!(isa, lanes => {
                    let quad = Quad::new(lanes, &rays, &grid);
                    for i in 0..4 {
                        if quad.alone >> i & 1 != 0 {
                            alone += 1;
                            continue;
                        }
                        let Clip::Path(path) = Path::clip(lanes, &rays[i], &grid) else {
                            assert_eq!(quad.entering >> i & 1, 0, "{:?}", rays[i]);
                            continue;
                        };
                        assert_eq!(quad.entering >> i & 1, 1, "{:?}", rays[i]);
                        let (dda, steps) = Dda::new(lanes, &path, &grid);
                        let (dda4, steps4) = quad.dda(i);
                        assert_eq!((dda.exit, dda.voxel), (dda4.exit, dda4.voxel), "{:?}", rays[i]);
                        assert_eq!(steps, steps4, "{:?}", rays[i]);
                        assert_eq!((path.octant, path.clock), (quad.octant(i), quad.clock(i)), "{:?}", rays[i]);
                        let (slope, delay) = (path.slope(lanes), path.delay(lanes, &grid));
                        let (slope, delay) = (lanes.store4(slope), lanes.store4(delay));
                        for axis in 0..3 {
                            let alone = (slope[axis] as f32, delay[axis] as f32);
                            assert_eq!(alone, (quad.slope(axis, i), quad.delay(axis, i)), "{:?}", rays[i]);
                        }
                        entering += 1;
                    }
                });
            }
        }
        assert!(entering > 10_000 && alone > 1000, "{entering} {alone}");
    }
}
