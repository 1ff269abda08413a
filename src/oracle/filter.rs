//! A quick f64 test that sorts out most triangles that a ray certainly misses.
//!
//! The ray's line misses a triangle where two of the side functions (see [`super::exact`]) differ in
//! sign. With factors from f32 no product of three overflows or underflows in f64, and a difference
//! has one rounding, so that the error of a side function is below 10 * 2^-53 times the sum of the
//! absolute values of its terms. [`MARGIN`] is 2^13 / 10 times as much.

use glam::{DVec3, Vec3};

use crate::ray::Ray;

const MARGIN: f64 = 1.0 / (1u64 << 40) as f64;

/// The line of one ray.
pub(super) struct Filter {
    origin: DVec3,
    dir: DVec3,
}

impl Filter {
    pub(super) fn new(ray: &Ray) -> Self {
        Self { origin: ray.origin.as_dvec3(), dir: ray.dir.as_dvec3() }
    }

    /// False only where the line certainly misses the triangle, under every edge rule.
    #[inline]
    pub(super) fn may_meet(&self, corners: [Vec3; 3]) -> bool {
        let p = corners.map(|v| v.as_dvec3());
        let signs = [0, 1, 2].map(|i| self.side_sign(p[i], p[(i + 1) % 3]));
        !(signs.contains(&1) && signs.contains(&-1))
    }

    /// The sign of d.((p-o) x (q-p)), or 0 where it isn't certain.
    #[inline]
    fn side_sign(&self, p: DVec3, q: DVec3) -> i8 {
        let (a, b) = (p - self.origin, q - p);
        let (x, y) = (a.abs(), b.abs());
        let value = self.dir.dot(a.cross(b));
        let terms = DVec3::new(x.y * y.z + x.z * y.y, x.z * y.x + x.x * y.z, x.x * y.y + x.y * y.x);
        let margin = MARGIN * self.dir.abs().dot(terms);
        i8::from(value > margin) - i8::from(value < -margin)
    }
}
