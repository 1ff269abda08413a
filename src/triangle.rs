//! Does a ray meet a triangle, and where: the exact answer at the price of a rounded one.
//!
//! With s = o - v0, e1 = v1 - v0, e2 = v2 - v0, p = e2 x d and q = e1 x s (Moeller and Trumbore 1997)
//!
//! ```text
//! det = e1.p    w1 = s.p    w2 = d.q    w0 = det - w1 - w2    t = (e2.q) / det
//! ```
//!
//! and the line meets the triangle iff det is not zero and no w has the other sign. [`intersect`] decides in
//! f64, where the error bound leaves no doubt, and in exact arithmetic otherwise; [`crate::filter`] spares it
//! most triangles. Its answer depends on the ray and the triangle alone.
//!
//! So no answer depends on the width of the lanes or on the order of operations, neighbouring
//! triangles agree on the edge they share (both know on which side the ray passes), and t, being the
//! exact value rounded, orders hits along the ray as they are.

use glam::{DVec3, Vec3};

use crate::exact::{self, Cross, Difference, Expansion};
use crate::query::EdgeRule;
use crate::ray::Ray;

/// Where a line meets a triangle: as in [`crate::Hit`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Intersection {
    /// Distance in units of the length of the ray's direction: the exact value, rounded.
    pub t: f32,
    /// Barycentric coordinate of the second corner, good to 2^-24.
    pub u: f32,
    /// Barycentric coordinate of the third corner, good to 2^-24.
    pub v: f32,
}

/// Where the whole line of a valid ray, whatever its interval, meets a triangle; `None` also where t is
/// beyond the largest f32.
///
/// ```
/// use glam::Vec3;
/// use octogrid::{EdgeRule, Ray, intersect};
/// let corners = [Vec3::ZERO, Vec3::X, Vec3::Y];
/// let through_a_corner = Ray::new([0.0, 0.0, 3.0], [0.0, 0.0, -2.0]);
/// assert_eq!(intersect(&through_a_corner, corners, EdgeRule::Closed).unwrap().t, 1.5);
/// ```
#[inline(always)]
pub fn intersect(ray: &Ray, corners: [Vec3; 3], rule: EdgeRule) -> Option<Intersection> {
    // What is clearly inside is what nearly all calls are about.
    clear_hit(ray, corners).or_else(|| decide(ray, corners, rule))
}

/// The hit, where f64 shows that it is one and what its t is.
#[inline(always)]
pub(crate) fn clear_hit(ray: &Ray, corners: [Vec3; 3]) -> Option<Intersection> {
    let rounded = Rounded::new(ray, corners);
    if rounded.is_inside() { rounded.hit(Rounded::error) } else { None }
}

/// The same where [`Bounded::certain`](crate::filter::Bounded::certain) has shown that it is one, and `width` is
/// that of its bounds of t: those of det and e2.q are 2^29 times ours.
#[inline(always)]
pub(crate) fn known_hit(ray: &Ray, corners: [Vec3; 3], width: f32) -> Option<Intersection> {
    let error = f64::from(width) * SHARE;
    Rounded::new(ray, corners).hit(
        #[inline(always)]
        |_, _, _| error,
    )
}

/// What our bounds are of those of the filter.
pub(crate) const SHARE: f64 = 1.0 / (1u64 << 29) as f64;

/// Decides on what is not a clear hit.
#[cold]
#[inline(never)]
pub(crate) fn decide(ray: &Ray, corners: [Vec3; 3], rule: EdgeRule) -> Option<Intersection> {
    let rounded = Rounded::new(ray, corners);
    if rounded.is_outside() {
        return None;
    }
    let exact = decide_exact(ray, corners, rule).filter(|at| at.t.is_finite())?;
    // u and v do not depend on what was known about t.
    Some(if rounded.is_inside() { rounded.at(exact.t, 1.0 / rounded.det) } else { exact })
}

/// A triangle and a line in f64, with the bounds of the rounding errors.
///
/// The bounds: let A, E1, E2, D be the largest absolute components of s, e1, e2, d. Their rounding and
/// that of products and sums give det, w1, w2 and e2.q an error of less than 64 * 2^-53 times D E1 E2,
/// A D E2, A D E1 and A E1 E2.
struct Rounded {
    /// w0, w1, w2, det and t det, with the sign of det.
    w: [f64; 3],
    det: f64,
    numerator: f64,
    /// The bounds of their errors; that of w0 is the largest of the three.
    w_bounds: [f64; 3],
    det_bound: f64,
    numerator_bound: f64,
}

impl Rounded {
    #[inline(always)]
    fn new(ray: &Ray, corners: [Vec3; 3]) -> Self {
        const EPS: f64 = 64.0 / (1u64 << 53) as f64;
        let [v0, v1, v2] = corners.map(Vec3::as_dvec3);
        let (o, d) = (ray.origin.as_dvec3(), ray.dir.as_dvec3());
        let (s, e1, e2) = (o - v0, v1 - v0, v2 - v0);
        let (p, q) = (e2.cross(d), e1.cross(s));
        let (det, w1, w2, numerator) = (e1.dot(p), s.dot(p), d.dot(q), e2.dot(q));
        let size = |x: DVec3| x.abs().max_element();
        let (a, d, e1, e2) = (EPS * size(s), size(d), size(e1), size(e2));
        let (b1, b2, det_bound) = (a * d * e2, a * d * e1, EPS * d * e1 * e2);
        let sign = 1f64.copysign(det);
        let (w1, w2, det) = (sign * w1, sign * w2, sign * det);
        Self {
            w: [det - w1 - w2, w1, w2],
            det,
            numerator: sign * numerator,
            w_bounds: [2.0 * (det_bound + b1 + b2), b1, b2],
            det_bound,
            numerator_bound: a * e1 * e2,
        }
    }

    /// Certainly, and u and v are precise: they take the relative error of the bound of w0 to det.
    #[inline(always)]
    fn is_inside(&self) -> bool {
        const PRECISE: f64 = 1.0 / (1u64 << 26) as f64;
        let ([w0, w1, w2], bound) = (self.w, self.w_bounds[0]);
        // Without short cuts: one branch.
        (w0 > bound) & (w1 > bound) & (w2 > bound) & (bound <= self.det * PRECISE)
    }

    /// Certainly.
    fn is_outside(&self) -> bool {
        self.det > self.det_bound && (0..3).any(|i| self.w[i] < -self.w_bounds[i])
    }

    /// Where what is inside is met; `None` where the error of t, but for that of the division, leaves a doubt,
    /// or where it is no f32.
    #[inline(always)]
    fn hit(&self, error: impl Fn(&Self, f64, f64) -> f64) -> Option<Intersection> {
        let inverse = 1.0 / self.det;
        let t = self.numerator * inverse;
        let error = error(self, t, inverse) + t.abs() * (4.0 * f64::EPSILON);
        // Not one of the two that the error decides on: the walk need not wait for that.
        let at = self.at(t as f32, inverse);
        (((t - error) as f32 == (t + error) as f32) & (at.t.abs() <= f32::MAX)).then_some(at)
    }

    /// A bound of the error of t that stems from those of its terms.
    #[inline(always)]
    fn error(&self, t: f64, inverse: f64) -> f64 {
        t.abs() * (self.det_bound * inverse) + self.numerator_bound * inverse
    }

    #[inline(always)]
    fn at(&self, t: f32, inverse: f64) -> Intersection {
        let [_, w1, w2] = self.w;
        Intersection { t: t + 0.0, u: (w1 * inverse) as f32, v: (w2 * inverse) as f32 }
    }
}

/// Decides in exact arithmetic.
#[cold]
#[inline(never)]
fn decide_exact(ray: &Ray, [v0, v1, v2]: [Vec3; 3], rule: EdgeRule) -> Option<Intersection> {
    let minus = |a: Vec3, b: Vec3| -> [Difference; 3] {
        std::array::from_fn(|axis| Difference::new(f64::from(a[axis]), f64::from(b[axis])))
    };
    let d = minus(ray.dir, Vec3::ZERO);
    let (s, e1, e2) = (minus(ray.origin, v0), minus(v1, v0), minus(v2, v0));
    let p = exact::cross(&e2, &d);
    let det = exact::dot(&e1, &p);
    if det.sign() == 0.0 {
        return None;
    }
    let q = exact::cross(&e1, &s);
    let (w1, w2) = (exact::dot(&s, &p), exact::dot(&d, &q));
    let w0: Expansion<576> = det.minus::<192, 384>(&w1).minus(&w2);
    let edges = [(w0.sign(), v1, v2), (w1.sign(), v2, v0), (w2.sign(), v0, v1)];
    let inside = edges.into_iter().all(|(w, from, to)| {
        let side = match (w, rule) {
            (0.0, EdgeRule::Crossing) => perturbed_side(&d, &minus(to, from)),
            (side, _) => side,
        };
        side * det.sign() >= 0.0
    });
    inside.then(|| {
        let inverse = 1.0 / det.estimate();
        Intersection {
            t: exact::divide_to_f32(&exact::dot(&e2, &q), &det),
            u: (w1.estimate() * inverse) as f32 + 0.0,
            v: (w2.estimate() * inverse) as f32 + 0.0,
        }
    })
}

/// On which side of an edge that it meets a line passes, after its origin has moved by
/// (e, e^2, e^3) with e -> 0.
///
/// For the edge from p to q the side is d.((p - o) x (q - o)) = d.(p x q) + o.(d x (q - p)), so the
/// first component of d x (q - p) that is not zero decides. Source: H. Edelsbrunner and E. P. Muecke,
/// "Simulation of Simplicity", 1990.
fn perturbed_side(d: &[Difference; 3], edge: &[Difference; 3]) -> f64 {
    exact::cross(d, edge).iter().map(Cross::sign).find(|&sign| sign != 0.0).unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corners(v: [[f32; 3]; 3]) -> [Vec3; 3] {
        v.map(Vec3::from_array)
    }

    const UNIT: [[f32; 3]; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

    fn down(x: f32, y: f32) -> Ray {
        Ray::new([x, y, 3.0], [0.0, 0.0, -2.0])
    }

    #[test]
    fn inside_outside_and_both_sides() {
        let at = intersect(&down(0.25, 0.5), corners(UNIT), EdgeRule::Closed);
        assert_eq!(at, Some(Intersection { t: 1.5, u: 0.25, v: 0.5 }));
        let [a, b, c] = corners(UNIT);
        let back = intersect(&down(0.25, 0.5), [a, c, b], EdgeRule::Closed);
        assert_eq!(back, Some(Intersection { t: 1.5, u: 0.5, v: 0.25 }));
        assert_eq!(intersect(&down(0.6, 0.5), [a, b, c], EdgeRule::Closed), None);
    }

    #[test]
    fn edges_belong_to_closed_triangles() {
        for (x, y) in [(0.0, 0.0), (1.0, 0.0), (0.5, 0.5), (0.0, 0.25)] {
            assert!(intersect(&down(x, y), corners(UNIT), EdgeRule::Closed).is_some());
        }
        let just_outside = intersect(&down(0.5, 0.5f32.next_up()), corners(UNIT), EdgeRule::Closed);
        assert_eq!(just_outside, None);
    }

    #[test]
    fn a_fan_around_a_vertex_is_crossed_once() {
        let rim = [[1.0f32, 0.0], [1.0, 1.0], [-1.0, 2.0], [-1.0, 0.0], [-1.0, -1.0], [0.0, -1.0]];
        let at = |i: usize| [rim[i % 6][0], rim[i % 6][1], 0.0];
        for turn in [false, true] {
            let count = (0..6).filter(|&i| {
                let (a, b) = if turn && i % 2 == 0 { (at(i + 1), at(i)) } else { (at(i), at(i + 1)) };
                intersect(&down(0.0, 0.0), corners([[0.0; 3], a, b]), EdgeRule::Crossing).is_some()
            });
            assert_eq!(count.count(), 1);
        }
    }

    #[test]
    fn degenerate_and_edge_on_triangles_are_never_hit() {
        let line = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 0.0, 0.0]];
        assert_eq!(intersect(&down(0.5, 0.0), corners(line), EdgeRule::Closed), None);
        let along = Ray::new([-1.0, 0.2, 0.0], [1.0, 0.0, 0.0]);
        assert_eq!(intersect(&along, corners(UNIT), EdgeRule::Closed), None);
    }
}
