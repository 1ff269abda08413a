//! Clusters in voxels: which ones a voxel holds, and their boxes there.

use std::ops::Range;

use glam::Vec3;

use crate::aabb::Aabb;
use crate::arena::Grid;
use crate::cluster::{Cluster, bounds};
use crate::lanes::{Lanes, WIDTH};
use crate::overlap::overlapping;

/// A cluster in a voxel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Item {
    /// The box of the triangles that overlap the voxel, clipped to the enlarged voxel. Where only rounding
    /// has let them overlap, `lo` may exceed `hi`.
    pub(crate) bounds: Aabb,
    pub(crate) cluster: u32,
    /// The lanes of these triangles.
    pub(crate) mask: u8,
}

impl Item {
    pub(crate) const NONE: Self = Self { bounds: Aabb::EMPTY, cluster: 0, mask: 0 };

    /// A whole cluster.
    #[inline(always)]
    pub(crate) fn whole<L: Lanes>(lanes: L, index: u32, cluster: &Cluster) -> Self {
        let mask = cluster.occupied();
        Self { bounds: cluster.bounds(lanes, mask), cluster: index, mask }
    }
}

/// A voxel to be judged by a policy.
pub(crate) struct VoxelView<'a> {
    pub(crate) items: &'a [Item],
    pub(crate) clusters: &'a [Cluster],
    /// The voxel, enlarged by the margin.
    pub(crate) bounds: Aabb,
}

impl VoxelView<'_> {
    /// The number of triangles.
    pub(crate) fn triangles(&self) -> usize {
        self.items.iter().map(|item| item.mask.count_ones() as usize).sum()
    }

    /// The triangles.
    pub(crate) fn ids(&self) -> impl Iterator<Item = u32> + '_ {
        self.items.iter().flat_map(|item| {
            let ids = self.clusters[item.cluster as usize].ids();
            (0..WIDTH).filter(|lane| item.mask >> lane & 1 != 0).map(|lane| ids[lane])
        })
    }

    /// The longest side of each triangle's box.
    pub(crate) fn extents(&self) -> impl Iterator<Item = f32> + '_ {
        self.items.iter().flat_map(|item| {
            let cluster = &self.clusters[item.cluster as usize];
            let lanes = (0..WIDTH).filter(|lane| item.mask >> lane & 1 != 0);
            lanes.map(|lane| Aabb::around(cluster.triangle(lane)).extent().max_element())
        })
    }
}

/// A voxel's place.
#[derive(Clone, Copy)]
pub(super) struct Cube {
    pub(super) lo: [f64; 3],
    pub(super) side: f64,
}

impl Cube {
    /// One voxel of a grid.
    pub(super) fn of(grid: &Grid, index: [u32; 3]) -> Self {
        Self { lo: grid.corner(index), side: grid.cell }
    }

    /// The cube enlarged by `margin`, rounded outwards.
    pub(super) fn enlarged(&self, margin: f64) -> Aabb {
        let down = |x: f64| (x as f32).next_down();
        let up = |x: f64| (x as f32).next_up();
        Aabb {
            lo: Vec3::from_array(self.lo.map(|x| down(x - margin))),
            hi: Vec3::from_array(self.lo.map(|x| up(x + self.side + margin))),
        }
    }
}

/// The voxels of `grid`, enlarged by `margin`, that a box overlaps.
#[inline(always)]
pub(super) fn range(bounds: &Aabb, grid: &Grid, margin: f64) -> [Range<u32>; 3] {
    std::array::from_fn(|axis| {
        // As much as rounding to f32 moves the sides of `Cube::enlarged`, for the error of the grid's corner.
        let reach = |x: f32| margin + f64::from(x.abs()) / (1u32 << 25) as f64;
        let index = |x: f64| (x * grid.axes.per_length) as u32;
        let last = grid.dims[axis] - 1;
        let (lo, hi) = (bounds.lo[axis], bounds.hi[axis]);
        let lo = index(f64::from(lo) - grid.lo[axis] - reach(lo)).min(last);
        let hi = index(f64::from(hi) - grid.lo[axis] + reach(hi)).min(last);
        lo..hi + 1
    })
}

/// Hands on the voxels of `grid`, enlarged by `margin`, that an item overlaps, with what of it is in each.
///
/// That the item's box is clipped to a voxel which the grid divides takes none away: the enlarged voxel
/// reaches beyond the grid.
#[inline(always)]
pub(super) fn scatter<L: Lanes>(
    lanes: L,
    clusters: &[Cluster],
    item: &Item,
    grid: &Grid,
    margin: f64,
    mut each: impl FnMut(u32, Item),
) {
    let range = range(&item.bounds, grid, margin);
    let alone = range.iter().all(|r| r.len() == 1);
    let corners = clusters[item.cluster as usize].lanes(lanes);
    let strides = grid.strides();
    for z in range[2].clone() {
        for y in range[1].clone() {
            for x in range[0].clone() {
                let cube = Cube::of(grid, [x, y, z]).enlarged(margin);
                let inside = if alone { 0xff } else { overlapping(lanes, corners, &cube) as u8 };
                let mask = item.mask & inside;
                if mask != 0 {
                    let all = if mask == item.mask { item.bounds } else { bounds(lanes, &corners, mask) };
                    let voxel = x * strides[0] + y * strides[1] + z * strides[2];
                    each(voxel, Item { bounds: all.intersection(cube), mask, ..*item });
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dda::LIST_MARGIN;

    /// Far from the origin rounding moves a grid's corner by more than the margin.
    #[test]
    fn ranges_cover_the_error_of_a_corner() {
        let (far, off) = (2f64.powi(23), 2f64.powi(-26));
        let plane = Vec3::splat(far as f32 + 1.0);
        let touching = Aabb { lo: plane, hi: plane };
        for off in [off, -off] {
            let grid = Grid::new([far + off; 3], 1.0, [4; 3]);
            assert_eq!(range(&touching, &grid, 4.0 * LIST_MARGIN), [0..2, 0..2, 0..2]);
        }
    }
}
