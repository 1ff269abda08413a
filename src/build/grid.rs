//! The resolution of a grid.

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
    // A little wider, so that rounding keeps the far side inside.
    centred(lo, extent, large * (1.0 + 1e-9), dims_of(large))
}

/// One cube around `bounds`.
pub(crate) fn cube(bounds: &Aabb) -> Grid {
    let (lo, extent) = corner_and_extent(bounds);
    let longest = extent.into_iter().fold(0.0, f64::max);
    let side = if longest == 0.0 { 1.0 } else { longest * (1.0 + 1e-9) };
    centred(lo, extent, side, [1; 3])
}

fn corner_and_extent(bounds: &Aabb) -> ([f64; 3], [f64; 3]) {
    if bounds.lo.cmpgt(bounds.hi).any() {
        return ([0.0; 3], [0.0; 3]);
    }
    let lo = bounds.lo.as_dvec3().to_array();
    (lo, (bounds.hi.as_dvec3() - bounds.lo.as_dvec3()).to_array())
}

/// The grid whose middle is the middle of the scene.
fn centred(lo: [f64; 3], extent: [f64; 3], cell: f64, dims: [u32; 3]) -> Grid {
    let lo = std::array::from_fn(|axis| lo[axis] + 0.5 * (extent[axis] - f64::from(dims[axis]) * cell));
    Grid::new(lo, cell, dims)
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
    fn the_grid_covers_the_scene() {
        for hi in [[4.0, 2.0, 1.0], [1e30, 1e-30, 3.0], [1e-40, 1e-41, 0.0]] {
            for target in [1.0, 100.0, 1e6] {
                for grid in [cubic(&bounds(hi), target), cube(&bounds(hi))] {
                    let far = grid.corner(grid.dims);
                    for axis in 0..3 {
                        assert!(grid.lo[axis] <= 0.0 && far[axis] >= f64::from(hi[axis]), "{hi:?} {grid:?}");
                    }
                }
            }
        }
    }
}
