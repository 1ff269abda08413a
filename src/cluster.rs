//! Clusters: the primitive of every structure.
//!
//! Up to eight neighbouring triangles as a structure of arrays, so that one SIMD test serves all of
//! them. Each triangle lives in one cluster; voxels refer to clusters.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

use crate::aabb::Aabb;
use crate::lanes::{Lanes, WIDTH};
use crate::triangle::Vec3Lanes;

/// Up to eight triangles.
///
/// Lanes beyond the last triangle repeat the first one, with the id [`Cluster::NO_TRIANGLE`].
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(64))]
pub(crate) struct Cluster {
    /// Coordinates by corner, axis and lane.
    corners: [[[f32; WIDTH]; 3]; 3],
    ids: [u32; WIDTH],
}

const _: () = assert!(size_of::<Cluster>() == 320);

impl Cluster {
    /// The id of a lane without a triangle.
    pub(crate) const NO_TRIANGLE: u32 = u32::MAX;

    /// Gathers one to eight triangles.
    pub(crate) fn new(triangles: &[(u32, [Vec3; 3])]) -> Self {
        debug_assert!((1..=WIDTH).contains(&triangles.len()));
        let mut cluster = Self { corners: [[[0.0; WIDTH]; 3]; 3], ids: [Self::NO_TRIANGLE; WIDTH] };
        for lane in 0..WIDTH {
            let (id, corners) = triangles.get(lane).unwrap_or(&triangles[0]);
            for (corner, position) in corners.iter().enumerate() {
                for axis in 0..3 {
                    cluster.corners[corner][axis][lane] = position[axis];
                }
            }
            if lane < triangles.len() {
                cluster.ids[lane] = *id;
            }
        }
        cluster
    }

    /// The ids of the triangles; [`Cluster::NO_TRIANGLE`] in lanes that have none.
    pub(crate) fn ids(&self) -> &[u32; WIDTH] {
        &self.ids
    }

    /// The lanes that hold a triangle, as bits.
    pub(crate) fn occupied(&self) -> u8 {
        (0..WIDTH).map(|lane| u8::from(self.ids[lane] != Self::NO_TRIANGLE) << lane).sum()
    }

    /// The corners of the triangle in one lane.
    #[inline(always)]
    pub(crate) fn triangle(&self, lane: usize) -> [Vec3; 3] {
        self.corners.each_ref().map(|c| Vec3::new(c[0][lane], c[1][lane], c[2][lane]))
    }

    /// All corners, for the kernels.
    #[inline(always)]
    pub(crate) fn lanes<L: Lanes>(&self, lanes: L) -> [Vec3Lanes<L>; 3] {
        self.corners.each_ref().map(|corner| corner.each_ref().map(|axis| lanes.load(axis)))
    }

    /// The box around the triangles of the lanes in `mask`.
    pub(crate) fn bounds(&self, mask: u8) -> Aabb {
        (0..WIDTH)
            .filter(|lane| mask >> lane & 1 != 0)
            .fold(Aabb::EMPTY, |b, lane| b.union(Aabb::around(self.triangle(lane))))
    }
}
