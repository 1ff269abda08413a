//! One triangle, prepared for many packets of eight rays.
//!
//! The same tests as in [`crate::filter`], in another order: with s = o - v0, n = e1 x e2 and r = s x d
//!
//! ```text
//! det = d.n    w1 = -e2.r    w2 = e1.r    e2.q = -s.n
//! ```
//!
//! so that what depends on the triangle alone is computed once, and 18 multiplications a ray are left.
//!
//! # Errors
//! The triple products have as many roundings as those of [`candidates`](crate::filter::candidates): 42 u
//! for det, w1 and w2 and 48 u for e2.q, relative to the products of the largest components. So its bounds
//! hold here too.

use glam::{DVec3, Vec3};

use crate::filter::{Products, RayLanes, TINY, size};
use crate::lanes::{Doubles, Lanes, Once, Vec3Lanes, WIDTH, cross, dot, minus, splat};

/// A triangle in all lanes.
#[derive(Clone, Copy)]
pub(crate) struct Prepared<L: Lanes> {
    corner: Vec3Lanes<L>,
    e1: Vec3Lanes<L>,
    e2: Vec3Lanes<L>,
    normal: Vec3Lanes<L>,
    /// E with [`TINY`] added.
    size: L::F32,
}

impl<L: Lanes> Prepared<L> {
    #[inline(always)]
    pub(crate) fn new(lanes: L, [v0, v1, v2]: [Vec3; 3]) -> Self {
        let (e1, e2) = (v1 - v0, v2 - v0);
        let normal = e1.cross(e2);
        let size = e1.abs().max(e2.abs()).max_element() + TINY;
        Self {
            corner: splat(lanes, v0),
            e1: splat(lanes, e1),
            e2: splat(lanes, e2),
            normal: splat(lanes, normal),
            size: lanes.splat(size),
        }
    }

    /// The lanes in which the ray may meet the triangle within its interval, as bits.
    #[inline(always)]
    pub(crate) fn candidates(&self, lanes: L, ray: &RayLanes<L>) -> u32 {
        let s = minus::<L>(ray.origin, self.corner);
        let d = ray.dir;
        let r = cross::<Once, L>(lanes, s, d);
        let det = dot::<Once, L>(lanes, d, self.normal);
        let w = [-dot::<Once, L>(lanes, self.e2, r), dot::<Once, L>(lanes, self.e1, r)];
        let numerator = -dot::<Once, L>(lanes, s, self.normal);
        let products = Products { det, w, numerator, a: size(lanes, s), e: self.size };
        products.bounded(lanes, ray).possible(lanes, ray)
    }
}

/// Where eight rays meet a triangle, for the lanes in `clear`.
pub(crate) struct Hits {
    pub(crate) clear: u32,
    pub(crate) t: [f32; WIDTH],
    pub(crate) u: [f32; WIDTH],
    pub(crate) v: [f32; WIDTH],
}

/// What [`intersect`](crate::triangle::intersect) decides for eight rays, bit for bit, in the lanes in which
/// f64 leaves no doubt. Directions must not be scaled.
#[inline(always)]
pub(crate) fn intersect8<L: Doubles>(
    lanes: L,
    origin: &[[f32; WIDTH]; 3],
    dir: &[[f32; WIDTH]; 3],
    corners: [Vec3; 3],
) -> Hits {
    const UNIT: f64 = 64.0 / (1u64 << 53) as f64;
    const PRECISE: f64 = 1.0 / (1u64 << 26) as f64;
    let [v0, v1, v2] = corners.map(Vec3::as_dvec3);
    let (e1, e2) = (v1 - v0, v2 - v0);
    let (size1, size2) = (e1.abs().max_element(), e2.abs().max_element());
    let (o, d) = (widened(lanes, origin), widened(lanes, dir));
    let (corner, e1, e2) = (all8(lanes, v0), all8(lanes, e1), all8(lanes, e2));
    let s = [o[0] - corner[0], o[1] - corner[1], o[2] - corner[2]];
    let (p, q) = (cross8::<L>(&e2, &d), cross8::<L>(&e1, &s));
    let (det, w1, w2, numerator) =
        (dot8::<L>(&e1, &p), dot8::<L>(&s, &p), dot8::<L>(&d, &q), dot8::<L>(&e2, &q));
    let (size1, size2) = (lanes.splat8(size1), lanes.splat8(size2));
    let (a, d) = (lanes.splat8(UNIT) * size8(lanes, &s), size8(lanes, &d));
    let (b1, b2) = (a * d * size2, a * d * size1);
    let det_bound = lanes.splat8(UNIT) * d * size1 * size2;
    let sign = lanes.sign8(det);
    let (w1, w2, det, numerator) = (sign * w1, sign * w2, sign * det, sign * numerator);
    let w0 = det - w1 - w2;
    let bound = lanes.splat8(2.0) * (det_bound + b1 + b2);
    let numerator_bound = a * size1 * size2;

    let least = lanes.min8(lanes.min8(w0, w1), w2);
    let inside = lanes.less8(bound, least) & lanes.at_most8(bound, det * lanes.splat8(PRECISE));

    let inverse = lanes.splat8(1.0) / det;
    let t = numerator * inverse;
    let error =
        lanes.abs8(t) * (det_bound * inverse + lanes.splat8(4.0 * f64::EPSILON)) + numerator_bound * inverse;
    let (low, high) = (lanes.narrow(t - error), lanes.narrow(t + error));
    let same = lanes.bits(lanes.at_most(high, low) & lanes.less(lanes.abs(low), lanes.splat(f32::INFINITY)));
    Hits {
        clear: inside & same,
        t: lanes.store(low + lanes.splat(0.0)),
        u: lanes.store(lanes.narrow(w1 * inverse)),
        v: lanes.store(lanes.narrow(w2 * inverse)),
    }
}

#[inline(always)]
fn all8<L: Doubles>(lanes: L, v: DVec3) -> [L::F64x8; 3] {
    [lanes.splat8(v.x), lanes.splat8(v.y), lanes.splat8(v.z)]
}

#[inline(always)]
fn widened<L: Doubles>(lanes: L, v: &[[f32; WIDTH]; 3]) -> [L::F64x8; 3] {
    [lanes.widen(lanes.load(&v[0])), lanes.widen(lanes.load(&v[1])), lanes.widen(lanes.load(&v[2]))]
}

/// In the order of operations of `DVec3::cross`.
#[inline(always)]
fn cross8<L: Doubles>(a: &[L::F64x8; 3], b: &[L::F64x8; 3]) -> [L::F64x8; 3] {
    [a[1] * b[2] - b[1] * a[2], a[2] * b[0] - b[2] * a[0], a[0] * b[1] - b[0] * a[1]]
}

/// In the order of operations of `DVec3::dot`.
#[inline(always)]
fn dot8<L: Doubles>(a: &[L::F64x8; 3], b: &[L::F64x8; 3]) -> L::F64x8 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn size8<L: Doubles>(lanes: L, a: &[L::F64x8; 3]) -> L::F64x8 {
    lanes.max8(lanes.max8(lanes.abs8(a[0]), lanes.abs8(a[1])), lanes.abs8(a[2]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::{Isa, dispatch};
    use crate::query::EdgeRule;
    use crate::ray::{Ray, RayPacket};
    use crate::rng::Rng;
    use crate::triangle::intersect;

    /// A triangle and eight rays at points of it, of its border, and beside it.
    fn case(rng: &mut Rng) -> ([Vec3; 3], Vec<Ray>) {
        let size = 2f64.powi(rng.below(60) as i32 - 30);
        let flat = [1.0, 1e-3, 1e-7][rng.below(3)];
        let corners = [(); 3].map(|()| (size * rng.in_cube() * DVec3::new(1.0, 1.0, flat)).as_vec3());
        let [a, b, c] = corners.map(Vec3::as_dvec3);
        let ray = |_| {
            let [u, v] = [(); 2].map(|()| [0.0, 0.5, 1.0, 1.1 * rng.unit() - 0.05][rng.below(4)]);
            let origin = (size * 4.0 * rng.in_cube()).as_vec3();
            let target = a + u * (b - a) + v * (1.0 - u) * (c - a);
            let dir = (target - origin.as_dvec3()) * 2f64.powi(rng.below(20) as i32 - 10);
            Ray::new(origin, dir.as_vec3()).with_interval(0.0, [1.0, f32::INFINITY][rng.below(2)])
        };
        (corners, (0..WIDTH).map(ray).collect())
    }

    #[test]
    fn decisions_are_those_of_single_rays() {
        let rng = &mut Rng::new(1);
        let mut clear = 0;
        for _ in 0..20_000 {
            let (corners, rays) = case(rng);
            let component = |v: fn(&Ray) -> Vec3| -> [[f32; WIDTH]; 3] {
                std::array::from_fn(|axis| std::array::from_fn(|lane| v(&rays[lane])[axis]))
            };
            let (origin, dir) = (component(|ray| ray.origin), component(|ray| ray.dir));
            for isa in Isa::available() {
                let hits = dispatch!(isa, lanes => intersect8(lanes, &origin, &dir, corners));
                let candidates = dispatch!(isa, lanes => {
                    let rays = RayLanes::gather(lanes, &RayPacket::new(&rays));
                    Prepared::new(lanes, corners).candidates(lanes, &rays)
                });
                for (lane, ray) in rays.iter().enumerate() {
                    let found = intersect(ray, corners, EdgeRule::Closed);
                    if hits.clear >> lane & 1 != 0 {
                        let at = found.expect("a clear hit is one");
                        let bits = [at.t, at.u, at.v].map(f32::to_bits);
                        assert_eq!([hits.t, hits.u, hits.v].map(|x| x[lane].to_bits()), bits, "{ray:?}");
                        clear += 1;
                    }
                    let within = found.is_some_and(|at| at.t > ray.t_min && at.t <= ray.t_max);
                    assert!(!within || candidates >> lane & 1 != 0, "{ray:?} {corners:?}");
                }
            }
        }
        assert!(clear > 20_000, "{clear}");
    }
}
