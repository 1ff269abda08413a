//! Ray and triangle in exact arithmetic.
//!
//! Every finite f32 is an integer times a power of two. A ray and a triangle are brought to common
//! powers of two, one for positions and one for the direction, and all that follows are additions
//! and multiplications of integers. With
//!
//! ```text
//! side(p, q) = d.((p-o) x (q-o))        n = (v1-v0) x (v2-v0)
//! w0 = side(v1, v2)   w1 = side(v2, v0)   w2 = side(v0, v1)
//! det = w0 + w1 + w2 = d.n
//! ```
//!
//! the line of the ray passes through the triangle where no w has the sign opposite to det's,
//! at t = (v0-o).n / det, u = w1 / det, v = w2 / det. Where det = 0 the triangle is edge-on or has no
//! area, and is never hit.
//!
//! Under [`EdgeRule::Crossing`] a w of zero takes the sign that it has when the origin moves by
//! (e, e^2, e^3) for an infinitesimal e > 0. The expansion
//! side(p, q) = d.(p x q) + o.(d x (q-p)) is linear in o with the gradient d x (q-p), so that the first
//! component of the gradient that is not zero decides. All are zero only where d is parallel to the
//! edge, and then det = 0.

use glam::Vec3;
use num_bigint::{BigInt, Sign};

use super::{rational, scan};
use crate::hit::Hit;
use crate::mesh::TriMesh;
use crate::query::EdgeRule;
use crate::ray::Ray;

pub(super) type Vector = [BigInt; 3];

/// Where the line of a ray meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExactHit {
    /// The exact distance rounded to the nearest f32, ties to even; a zero is positive.
    pub t: f32,
    /// Barycentric coordinate of the second vertex, with a relative error below 2^-52.
    pub u: f64,
    /// Barycentric coordinate of the third vertex, with a relative error below 2^-52.
    pub v: f64,
}

/// Where the line of the ray meets the triangle, whatever the ray's interval.
///
/// `None` also where t rounds to an infinity, and for rays whose origin or direction is not finite.
///
/// # Panics
/// Where a corner is not finite.
pub fn intersect(ray: &Ray, corners: [Vec3; 3], rule: EdgeRule) -> Option<ExactHit> {
    if !(ray.origin.is_finite() && ray.dir.is_finite()) {
        return None;
    }
    let (points, scale) = integers([ray.origin, corners[0], corners[1], corners[2]]);
    let ([dir], dir_scale) = integers([ray.dir]);
    let [origin, v0, v1, v2] = &points;
    let normal = cross(&sub(v1, v0), &sub(v2, v0));
    let det = dot(&dir, &normal);
    if det.sign() == Sign::NoSign {
        return None;
    }
    let edges = [(v1, v2), (v2, v0), (v0, v1)];
    let w = edges.map(|(p, q)| dot(&dir, &cross(&sub(p, origin), &sub(q, origin))));
    debug_assert_eq!(w.iter().sum::<BigInt>(), det);
    let inside = (0..3).all(|i| match (w[i].sign(), rule) {
        (Sign::NoSign, EdgeRule::Closed) => true,
        (Sign::NoSign, EdgeRule::Crossing) => moved_sign(&dir, edges[i]) == det.sign(),
        (sign, _) => sign == det.sign(),
    });
    let t = rational::to_f32(&dot(&sub(v0, origin), &normal), &det, scale - dir_scale) + 0.0;
    let hit = ExactHit { t, u: rational::to_f64(&w[1], &det), v: rational::to_f64(&w[2], &det) };
    (inside && t.is_finite()).then_some(hit)
}

/// The closest hit, or [`Hit::MISS`].
pub fn closest(mesh: &TriMesh<'_>, ray: &Ray) -> Hit {
    scan::closest(mesh, ray, kernel)
}

/// Whether there is any hit.
pub fn any(mesh: &TriMesh<'_>, ray: &Ray) -> bool {
    scan::any(mesh, ray, kernel)
}

/// All hits, sorted by (t, triangle).
pub fn all(mesh: &TriMesh<'_>, ray: &Ray) -> Vec<Hit> {
    scan::all(mesh, ray, kernel)
}

/// The answers to all three queries in one scan.
pub fn answer(mesh: &TriMesh<'_>, ray: &Ray) -> scan::Answer {
    scan::answer(mesh, ray, kernel)
}

/// [`intersect`] as the library's kernel gives it.
pub(super) fn kernel(ray: &Ray, corners: [Vec3; 3], rule: EdgeRule) -> Option<(f32, f32, f32)> {
    intersect(ray, corners, rule).map(|hit| (hit.t, hit.u as f32, hit.v as f32))
}

/// The sign that side(p, q) = 0 takes when the origin moves by (e, e^2, e^3).
fn moved_sign(dir: &Vector, (p, q): (&Vector, &Vector)) -> Sign {
    let gradient = cross(dir, &sub(q, p));
    gradient.iter().map(BigInt::sign).find(|&sign| sign != Sign::NoSign).unwrap_or(Sign::NoSign)
}

/// The points times 2^-scale, for the largest scale that makes all coordinates integers.
fn integers<const N: usize>(points: [Vec3; N]) -> ([Vector; N], i64) {
    let parts = points.map(|p| p.as_dvec3().to_array().map(decompose));
    let scale = parts.iter().flatten().filter(|part| part.0 != 0).map(|part| part.1).min().unwrap_or(0);
    let integer = |(mantissa, exponent): (i64, i64)| match mantissa {
        0 => BigInt::ZERO,
        _ => BigInt::from(mantissa) << (exponent - scale),
    };
    (parts.map(|point| point.map(integer)), scale)
}

/// The odd (or zero) integer m and the exponent e with `x = m * 2^e`.
pub(super) fn decompose(x: f64) -> (i64, i64) {
    assert!(x.is_finite(), "{x} has no exact value");
    let (field, fraction) = (x.to_bits() >> 52 & 0x7ff, x.to_bits() & ((1 << 52) - 1));
    let magnitude = if field == 0 { fraction } else { fraction | 1 << 52 };
    let zeros = if magnitude == 0 { 0 } else { magnitude.trailing_zeros() };
    let odd = (magnitude >> zeros) as i64;
    (if x.is_sign_negative() { -odd } else { odd }, field.max(1) as i64 - 1075 + i64::from(zeros))
}

pub(super) fn sub(a: &Vector, b: &Vector) -> Vector {
    std::array::from_fn(|i| &a[i] - &b[i])
}

pub(super) fn dot(a: &Vector, b: &Vector) -> BigInt {
    (0..3).map(|i| &a[i] * &b[i]).sum()
}

pub(super) fn cross(a: &Vector, b: &Vector) -> Vector {
    std::array::from_fn(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        &a[j] * &b[k] - &a[k] * &b[j]
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use EdgeRule::{Closed, Crossing};

    const CORNERS: [Vec3; 3] = [Vec3::ZERO, Vec3::new(4.0, 0.0, 0.0), Vec3::new(0.0, 4.0, 0.0)];

    fn down(x: f32, y: f32) -> Ray {
        Ray::new([x, y, 3.0], [0.0, 0.0, -2.0])
    }

    #[test]
    fn decomposition_is_odd_and_exact() {
        assert_eq!(decompose(-6.0), (-3, 1));
        assert_eq!(decompose(f32::from_bits(6).into()), (3, -148));
        assert_eq!(decompose(f32::MAX.into()), ((1 << 24) - 1, 104));
        assert_eq!(decompose(-0.0).0, 0);
    }

    #[test]
    fn inside_of_either_face() {
        let expected = Some(ExactHit { t: 1.5, u: 0.25, v: 0.5 });
        let [a, b, c] = CORNERS;
        assert_eq!(intersect(&down(1.0, 2.0), CORNERS, Closed), expected);
        assert_eq!(intersect(&down(1.0, 2.0), CORNERS, Crossing), expected);
        let flipped = intersect(&down(1.0, 2.0), [a, c, b], Crossing);
        assert_eq!(flipped, Some(ExactHit { t: 1.5, u: 0.5, v: 0.25 }));
    }

    #[test]
    fn outside_edge_on_and_zero_area_miss() {
        for rule in [Closed, Crossing] {
            assert_eq!(intersect(&down(3.0, 2.0), CORNERS, rule), None);
            assert_eq!(intersect(&Ray::new([1.0, -1.0, 0.0], [0.0, 1.0, 0.0]), CORNERS, rule), None);
            assert_eq!(intersect(&down(0.0, 0.0), [CORNERS[0], CORNERS[1], CORNERS[1]], rule), None);
        }
    }

    /// The origin moves to +x first: of the edges of the triangle the left one (x = 0) gets crossing
    /// rays, the bottom one (y = 0) too, for it is moved to +y next, and the slanted one does not.
    #[test]
    fn crossing_follows_the_moved_origin() {
        for (x, y, crosses) in [(0.0, 1.0, true), (1.0, 0.0, true), (2.0, 2.0, false), (0.0, 0.0, true)] {
            assert!(intersect(&down(x, y), CORNERS, Closed).is_some(), "({x}, {y})");
            assert_eq!(intersect(&down(x, y), CORNERS, Crossing).is_some(), crosses, "({x}, {y})");
        }
        for (x, y) in [(4.0, 0.0), (0.0, 4.0)] {
            assert_eq!(intersect(&down(x, y), CORNERS, Crossing), None, "({x}, {y})");
        }
    }

    #[test]
    fn extremes_of_t() {
        let slow = |z, dir| Ray::new([1.0, 1.0, z], [0.0, 0.0, dir]);
        let t = |ray| intersect(&ray, CORNERS, Closed).map(|hit| hit.t);
        assert_eq!(t(slow(1.0, -f32::from_bits(1))), None);
        assert_eq!(t(slow(3.0, -f32::MIN_POSITIVE)), Some(3.0 * 2.0f32.powi(126)));
        assert_eq!(t(slow(f32::MAX, -1.0)), Some(f32::MAX));
        assert_eq!(t(slow(f32::from_bits(3), -2.0)), Some(f32::from_bits(2)));
        assert_eq!(t(slow(f32::from_bits(1), -2.0)), Some(0.0));
        assert_eq!(t(slow(0.0, 1.0)).map(f32::to_bits), Some(0));
    }
}
