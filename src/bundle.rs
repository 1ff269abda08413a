//! Which of eight triangles a bundle of lines may meet.
//!
//! The lines go from one box to another. With a in the first and b in the second, the line passes the edge
//! from p to q on the side of the sign of (q - p).((a - p) x (b - p)): all of a triangle's sides have the
//! same sign, or are 0, where it is met. Over the boxes a side changes by no more than
//!
//! ```text
//! sum over axes of |q - p| R,    R = |a - p| x' rb + ra x' |b - p| + ra x' rb
//! ```
//!
//! where a and b now are the middles of the boxes, ra and rb half their extents, and x' is the cross product
//! with a sum in place of the difference. So a triangle is met by none of the lines where one side certainly
//! has one sign and another certainly the other.
//!
//! # Errors
//! With A, B, E the largest absolute components of a - p, b - p and q - p the rounding errors are below
//! 64 * 2^-24 E A B, of which [`EPS`] is twice as much.

use crate::cluster::Cluster;
use crate::lanes::{Lanes, Once, Vec3Lanes, axes, cross, dot, minus, splat};

/// 2^-17.
const EPS: f32 = 1.0 / (1u32 << 17) as f32;

/// Lines from one box to another.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bundle {
    /// The middles of the boxes.
    pub(crate) middle: [[f32; 3]; 2],
    /// Half of their extents.
    pub(crate) half: [[f32; 3]; 2],
}

impl Bundle {
    /// The lanes of a cluster whose triangle a line may meet, as bits.
    #[inline(always)]
    pub(crate) fn candidates<L: Lanes>(&self, lanes: L, cluster: &Cluster) -> u32 {
        let [v0, v1, v2] = cluster.lanes(lanes);
        let middle = [splat(lanes, self.middle[0].into()), splat(lanes, self.middle[1].into())];
        let half = [splat(lanes, self.half[0].into()), splat(lanes, self.half[1].into())];
        let (below0, above0) = side(lanes, &middle, &half, v0, v1);
        let (below1, above1) = side(lanes, &middle, &half, v1, v2);
        let (below2, above2) = side(lanes, &middle, &half, v2, v0);
        !lanes.bits((below0 | below1 | below2) & (above0 | above1 | above2)) & 0xff
    }
}

/// Whether all lines pass an edge on the negative side, and whether all do on the positive one.
#[inline(always)]
fn side<L: Lanes>(
    lanes: L,
    middle: &[Vec3Lanes<L>; 2],
    [ra, rb]: &[Vec3Lanes<L>; 2],
    p: Vec3Lanes<L>,
    q: Vec3Lanes<L>,
) -> (L::Mask, L::Mask) {
    let e = minus::<L>(q, p);
    let (a, b) = (minus::<L>(middle[0], p), minus::<L>(middle[1], p));
    let side = dot::<Once, L>(lanes, e, cross::<Once, L>(lanes, a, b));
    let (a, b, e) = (abs(lanes, &a), abs(lanes, &b), abs(lanes, &e));
    let wide = [a[0] + ra[0], a[1] + ra[1], a[2] + ra[2]];
    let change = axes(
        #[inline(always)]
        |axis| {
            let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
            let first = lanes.mul_add(wide[i], rb[j], wide[j] * rb[i]);
            lanes.mul_add(ra[i], b[j], lanes.mul_add(ra[j], b[i], first))
        },
    );
    // Above every intermediate value, so that it overflows first; and what is infinite excludes nothing.
    let most = lanes.splat(8.0) * size(lanes, &e) * size(lanes, &a) * size(lanes, &b);
    let change = lanes.mul_add(lanes.splat(EPS / 8.0), most, dot::<Once, L>(lanes, e, change));
    (lanes.less(side + change, lanes.splat(0.0)), lanes.less(change, side))
}

#[inline(always)]
fn abs<L: Lanes>(lanes: L, v: &Vec3Lanes<L>) -> Vec3Lanes<L> {
    [lanes.abs(v[0]), lanes.abs(v[1]), lanes.abs(v[2])]
}

/// The largest, and a little more, which covers what underflows.
#[inline(always)]
fn size<L: Lanes>(lanes: L, v: &Vec3Lanes<L>) -> L::F32 {
    lanes.max(lanes.max(v[0], v[1]), v[2]) + lanes.splat(2f32.powi(-40))
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::lanes::{Isa, dispatch};
    use crate::query::EdgeRule;
    use crate::ray::Ray;
    use crate::rng::Rng;
    use crate::triangle::intersect;

    #[test]
    fn no_triangle_is_left_out_that_a_line_meets() {
        let rng = &mut Rng::new(1);
        let (mut met, mut kept, mut all) = (0, 0, 0);
        for _ in 0..3000 {
            let size = 2f64.powi(rng.below(100) as i32 - 50);
            let narrow = [1e-6, 1e-2, 0.3][rng.below(3)];
            let middle = [(); 2].map(|()| (size * 3.0 * rng.in_cube()).as_vec3());
            let half = [(); 2].map(|()| (size * narrow * rng.in_cube().abs()).as_vec3());
            let bundle = Bundle { middle: middle.map(|v| v.to_array()), half: half.map(|v| v.to_array()) };
            let line = |rng: &mut Rng| {
                let [a, b] = [0, 1].map(|end| middle[end].as_dvec3() + half[end].as_dvec3() * rng.in_cube());
                (a, b)
            };
            let (a, b) = line(rng);
            let triangle = |i: u32| {
                let at: DVec3 = a.lerp(b, rng.unit());
                (i, [(); 3].map(|()| (at + size * [0.01, 0.5][rng.below(2)] * rng.in_cube()).as_vec3()))
            };
            let triangles: Vec<_> = (0..8).map(triangle).collect();
            let cluster = Cluster::new(&triangles);
            let bits = dispatch!(Isa::detect(), lanes => bundle.candidates(lanes, &cluster));
            kept += bits.count_ones();
            all += 8;
            for _ in 0..20 {
                // Rounding moves a line by less than the boxes are made smaller by here.
                let (a, b) = line(rng);
                let (a, b) = (middle[0].as_dvec3().lerp(a, 0.99), middle[1].as_dvec3().lerp(b, 0.99));
                let ray = Ray::new(a.as_vec3(), (b - a.as_vec3().as_dvec3()).as_vec3());
                for (i, corners) in &triangles {
                    if narrow > 1e-5 && intersect(&ray, *corners, EdgeRule::Closed).is_some() {
                        met += 1;
                        assert!(bits >> i & 1 != 0, "{bundle:?} {corners:?} {ray:?}");
                    }
                }
            }
        }
        assert!(met > 1000 && kept < all, "{met} {kept} {all}");
    }
}
