//! Clusters: the primitive of every structure.
//!
//! Up to eight neighbouring triangles as a structure of arrays, so that one SIMD test serves all of
//! them. Each triangle lives in one cluster; voxels refer to clusters.

use bytemuck::{Pod, Zeroable};
use glam::{Vec3, Vec4};

use crate::aabb::Aabb;
use crate::filter::{RayLanes, Scale, candidates};
use crate::lanes::{Isa, Lanes, Vec3Lanes, WIDTH, axes, dispatch};
use crate::ray::Ray;

/// Up to eight triangles, for one ray at a time.
///
/// 320 bytes, aligned to 64. Lanes beyond the last triangle repeat the first one, with the id
/// [`Cluster::NO_TRIANGLE`].
///
/// ```
/// use glam::Vec3;
/// use octogrid::{Cluster, Isa, Ray};
/// let cluster = Cluster::new(&[(7, [Vec3::ZERO, Vec3::X, Vec3::Y])]);
/// let ray = Ray::new([0.2, 0.2, 1.0], [0.0, 0.0, -1.0]);
/// assert_eq!(cluster.candidates(Isa::detect(), &ray) & cluster.occupied(), 1);
/// ```
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(64))]
pub struct Cluster {
    /// Coordinates by corner, axis and lane.
    corners: [[[f32; WIDTH]; 3]; 3],
    ids: [u32; WIDTH],
}

const _: () = assert!(size_of::<Cluster>() == 320);

impl Cluster {
    /// The id of a lane without a triangle.
    pub const NO_TRIANGLE: u32 = u32::MAX;

    /// Gathers one to eight triangles with their ids.
    ///
    /// # Panics
    /// Where there are none or more than eight.
    pub fn new(triangles: &[(u32, [Vec3; 3])]) -> Self {
        assert!((1..=WIDTH).contains(&triangles.len()), "a cluster holds one to eight triangles");
        Self::gather(triangles.len(), |lane| triangles[lane])
    }

    /// Gathers one to eight triangles.
    #[inline(always)]
    pub(crate) fn gather(len: usize, triangle: impl Fn(usize) -> (u32, [Vec3; 3])) -> Self {
        let mut cluster = Self { corners: [[[0.0; WIDTH]; 3]; 3], ids: [Self::NO_TRIANGLE; WIDTH] };
        for lane in 0..WIDTH {
            let (id, corners) = triangle(if lane < len { lane } else { 0 });
            for corner in 0..3 {
                for axis in 0..3 {
                    cluster.corners[corner][axis][lane] = corners[corner][axis];
                }
            }
            if lane < len {
                cluster.ids[lane] = id;
            }
        }
        cluster
    }

    /// The ids of the triangles; [`Cluster::NO_TRIANGLE`] in lanes that have none.
    pub fn ids(&self) -> &[u32; WIDTH] {
        &self.ids
    }

    /// The lanes that hold a triangle, as bits.
    pub fn occupied(&self) -> u8 {
        (0..WIDTH).map(|lane| u8::from(self.ids[lane] != Self::NO_TRIANGLE) << lane).sum()
    }

    /// The lanes whose triangle a valid ray may meet within its interval, as bits.
    ///
    /// Never misses one for which [`intersect`](crate::intersect) finds a hit, and seldom names another.
    pub fn candidates(&self, isa: Isa, ray: &Ray) -> u8 {
        dispatch!(isa, lanes => {
            let ray = RayLanes::splat(lanes, ray, Scale::of(ray.dir));
            candidates(lanes, &ray, self.lanes(lanes)) as u8
        })
    }

    /// The corners of the triangle in one lane.
    ///
    /// # Panics
    /// Where `lane` is 8 or more.
    #[inline(always)]
    pub fn triangle(&self, lane: usize) -> [Vec3; 3] {
        self.corners.each_ref().map(|c| Vec3::new(c[0][lane], c[1][lane], c[2][lane]))
    }

    /// All corners, for the kernels.
    #[inline(always)]
    pub(crate) fn lanes<L: Lanes>(&self, lanes: L) -> [Vec3Lanes<L>; 3] {
        axes(
            #[inline(always)]
            |corner| {
                axes(
                    #[inline(always)]
                    |axis| lanes.load(&self.corners[corner][axis]),
                )
            },
        )
    }

    /// The box around the triangles of the lanes in `mask`.
    #[inline(always)]
    pub(crate) fn bounds<L: Lanes>(&self, lanes: L, mask: u8) -> Aabb {
        bounds(lanes, &self.lanes(lanes), mask)
    }
}

/// The box around the triangles of the lanes in `mask`.
#[inline(always)]
pub(crate) fn bounds<L: Lanes>(lanes: L, corners: &[Vec3Lanes<L>; 3], mask: u8) -> Aabb {
    let mut beyond = [0.0; WIDTH];
    for lane in 0..WIDTH {
        beyond[lane] = if mask >> lane & 1 != 0 { 0.0 } else { f32::INFINITY };
    }
    let beyond = lanes.load(&beyond);
    let mut bounds = Aabb::EMPTY;
    for axis in 0..3 {
        let [a, b, c] = [corners[0][axis], corners[1][axis], corners[2][axis]];
        let lo = lanes.store(lanes.min(lanes.min(a, b), c) + beyond);
        let hi = lanes.store(lanes.max(lanes.max(a, b), c) - beyond);
        bounds.lo[axis] = Vec4::from_slice(&lo[..4]).min(Vec4::from_slice(&lo[4..])).min_element();
        bounds.hi[axis] = Vec4::from_slice(&hi[..4]).max(Vec4::from_slice(&hi[4..])).max_element();
    }
    bounds
}
