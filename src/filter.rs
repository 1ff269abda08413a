//! Which of eight triangles a ray may meet, or which of eight rays a triangle: in f32.
//!
//! The products of [`crate::triangle`] are evaluated in f32 on eight lanes, and those that are certainly not hit
//! within the interval are dropped: each comparison is widened by the bound of its rounding error. Nothing
//! else is decided.

use glam::Vec3;

use crate::lanes::{Isa, Lanes, Once, Vec3Lanes, WIDTH, cross, dispatch, dot, minus, splat};
use crate::ray::{Ray, RayPacket};

/// A ray, or eight of them, as [`candidates`] takes it: scaled by [`Scale`].
#[derive(Clone, Copy)]
pub(crate) struct RayLanes<L: Lanes> {
    pub(crate) origin: Vec3Lanes<L>,
    pub(crate) dir: Vec3Lanes<L>,
    /// 16 times the largest absolute component of the direction, or more.
    pub(crate) bound: L::F32,
    pub(crate) t_min: L::F32,
    /// No less than what rounds to the end of the interval, but for a part of 2^-24.
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
            t_max: lanes.splat(rounds_to(ray.t_max)),
        }
    }

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
        Self {
            origin: three(&packet.origin),
            dir,
            bound: lanes.splat(16.0) * size(lanes, dir),
            t_min: load(&packet.t_min),
            t_max: load(&packet.t_max) + lanes.splat(f32::MIN_POSITIVE),
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
    /// Never misses one for which [`intersect`](crate::intersect) finds a hit, and seldom names another. Lanes
    /// whose ray is not valid are unspecified.
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

    /// The scaled ray. The interval grows by an ulp or two, and has no end beyond the largest f32.
    #[inline(always)]
    fn scaled(self, ray: &Ray) -> Ray {
        let dir = (ray.dir.as_dvec3() * self.factor).as_vec3();
        // Zero is exact, and the least number that is not is slow to multiply by.
        let t_min = if ray.t_min == 0.0 { 0.0 } else { -self.time(-ray.t_min) };
        Ray { dir, t_min, t_max: self.time(ray.t_max), ..*ray }
    }

    /// [`RayLanes::t_max`] for t: in units of the scaled direction, or an ulp or two more, and so infinity beyond
    /// the largest f32.
    #[inline(always)]
    pub(crate) fn time(self, t: f32) -> f32 {
        if self.factor == 1.0 { rounds_to(t) } else { self.scaled_time(t) }
    }

    #[cold]
    #[inline(never)]
    fn scaled_time(self, t: f32) -> f32 {
        let above = above((f64::from(t) + HALF_LEAST) * self.inverse);
        if t.is_finite() { above.max(f32::MIN) } else { t }
    }

    /// Whether nothing is scaled.
    #[inline(always)]
    pub(crate) fn is_one(self) -> bool {
        self.factor == 1.0
    }

    /// The inverse of [`Scale::time`].
    #[inline(always)]
    pub(crate) fn unscaled(self, t: f32) -> f32 {
        (f64::from(t) * self.factor) as f32
    }
}

/// No less than what rounds to t, but for a part of 2^-24, which [`candidates`]' bounds cover; never subnormal, which
/// is slow to multiply by.
#[inline(always)]
fn rounds_to(t: f32) -> f32 {
    t + f32::MIN_POSITIVE
}

/// By how much what rounds to a subnormal t may be more.
const HALF_LEAST: f64 = 0.5 * f32::from_bits(1) as f64;

/// No less than `x`, and an ulp or two more at most.
#[inline(always)]
pub(crate) fn above(x: f64) -> f32 {
    const ULP: f64 = f32::EPSILON as f64;
    const LEAST: f64 = f32::from_bits(1) as f64;
    (x + (x.abs() * ULP + LEAST)) as f32
}

/// The lanes in which the ray may meet the triangle within its interval, as bits.
///
/// Never misses one that [`intersect`](crate::triangle::intersect) finds there. The bounds: with A, E, D as in
/// `triangle::Rounded` and 2^-24 for 2^-53, the errors of det and w are at most 48 * 2^-24 times
/// D E E and D A E, so that 2^-17 D E (A + E) covers the w and twice det (whose sign may be the wrong one
/// within its error); t is compared as t * det, where D >= 0.5 makes up for e2.q having no D. Adding 2^-40
/// to E covers what underflows; where something overflows, so does its bound, and infinite and NaN bounds
/// exclude nothing.
#[inline(always)]
pub(crate) fn candidates<L: Lanes>(lanes: L, ray: &RayLanes<L>, corners: [Vec3Lanes<L>; 3]) -> u32 {
    products(lanes, ray, corners).bounded(lanes, ray).possible(lanes, ray)
}

/// What a ray and triangles are judged by.
#[inline(always)]
pub(crate) fn products<L: Lanes>(
    lanes: L,
    ray: &RayLanes<L>,
    [v0, v1, v2]: [Vec3Lanes<L>; 3],
) -> Products<L> {
    let (s, e1, e2) = (minus::<L>(ray.origin, v0), minus::<L>(v1, v0), minus::<L>(v2, v0));
    let (p, q) = (cross::<Once, L>(lanes, e2, ray.dir), cross::<Once, L>(lanes, e1, s));
    let (det, w1, w2) =
        (dot::<Once, L>(lanes, e1, p), dot::<Once, L>(lanes, s, p), dot::<Once, L>(lanes, ray.dir, q));
    let numerator = dot::<Once, L>(lanes, e2, q);
    let e = lanes.max(size(lanes, e1), size(lanes, e2)) + lanes.splat(TINY);
    Products { det, w: [w1, w2], numerator, a: size(lanes, s), e }
}

/// What a ray and a triangle are judged by, with rounding errors below [`candidates`]' bounds.
pub(crate) struct Products<L: Lanes> {
    pub(crate) det: L::F32,
    /// w1 and w2.
    pub(crate) w: [L::F32; 2],
    /// e2.q.
    pub(crate) numerator: L::F32,
    /// A, and E with [`TINY`] added.
    pub(crate) a: L::F32,
    pub(crate) e: L::F32,
}

/// What is added to E to cover what underflows.
pub(crate) const TINY: f32 = 1.0 / (1u64 << 40) as f32;

impl<L: Lanes> Products<L> {
    /// With the bounds of their errors.
    #[inline(always)]
    pub(crate) fn bounded(&self, lanes: L, ray: &RayLanes<L>) -> Bounded<L> {
        let &Self { det, w: [w1, w2], numerator, a, e } = self;
        let (abs, sign) = (lanes.abs(det), lanes.sign(det));
        let (w1, w2, numerator) = (sign * w1, sign * w2, sign * numerator);
        // 16 D E (A + E) and 16 D E E (A + |t|) are above every intermediate value, so that they overflow first.
        let eps = lanes.splat(EPS);
        let de = ray.bound * e;
        let ee = de * e;
        let det_slack = eps * ee;
        let slack = lanes.mul_add(eps, de * a, det_slack);
        let least = lanes.min(lanes.min(w1, w2), abs - (w1 + w2));
        let (eea, tiny) = (ee * a, lanes.splat(2f32.powi(-97)) * e);
        Bounded { det: abs, numerator, least, slack, det_slack, ee, eea, tiny }
    }
}

/// The least of w0, w1 and w2, det and e2.q, with the sign of det, and the bounds of their errors.
pub(crate) struct Bounded<L: Lanes> {
    det: L::F32,
    numerator: L::F32,
    least: L::F32,
    /// Bounds the errors of every w, and of det.
    slack: L::F32,
    det_slack: L::F32,
    /// [`EPS`] (EE (A + |t|)) + tiny bounds the error of e2.q - t det.
    ee: L::F32,
    eea: L::F32,
    tiny: L::F32,
}

/// 128 * 2^-24, over the 16 of [`RayLanes::bound`].
const EPS: f32 = 1.0 / (1u64 << 21) as f32;

impl<L: Lanes> Bounded<L> {
    /// The lanes that are not excluded, as bits.
    #[inline(always)]
    pub(crate) fn possible(&self, lanes: L, ray: &RayLanes<L>) -> u32 {
        let &Self { det, numerator, least, slack, det_slack, ee, eea, tiny } = self;
        let eps = lanes.splat(EPS);
        let outside = lanes.less(least + slack, lanes.splat(0.0));
        let late = lanes.mul_add(eps, lanes.mul_add(ee, lanes.abs(ray.t_max), eea), tiny);
        let early = lanes.mul_add(eps, lanes.mul_add(ee, lanes.abs(ray.t_min), eea), tiny);
        let beyond = lanes.less(lanes.mul_add(ray.t_max, det, late), numerator)
            | lanes.less(numerator + early, ray.t_min * det);
        let certain = lanes.less(det_slack, det);
        !lanes.bits(outside | (beyond & certain)) & 0xff
    }

    /// The lanes for which the bounds leave no doubt: the triangle is hit, and within the interval. Where directions
    /// are scaled, that is wider than the ray's own.
    ///
    /// The error of t is that of e2.q and |t| times that of det, over det: at most 3/4 of what is taken here,
    /// which leaves room for the error of det in the divisor, below 2^-6 of it, and for the roundings of t. What
    /// is inside by the slack is so by far for `triangle::Rounded`, whose bounds are smaller by 2^29.
    #[inline(always)]
    pub(crate) fn certain(&self, lanes: L, ray: &RayLanes<L>) -> Certain<L> {
        let &Self { det, numerator, least, slack, det_slack, eea, tiny, .. } = self;
        let inverse = lanes.splat(1.0) / det;
        let t = numerator * inverse;
        let late = lanes.mul_add(lanes.splat(EPS), eea, tiny);
        let error = lanes.mul_add(lanes.abs(t), det_slack * inverse, late * inverse);
        let (low, high) = (t - error, t + error);
        // Where nothing overflows or underflows.
        let (least_t, most) = (lanes.splat(2f32.powi(-80)), lanes.splat(2f32.powi(100)));
        let inside =
            lanes.less(slack, least) & lanes.less(lanes.splat(64.0) * det_slack, det) & lanes.less(det, most);
        let within =
            lanes.less(lanes.max(ray.t_min, least_t), low) & lanes.less(high, lanes.min(ray.t_max, most));
        Certain { lanes: lanes.bits(inside & within) & 0xff, low, high }
    }
}

/// Lanes that are certainly hit within the interval, as bits, and t between two bounds.
pub(crate) struct Certain<L: Lanes> {
    pub(crate) lanes: u32,
    /// Both ends open; unspecified in other lanes.
    pub(crate) low: L::F32,
    pub(crate) high: L::F32,
}

/// The largest absolute components.
#[inline(always)]
pub(crate) fn size<L: Lanes>(lanes: L, [x, y, z]: Vec3Lanes<L>) -> L::F32 {
    lanes.max(lanes.max(lanes.abs(x), lanes.abs(y)), lanes.abs(z))
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::lanes::Portable;
    use crate::query::EdgeRule;
    use crate::rng::Rng;
    use crate::triangle::{intersect, known_hit};

    #[test]
    fn scale_keeps_what_it_can() {
        for x in [1e-45f32, 1e-30, 0.3, 1.0, 7.0, 3e38] {
            let dir = Vec3::new(0.0, -x, x * 0.1);
            let scaled = Scale::of(dir).scaled(&Ray::new([0.0; 3], dir)).dir;
            let kept = (Scale::LEAST..=Scale::MOST).contains(&x);
            assert!(if kept { scaled == dir } else { (0.5..1.0).contains(&-scaled.y) }, "{x}: {scaled}");
            assert_eq!(Scale::of(dir).scaled(&Ray::new([0.0; 3], dir)).t_min, 0.0);
        }
        let scale = Scale::of(Vec3::new(1e-30, 0.0, 0.0));
        assert_eq!(scale.time(f32::INFINITY), f32::INFINITY);
        assert!(scale.time(1e38) <= 1e9);
        assert_eq!(Scale::of(Vec3::new(1e30, 0.0, 0.0)).time(1e38), f32::INFINITY);
        assert_eq!(Scale::of(Vec3::new(1e30, 0.0, 0.0)).time(-1e38), f32::MIN);
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

    fn certain_is_so<L: Lanes>(lanes: L, seed: u64) -> usize {
        let rng = &mut Rng::new(seed);
        let (mut hits, mut known_hits) = (0, 0);
        for _ in 0..20_000 {
            let size = 2f64.powi(rng.below(80) as i32 - 40);
            let flat = [1.0, 1.0, 1e-2, 1e-4][rng.below(4)];
            let corners = [(); 3].map(|()| (size * rng.in_cube() * DVec3::new(1.0, flat, 1.0)).as_vec3());
            let [a, b, c] = corners.map(Vec3::as_dvec3);
            let [u, v] = [(); 2].map(|()| [1e-5, 0.3, rng.unit(), rng.unit()][rng.below(4)]);
            let origin = size * 2f64.powi(rng.below(8) as i32) * rng.in_cube();
            let aim = a + u * (b - a) + v * (1.0 - u) * (c - a) - origin;
            let dir = (aim / aim.abs().max_element() * 2f64.powi(rng.below(30) as i32)).as_vec3();
            let mut ray = Ray::new(origin.as_vec3(), dir);
            if let Some(at) = intersect(&ray, corners, EdgeRule::Closed) {
                let near = |ulps: i32| f32::from_bits(at.t.to_bits().wrapping_add_signed(ulps));
                let most = [f32::INFINITY, near(rng.below(1 << 12) as i32 - 30)][rng.below(2)];
                ray = ray.with_interval([0.0, near(-1 - rng.below(1 << 12) as i32)][rng.below(2)], most);
            }
            if !ray.is_valid() || !Scale::of(ray.dir).is_one() {
                continue;
            }
            let ray_lanes = RayLanes::splat(lanes, &ray, Scale::of(ray.dir));
            let splat = corners.map(|v| v.to_array().map(|x| lanes.splat(x)));
            let certain =
                products(lanes, &ray_lanes, splat).bounded(lanes, &ray_lanes).certain(lanes, &ray_lanes);
            if certain.lanes != 0 {
                hits += 1;
                let at = intersect(&ray, corners, EdgeRule::Closed).expect("certain");
                assert!(ray.t_min < at.t && at.t <= ray.t_max, "{ray:?} {at:?}");
                let (low, high) = (lanes.store(certain.low)[0], lanes.store(certain.high)[0]);
                assert!(low <= at.t && at.t <= high, "{low} {at:?} {high}");
                let known = known_hit(&ray, corners, high - low);
                assert!(known.is_none_or(|known| known == at), "{ray:?} {corners:?}");
                known_hits += usize::from(known.is_some());
            }
        }
        assert!(known_hits * 100 >= hits * 99, "{known_hits} of {hits}");
        hits
    }

    #[test]
    fn certain_hits_are_hits() {
        let hits = certain_is_so(Portable, 1);
        assert!(hits > 1000, "{hits}");
        for (isa, seed) in Isa::available().into_iter().zip(2..) {
            dispatch!(isa, lanes => certain_is_so(lanes, seed));
        }
    }

    /// At a distance of one unit of the least f32 from a corner of a large triangle, with the end of the
    /// interval at the hit: scaled like the direction, it falls between two f32.
    #[test]
    fn candidates_hold_hits_at_the_least_distances() {
        let [a, b, c] = [Vec3::ZERO, Vec3::X, Vec3::Y].map(|v| v * 2f32.powi(60));
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
