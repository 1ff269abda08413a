//! Does a ray meet a triangle, and where: the exact answer at the price of a rounded one.
//!
//! With s = o - v0, e1 = v1 - v0, e2 = v2 - v0, p = e2 x d and q = e1 x s (Moeller and Trumbore 1997)
//!
//! ```text
//! det = e1.p    w1 = s.p    w2 = d.q    w0 = det - w1 - w2    t = (e2.q) / det
//! ```
//!
//! and the line meets the triangle iff det is not zero and no w has the other sign. Two functions:
//!
//! - [`candidates`] evaluates this in f32 on eight lanes, triangles or rays, and drops those that are
//!   certainly not hit within the interval: each comparison is widened by the bound of its rounding
//!   error. It decides nothing else.
//! - [`intersect`] decides on one triangle: in f64, where the error bound leaves no doubt, and in exact
//!   arithmetic otherwise. Its answer depends on the ray and the triangle alone.
//!
//! So no answer depends on the width of the lanes or on the order of operations, neighbouring
//! triangles agree on the edge they share (both know on which side the ray passes), and t, being the
//! exact value rounded, orders hits along the ray as they are.

use glam::{DVec3, Vec3};

use crate::exact::{self, Cross, Difference, Expansion};
use crate::lanes::{Isa, Lanes, WIDTH, dispatch};
use crate::query::EdgeRule;
use crate::ray::{Ray, RayPacket};

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
    if rounded.is_inside() { rounded.intersection() } else { None }
}

/// Decides on what is not a clear hit.
#[cold]
#[inline(never)]
pub(crate) fn decide(ray: &Ray, corners: [Vec3; 3], rule: EdgeRule) -> Option<Intersection> {
    let outside = Rounded::new(ray, corners).is_outside();
    if outside { None } else { decide_exact(ray, corners, rule).filter(|at| at.t.is_finite()) }
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

    /// Where what is inside is met; `None` where the error of t leaves a doubt, or where it is no f32.
    #[inline(always)]
    fn intersection(&self) -> Option<Intersection> {
        let inverse = 1.0 / self.det;
        let t = self.numerator * inverse;
        let error =
            t.abs() * (self.det_bound * inverse + 4.0 * f64::EPSILON) + self.numerator_bound * inverse;
        let rounded = (t - error) as f32;
        let [_, w1, w2] = self.w;
        let at = Intersection { t: rounded + 0.0, u: (w1 * inverse) as f32, v: (w2 * inverse) as f32 };
        ((rounded == (t + error) as f32) & (rounded.abs() <= f32::MAX)).then_some(at)
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

/// Lanes of three-component vectors.
pub(crate) type Vec3Lanes<L> = [<L as Lanes>::F32; 3];

/// A ray, or eight of them, as [`candidates`] takes it: scaled by [`Scale`].
#[derive(Clone, Copy)]
pub(crate) struct RayLanes<L: Lanes> {
    pub(crate) origin: Vec3Lanes<L>,
    pub(crate) dir: Vec3Lanes<L>,
    /// 16 times the largest absolute component of the direction, or more.
    pub(crate) bound: L::F32,
    pub(crate) t_min: L::F32,
    pub(crate) t_max: L::F32,
}

impl<L: Lanes> RayLanes<L> {
    /// One ray in all lanes.
    #[inline(always)]
    pub(crate) fn splat(lanes: L, ray: &Ray, scale: Scale) -> Self {
        let scaled;
        let ray = if scale.factor == 1.0 {
            ray
        } else {
            scaled = scale.scaled(ray);
            &scaled
        };
        Self {
            origin: splat(lanes, ray.origin),
            dir: splat(lanes, ray.dir),
            bound: lanes.splat(16.0 * steepest(ray.dir)),
            t_min: lanes.splat(ray.t_min),
            t_max: lanes.splat(ray.t_max),
        }
    }
}

impl<L: Lanes> RayLanes<L> {
    /// A ray a lane.
    #[inline(always)]
    pub(crate) fn gather(lanes: L, packet: &RayPacket) -> Self {
        let rays = Self::load(lanes, packet);
        let short = lanes.less(rays.bound, lanes.splat(16.0 * Scale::LEAST));
        let long = lanes.less(lanes.splat(16.0 * Scale::MOST), rays.bound);
        if lanes.bits(short | long) & 0xff == 0 { rays } else { Self::load(lanes, &scaled(packet)) }
    }

    #[inline(always)]
    fn load(lanes: L, packet: &RayPacket) -> Self {
        let load = |values: &wide::f32x8| lanes.load(values.as_array());
        let three = |values: &[wide::f32x8; 3]| [load(&values[0]), load(&values[1]), load(&values[2])];
        let dir = three(&packet.dir);
        let [x, y, z] = dir;
        let steepest = lanes.max(lanes.max(lanes.abs(x), lanes.abs(y)), lanes.abs(z));
        Self {
            origin: three(&packet.origin),
            dir,
            bound: lanes.splat(16.0) * steepest,
            t_min: load(&packet.t_min),
            t_max: load(&packet.t_max),
        }
    }
}

/// The packet with each of its rays scaled.
#[cold]
#[inline(never)]
fn scaled(packet: &RayPacket) -> RayPacket {
    let rays: [Ray; WIDTH] = std::array::from_fn(|lane| packet.get(lane));
    RayPacket::new(&rays.map(|ray| Scale::of(ray.dir).scaled(&ray)))
}

/// The largest absolute component of a direction.
#[inline(always)]
fn steepest(dir: Vec3) -> f32 {
    dir.abs().max_element()
}

impl RayPacket {
    /// The lanes whose valid ray may meet a triangle within its interval, as bits.
    ///
    /// Never misses one for which [`intersect`] finds a hit, and seldom names another. Lanes whose ray is
    /// not valid are unspecified.
    ///
    /// ```
    /// use glam::Vec3;
    /// use octogrid::{Isa, Ray, RayPacket};
    /// let rays = [0.2, 5.0].map(|x| Ray::new([x, 0.2, 1.0], [0.0, 0.0, -1.0]));
    /// let packet = RayPacket::new(&rays);
    /// assert_eq!(packet.candidates(Isa::detect(), [Vec3::ZERO, Vec3::X, Vec3::Y]) & 0b11, 0b01);
    /// ```
    pub fn candidates(&self, isa: Isa, corners: [Vec3; 3]) -> u8 {
        dispatch!(isa, lanes => {
            let corners = [splat(lanes, corners[0]), splat(lanes, corners[1]), splat(lanes, corners[2])];
            candidates(lanes, &RayLanes::gather(lanes, self), corners) as u8
        })
    }
}

/// The power of two by which [`RayLanes`] scales a direction: 1 where its largest component lies in
/// [0.5, 2^32], else so that it comes to lie in [0.5, 1). The interval is scaled with it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scale {
    factor: f64,
    /// Its inverse.
    inverse: f64,
}

impl Scale {
    /// The least and the largest component that need no scale.
    const LEAST: f32 = 0.5;
    const MOST: f32 = (1u64 << 32) as f32;

    /// The scale for a direction that is finite and not zero.
    #[inline(always)]
    pub(crate) fn of(dir: Vec3) -> Self {
        let steepest = steepest(dir);
        if (Self::LEAST..=Self::MOST).contains(&steepest) {
            Self { factor: 1.0, inverse: 1.0 }
        } else {
            Self::to_one(steepest)
        }
    }

    #[cold]
    #[inline(never)]
    fn to_one(steepest: f32) -> Self {
        let exponent = (f64::from(steepest).to_bits() >> 52) as i64 - 1022;
        let power = |exponent: i64| f64::from_bits(((1023 + exponent) as u64) << 52);
        Self { factor: power(-exponent), inverse: power(exponent) }
    }

    /// The scaled ray. The interval grows by an ulp or two; what is finite stays so.
    #[inline(always)]
    fn scaled(self, ray: &Ray) -> Ray {
        let dir = (ray.dir.as_dvec3() * self.factor).as_vec3();
        Ray { dir, t_min: -self.time(-ray.t_min), t_max: self.time(ray.t_max), ..*ray }
    }

    /// t in units of the scaled direction, or an ulp or two more; what is finite stays so.
    #[inline(always)]
    pub(crate) fn time(self, t: f32) -> f32 {
        if self.factor == 1.0 { t } else { self.scaled_time(t) }
    }

    #[cold]
    #[inline(never)]
    fn scaled_time(self, t: f32) -> f32 {
        let above = above(f64::from(t) * self.inverse);
        if t.is_finite() { above.clamp(f32::MIN, f32::MAX) } else { t }
    }

    /// The inverse of [`Scale::time`].
    #[inline(always)]
    pub(crate) fn unscaled(self, t: f32) -> f32 {
        (f64::from(t) * self.factor) as f32
    }
}

/// No less than `x`, and an ulp or two more at most.
#[inline(always)]
pub(crate) fn above(x: f64) -> f32 {
    const ULP: f64 = f32::EPSILON as f64;
    const LEAST: f64 = f32::from_bits(1) as f64;
    (x + (x.abs() * ULP + LEAST)) as f32
}

/// The lanes in which the ray may meet the triangle within its interval, as bits.
///
/// Never misses one that [`intersect`] finds there. The bounds: with A, E, D as in
/// [`Rounded`] and 2^-24 for 2^-53, the errors of det and w are at most 48 * 2^-24 times
/// D E E and D A E, so that 2^-17 D E (A + E) covers the w and twice det (whose sign may be the wrong one
/// within its error); t is compared as t * det, where D >= 0.5 makes up for e2.q having no D. Adding 2^-40
/// to E covers what underflows; where something overflows, so does its bound, and infinite and NaN bounds
/// exclude nothing.
#[inline(always)]
pub(crate) fn candidates<L: Lanes>(lanes: L, ray: &RayLanes<L>, [v0, v1, v2]: [Vec3Lanes<L>; 3]) -> u32 {
    let size = |[x, y, z]: Vec3Lanes<L>| lanes.max(lanes.max(lanes.abs(x), lanes.abs(y)), lanes.abs(z));
    let (s, e1, e2) = (minus::<L>(ray.origin, v0), minus::<L>(v1, v0), minus::<L>(v2, v0));
    let (p, q) = (cross::<Once, L>(lanes, e2, ray.dir), cross::<Once, L>(lanes, e1, s));
    let (det, w1, w2) =
        (dot::<Once, L>(lanes, e1, p), dot::<Once, L>(lanes, s, p), dot::<Once, L>(lanes, ray.dir, q));
    let abs = lanes.abs(det);
    let sign = lanes.sign(det);
    let (w1, w2, numerator) = (sign * w1, sign * w2, sign * dot::<Once, L>(lanes, e2, q));
    let a = size(s);
    let e = lanes.max(size(e1), size(e2)) + lanes.splat(2f32.powi(-40));
    // 16 D E (A + E) and 16 D E E (A + |t|) are above every intermediate value, so that they overflow first.
    let eps = lanes.splat(2f32.powi(-21));
    let de = ray.bound * e;
    let ee = de * e;
    let det_slack = eps * ee;
    let slack = lanes.mul_add(eps, de * a, det_slack);
    let least = lanes.min(lanes.min(w1, w2), abs - (w1 + w2));
    let outside = lanes.less(least + slack, lanes.splat(0.0));
    let (eea, tiny) = (ee * a, lanes.splat(2f32.powi(-97)) * e);
    let late = lanes.mul_add(eps, lanes.mul_add(ee, lanes.abs(ray.t_max), eea), tiny);
    let early = lanes.mul_add(eps, lanes.mul_add(ee, lanes.abs(ray.t_min), eea), tiny);
    let beyond = lanes.less(lanes.mul_add(ray.t_max, abs, late), numerator)
        | lanes.less(numerator + early, ray.t_min * abs);
    let certain = lanes.less(det_slack, abs);
    !lanes.bits(outside | (beyond & certain)) & 0xff
}

/// A vector in all lanes.
#[inline(always)]
pub(crate) fn splat<L: Lanes>(lanes: L, v: Vec3) -> Vec3Lanes<L> {
    [lanes.splat(v.x), lanes.splat(v.y), lanes.splat(v.z)]
}

#[inline(always)]
pub(crate) fn minus<L: Lanes>(a: Vec3Lanes<L>, b: Vec3Lanes<L>) -> Vec3Lanes<L> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// How often a * b + c is rounded.
pub(crate) trait Rounding {
    fn mul_add<L: Lanes>(lanes: L, a: L::F32, b: L::F32, c: L::F32) -> L::F32;
}

/// Once, where the instruction set can do it.
pub(crate) struct Once;
/// Twice, on every processor.
pub(crate) struct Twice;

impl Rounding for Once {
    #[inline(always)]
    fn mul_add<L: Lanes>(lanes: L, a: L::F32, b: L::F32, c: L::F32) -> L::F32 {
        lanes.mul_add(a, b, c)
    }
}

impl Rounding for Twice {
    #[inline(always)]
    fn mul_add<L: Lanes>(_: L, a: L::F32, b: L::F32, c: L::F32) -> L::F32 {
        a * b + c
    }
}

#[inline(always)]
pub(crate) fn cross<R: Rounding, L: Lanes>(lanes: L, a: Vec3Lanes<L>, b: Vec3Lanes<L>) -> Vec3Lanes<L> {
    [
        R::mul_add(lanes, a[1], b[2], -(a[2] * b[1])),
        R::mul_add(lanes, a[2], b[0], -(a[0] * b[2])),
        R::mul_add(lanes, a[0], b[1], -(a[1] * b[0])),
    ]
}

#[inline(always)]
pub(crate) fn dot<R: Rounding, L: Lanes>(lanes: L, a: Vec3Lanes<L>, b: Vec3Lanes<L>) -> L::F32 {
    R::mul_add(lanes, a[2], b[2], R::mul_add(lanes, a[1], b[1], a[0] * b[0]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::Portable;

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

    #[test]
    fn scale_keeps_what_it_can() {
        for x in [1e-45f32, 1e-30, 0.3, 1.0, 7.0, 3e38] {
            let dir = Vec3::new(0.0, -x, x * 0.1);
            let scaled = Scale::of(dir).scaled(&Ray::new([0.0; 3], dir)).dir;
            assert!((0.5..8.0).contains(&-scaled.y), "{x}: {scaled}");
        }
        let scale = Scale::of(Vec3::new(1e-30, 0.0, 0.0));
        assert_eq!(scale.time(f32::INFINITY), f32::INFINITY);
        assert!(scale.time(1e38) <= 1e9);
        assert_eq!(Scale::of(Vec3::new(1e30, 0.0, 0.0)).time(1e38), f32::MAX);
    }

    /// Deterministic values of very different size, with many repeats and zeros.
    fn coordinates(seed: u64) -> impl Iterator<Item = f32> {
        let mut state = seed;
        std::iter::from_fn(move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let bits = (state >> 33) as u32;
            let small = ((bits >> 8) % 9) as f32 - 4.0;
            Some(match bits % 4 {
                0 | 1 => small,
                2 => small * 2f32.powi((bits >> 16) as i32 % 120 - 60),
                _ => f32::from_bits(bits.wrapping_mul(2_654_435_761)),
            })
        })
        .filter(|x| x.is_finite())
    }

    fn misses_nothing<L: Lanes>(lanes: L, seed: u64) -> usize {
        let mut next = coordinates(seed);
        let mut vec3 = || Vec3::from_array(std::array::from_fn(|_| next.next().unwrap()));
        let mut hits = 0;
        for _ in 0..4000 {
            let (v0, v1, v2) = (vec3(), vec3(), vec3());
            // Half of the rays are aimed at an edge, where rounding matters.
            let aim = if vec3().x > 0.0 { v0.midpoint(v1) } else { v0 * 0.25 + v1 * 0.5 + v2 * 0.25 };
            let origin = vec3();
            let ray = Ray::new(origin, aim - origin).with_interval(-1.0, 1.0);
            if !ray.is_valid() {
                continue;
            }
            let scale = Scale::of(ray.dir);
            let splat = [v0, v1, v2].map(|v| v.to_array().map(|x| lanes.splat(x)));
            let bits = candidates(lanes, &RayLanes::splat(lanes, &ray, scale), splat);
            if let Some(at) = intersect(&ray, [v0, v1, v2], EdgeRule::Closed)
                && at.t > ray.t_min
                && at.t <= ray.t_max
            {
                hits += 1;
                assert_eq!(bits, 0xff, "{ray:?} {v0} {v1} {v2} {at:?}");
            }
        }
        hits
    }

    #[test]
    fn candidates_hold_every_hit() {
        assert!(misses_nothing(Portable, 1) > 500);
        for (isa, seed) in Isa::available().into_iter().zip(2..) {
            dispatch!(isa, lanes => misses_nothing(lanes, seed));
        }
    }
    /// At a distance of one unit of the least f32 from a corner of a large triangle, with the end of the
    /// interval at the hit: scaled like the direction, it falls between two f32.
    #[test]
    fn candidates_hold_hits_at_the_least_distances() {
        let [a, b, c] = corners(UNIT).map(|v| v * 2f32.powi(60));
        for (numerator, back) in (1..400).flat_map(|i| [(i as f32, 0.0), (i as f32, 1.0)]) {
            let dir = Vec3::new(0.0, 0.0, -numerator * 2f32.powi(-40));
            let ray = Ray::new([0.0, 0.0, f32::from_bits(1) * (1.0 - 2.0 * back)], dir);
            let at = intersect(&ray, [a, b, c], EdgeRule::Closed).unwrap();
            let ray = if at.t > 0.0 {
                ray.with_interval(0.0, at.t)
            } else {
                ray.with_interval(at.t.next_down(), 0.0)
            };
            let splat = [a, b, c].map(|v| v.to_array().map(|x| Portable.splat(x)));
            let lanes = RayLanes::splat(Portable, &ray, Scale::of(ray.dir));
            assert_eq!(candidates(Portable, &lanes, splat), 0xff, "{ray:?}");
        }
    }
}
