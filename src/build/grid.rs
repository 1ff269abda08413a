//! The resolution of a grid, and which voxel a box counts for.

use glam::Vec4;

use crate::aabb::Aabb;
use crate::arena::Grid;

/// More voxels than this along one axis make steps and rounding errors grow and help no scene.
const MAX_DIMS: u32 = 1024;

/// A grid of cubes over `bounds` with at most `target` voxels (at least one), as many as come near it.
///
/// The number along each axis is proportional to the extent; an axis along which the scene is flat
/// gets one.
pub(crate) fn cubic(bounds: &Aabb, target: f64) -> Grid {
    let (lo, extent) = corner_and_extent(bounds);
    let longest = extent.into_iter().fold(0.0, f64::max);
    if longest == 0.0 {
        return Grid::new(lo, 1.0, [1; 3]);
    }
    let dims_of = |cell: f64| extent.map(|e| ((e / cell).ceil() as u32).clamp(1, MAX_DIMS));
    let voxels = |cell: f64| dims_of(cell).into_iter().map(f64::from).product::<f64>();
    // The number of voxels falls as the cells grow: bisection.
    let (mut small, mut large) = (longest / f64::from(MAX_DIMS), longest);
    if voxels(small) <= target {
        large = small;
    }
    for _ in 0..24 {
        let middle = (small * large).sqrt();
        if voxels(middle) > target {
            small = middle;
        } else {
            large = middle;
        }
    }
    centred(lo, extent, widened(large, bounds), dims_of(large))
}

/// One cube around `bounds`.
pub(crate) fn cube(bounds: &Aabb) -> Grid {
    let (lo, extent) = corner_and_extent(bounds);
    let longest = extent.into_iter().fold(0.0, f64::max);
    let side = if longest == 0.0 { 1.0 } else { widened(longest, bounds) };
    centred(lo, extent, side, [1; 3])
}

/// The lower corner and the extents in f64, in which they don't overflow; zeros where the box is empty.
pub(super) fn corner_and_extent(bounds: &Aabb) -> ([f64; 3], [f64; 3]) {
    if bounds.lo.cmpgt(bounds.hi).any() {
        return ([0.0; 3], [0.0; 3]);
    }
    let lo = bounds.lo.as_dvec3().to_array();
    (lo, (bounds.hi.as_dvec3() - bounds.lo.as_dvec3()).to_array())
}

/// A little wider, so that in spite of rounding the scene lies inside by 2^-32 of the grid's width along
/// each axis: a walk may leave the grid too early, but only by less. Far from the origin a few units in the
/// last place of the coordinates are more.
fn widened(cell: f64, bounds: &Aabb) -> f64 {
    let farthest = f64::from(bounds.lo.abs().max(bounds.hi.abs()).max_element());
    cell * (1.0 + (farthest / (1u64 << 50) as f64 / cell).max(1e-9))
}

/// The grid whose middle is the middle of the scene.
fn centred(lo: [f64; 3], extent: [f64; 3], cell: f64, dims: [u32; 3]) -> Grid {
    let lo = std::array::from_fn(|axis| lo[axis] + 0.5 * (extent[axis] - f64::from(dims[axis]) * cell));
    Grid::new(lo, cell, dims)
}

/// From here on f32 are whole numbers: adding it rounds to the last bits.
pub(super) const WHOLE: f32 = (1u32 << 23) as f32;

/// Which voxel of a grid the centre of a box is in, but for rounding.
pub(super) struct Places {
    lo: Vec4,
    per_length: f32,
    last: [u32; 3],
    strides: [u32; 3],
}

impl Places {
    pub(super) fn new(grid: &Grid) -> Self {
        let [x, y, z] = grid.lo.map(|x| x as f32);
        Self {
            lo: Vec4::new(x, y, z, 0.0),
            per_length: grid.axes.per_length as f32,
            last: grid.dims.map(|n| n - 1),
            strides: grid.strides(),
        }
    }

    /// The index of the voxel along each axis.
    #[inline(always)]
    pub(super) fn at(&self, b: &Aabb) -> [u32; 3] {
        let place = ((b.center4() - self.lo) * self.per_length - 0.5).max(Vec4::ZERO) + WHOLE;
        let place = place.to_array();
        // Infinity and NaN, in scenes at the ends of the range of f32, are above all others.
        let index = |axis: usize| place[axis].to_bits().wrapping_sub(WHOLE.to_bits()).min(self.last[axis]);
        [index(0), index(1), index(2)]
    }

    #[inline(always)]
    pub(super) fn of(&self, b: &Aabb) -> u32 {
        let at = self.at(b);
        (0..3).map(|axis| at[axis] * self.strides[axis]).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn bounds(hi: [f32; 3]) -> Aabb {
        Aabb { lo: Vec3::ZERO, hi: Vec3::from_array(hi) }
    }

    #[test]
    fn dims_follow_the_extents() {
        assert_eq!(cubic(&bounds([4.0, 2.0, 1.0]), 1000.0).dims, [20, 10, 5]);
        assert_eq!(cubic(&bounds([1.0, 1.0, 0.0]), 100.0).dims, [10, 10, 1]);
        assert_eq!(cubic(&bounds([1.0, 0.0, 0.0]), 100.0).dims, [100, 1, 1]);
        assert_eq!(cubic(&bounds([1.0; 3]), 0.0).dims, [1; 3]);
        assert_eq!(cubic(&bounds([0.0; 3]), 9.0).dims, [1; 3]);
        assert_eq!(cubic(&bounds([1.0, 0.0, 0.0]), 1e9).dims, [1024, 1, 1]);
    }

    #[test]
    fn centres_are_in_the_grid() {
        let middle = |grid: &Grid, at: Vec3| Places::new(grid).of(&Aabb { lo: at, hi: at });
        let grid = cubic(&bounds([4.0, 2.0, 1.0]), 1000.0);
        assert_eq!(middle(&grid, Vec3::new(3.9, 0.1, 0.5)), 19 + 20 * 10 * 2);
        for size in [1e-45, 1e-41, 1.0, 3e38] {
            let bounds = Aabb { lo: Vec3::splat(-size), hi: Vec3::splat(size) };
            let grid = cubic(&bounds, 1000.0);
            for at in [bounds.lo, Vec3::ZERO, bounds.hi] {
                assert!((middle(&grid, at) as usize) < grid.len(), "{size} {at}");
            }
        }
    }

    /// Each side lies inside by more than 2^-32 of the grid's width; differences of close f64 are exact.
    fn assert_covers(grid: &Grid, bounds: &Aabb) {
        for axis in 0..3 {
            let width = f64::from(grid.dims[axis]) * grid.cell;
            let room = width / (1u64 << 32) as f64;
            let below = f64::from(bounds.lo[axis]) - grid.lo[axis];
            let above = width - (f64::from(bounds.hi[axis]) - grid.lo[axis]);
            assert!(below > room && above > room, "{bounds:?} {grid:?}");
        }
    }

    #[test]
    fn the_grid_covers_the_scene() {
        for hi in [[4.0, 2.0, 1.0], [1e30, 1e-30, 3.0], [1e-40, 1e-41, 0.0]] {
            for target in [1.0, 100.0, 1e6] {
                for grid in [cubic(&bounds(hi), target), cube(&bounds(hi))] {
                    assert_covers(&grid, &bounds(hi));
                }
            }
        }
    }

    /// A strip as wide as a few units in the last place of its coordinates, in cells as wide as itself.
    #[test]
    fn the_grid_covers_a_thin_scene_far_from_the_origin() {
        for place in [1.0f32, 1.1, 1.5, -1.7] {
            for units in 1..8 {
                let hi = f32::from_bits(place.to_bits() + units);
                let (lo, hi) = (Vec3::new(-0.5, place.min(hi), 0.0), Vec3::new(0.5, place.max(hi), 0.0));
                let wide = f64::from(hi.y - lo.y);
                for scale in [1.0, (1024.0 * wide) as f32] {
                    let s = Vec3::new(scale, 1.0, 1.0);
                    let bounds = Aabb { lo: lo * s, hi: hi * s };
                    assert_covers(&cubic(&bounds, 1e5), &bounds);
                    assert_covers(&cube(&bounds), &bounds);
                }
            }
        }
    }
}
