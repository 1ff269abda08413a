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
pub(super) struct Cuboid {
    pub(super) lo: [f64; 3],
    pub(super) side: [f64; 3],
}

impl Cuboid {
    /// Its longest side.
    pub(super) fn longest(&self) -> f64 {
        self.side.into_iter().fold(0.0, f64::max)
    }

    /// The cuboid enlarged by `margin`, rounded outwards.
    pub(super) fn enlarged(&self, margin: f64) -> Aabb {
        let down = |x: f64| (x as f32).next_down();
        let up = |x: f64| (x as f32).next_up();
        Aabb {
            lo: Vec3::from_array(self.lo.map(|x| down(x - margin))),
            hi: Vec3::from_array(std::array::from_fn(|i| up(self.lo[i] + self.side[i] + margin))),
        }
    }
}

/// The voxels that a box is divided into: those of the top grid, or the parts of a voxel.
pub(super) struct Voxels {
    lo: [f64; 3],
    /// The sides of each.
    side: [f64; 3],
    per_length: [f64; 3],
    dims: [u32; 3],
}

impl From<&Grid> for Voxels {
    fn from(grid: &Grid) -> Self {
        Self::new(grid.lo, [grid.cell; 3], grid.dims)
    }
}

impl Voxels {
    pub(super) fn new(lo: [f64; 3], side: [f64; 3], dims: [u32; 3]) -> Self {
        Self { lo, side, per_length: side.map(|side| 1.0 / side), dims }
    }

    /// Their number.
    pub(super) fn len(&self) -> usize {
        self.dims.iter().map(|&n| n as usize).product()
    }

    /// One of them.
    #[inline(always)]
    pub(super) fn at(&self, index: [u32; 3]) -> Cuboid {
        let lo = std::array::from_fn(|axis| self.lo[axis] + f64::from(index[axis]) * self.side[axis]);
        Cuboid { lo, side: self.side }
    }

    /// The one with this place in the order, x fastest.
    pub(super) fn nth(&self, i: usize) -> Cuboid {
        let [x, y, _] = self.dims;
        let i = i as u32;
        self.at([i % x, i / x % y, i / x / y])
    }

    /// All of them together.
    pub(super) fn whole(&self) -> Cuboid {
        Cuboid { lo: self.lo, side: std::array::from_fn(|axis| f64::from(self.dims[axis]) * self.side[axis]) }
    }

    /// The voxels, enlarged by `margin`, that a box overlaps.
    #[inline(always)]
    pub(super) fn range(&self, bounds: &Aabb, margin: f64) -> [Range<u32>; 3] {
        std::array::from_fn(|axis| {
            // As much as rounding to f32 moves the sides of `Cuboid::enlarged`, for the error of the corner.
            let reach = |x: f32| margin + f64::from(x.abs()) / (1u32 << 25) as f64;
            let index = |x: f64| (x * self.per_length[axis]) as u32;
            let last = self.dims[axis] - 1;
            let (lo, hi) = (bounds.lo[axis], bounds.hi[axis]);
            let lo = index(f64::from(lo) - self.lo[axis] - reach(lo)).min(last);
            let hi = index(f64::from(hi) - self.lo[axis] + reach(hi)).min(last);
            lo..hi + 1
        })
    }
}

/// Hands on the voxels, enlarged by `margin`, that an item overlaps, with what of it is in each.
///
/// That the item's box is clipped to the voxel which these divide takes none away: the enlarged voxel
/// reaches beyond them, or they beyond all that is in it.
#[inline(always)]
pub(super) fn scatter<L: Lanes>(
    lanes: L,
    clusters: &[Cluster],
    item: &Item,
    voxels: &Voxels,
    margin: f64,
    mut each: impl FnMut(u32, Item),
) {
    let range = voxels.range(&item.bounds, margin);
    let alone = range.iter().all(|r| r.len() == 1);
    let corners = clusters[item.cluster as usize].lanes(lanes);
    let [nx, ny, _] = voxels.dims;
    for z in range[2].clone() {
        for y in range[1].clone() {
            for x in range[0].clone() {
                let cube = voxels.at([x, y, z]).enlarged(margin);
                let inside = if alone { 0xff } else { overlapping(lanes, corners, &cube) as u8 };
                let mask = item.mask & inside;
                if mask != 0 {
                    let all = if mask == item.mask { item.bounds } else { bounds(lanes, &corners, mask) };
                    let voxel = x + nx * (y + ny * z);
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
            let voxels = Voxels::new([far + off; 3], [1.0; 3], [4; 3]);
            assert_eq!(voxels.range(&touching, 4.0 * LIST_MARGIN), [0..2, 0..2, 0..2]);
        }
    }
}
