//! Kernels: how a leaf test decides whether a ray meets a triangle, and where.
//!
//! Every query uses [`Exact`] unless it is told otherwise. The others are what tracers usually have;
//! they are here so that the price of exactness can be measured, and for those who want another.

use glam::Vec3;

use crate::cluster::Cluster;
use crate::filter::{Bounded, Certain, RayLanes, Scale, candidates, products};
use crate::lanes::{Lanes, Once, Rounding, Twice, Vec3Lanes, axes, cross, dot, minus};
use crate::query::EdgeRule;
use crate::ray::Ray;
use crate::triangle::{Intersection, clear_hit, decide, known_hit};

/// A way to intersect a ray with triangles, for [`Scene::query_with`](crate::Scene::query_with).
///
/// | kernel | arithmetic | hit or miss | t |
/// |---|---|---|---|
/// | `Exact` | f32 filter, f64, exact where that leaves doubt | the mathematical truth | the exact one, rounded |
/// | `Double` | f32 filter, f64 | may err next to an edge | an ulp off at most, but for grazing rays |
/// | `Plain` | f32 | may err near edges: cracks, two hits at an edge | no bound for grazing rays |
/// | `Fused` | f32 with fused multiply-add | as `Plain`, and not the same on every processor | as `Plain` |
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Kernel {
    /// Watertight, the same bits everywhere.
    #[default]
    Exact,
    /// Moeller-Trumbore in f64, its rounding errors ignored.
    Double,
    /// Moeller-Trumbore in f32, eight triangles at once, its rounding errors ignored.
    Plain,
    /// As `Plain`, a product that is added to something rounded once with the sum, where the
    /// instruction set can do it.
    Fused,
}

impl Kernel {
    /// All of them.
    pub const ALL: [Kernel; 4] = [Self::Exact, Self::Double, Self::Plain, Self::Fused];
}

/// One lane of a cluster against one ray, whatever the ray's interval.
pub(crate) struct Subject<'a> {
    pub(crate) ray: &'a Ray,
    pub(crate) cluster: &'a Cluster,
    pub(crate) lane: usize,
    pub(crate) rule: EdgeRule,
}

/// What a leaf test asks of a kernel.
pub(crate) trait Test {
    /// What the filter finds out that serves the decision.
    type Found<L: Lanes>;

    /// The lanes that may be hit, as bits, and what was found.
    fn filter<L: Lanes>(lanes: L, ray: &RayLanes<L>, cluster: &Cluster) -> (u32, Self::Found<L>);

    /// Lanes whose hit is certain without a decision. Not for scaled directions.
    #[inline(always)]
    fn certain<L: Lanes>(_: L, _: &RayLanes<L>, _: &Self::Found<L>) -> Option<Certain<L>> {
        None
    }

    /// The hit of one of these lanes, where it is clear.
    fn clear<L: Lanes>(lanes: L, found: &Self::Found<L>, subject: &Subject<'_>) -> Option<Intersection>;

    /// The hit, if it is one, of a lane that is not a clear hit.
    #[inline(always)]
    fn unclear(_: &Subject<'_>) -> Option<Intersection> {
        None
    }
}

/// [`Kernel::Exact`].
pub(crate) struct Exact;
/// [`Kernel::Double`].
pub(crate) struct Double;
/// [`Kernel::Plain`].
pub(crate) struct Plain;
/// [`Kernel::Fused`].
pub(crate) struct Fused;

impl Test for Exact {
    type Found<L: Lanes> = Bounded<L>;

    #[inline(always)]
    fn filter<L: Lanes>(lanes: L, ray: &RayLanes<L>, cluster: &Cluster) -> (u32, Bounded<L>) {
        let bounded = products(lanes, ray, cluster.lanes(lanes)).bounded(lanes, ray);
        (bounded.possible(lanes, ray), bounded)
    }

    #[inline(always)]
    fn certain<L: Lanes>(lanes: L, ray: &RayLanes<L>, bounded: &Bounded<L>) -> Option<Certain<L>> {
        Some(bounded.certain(lanes, ray))
    }

    #[inline(always)]
    fn clear<L: Lanes>(_: L, _: &Bounded<L>, subject: &Subject<'_>) -> Option<Intersection> {
        clear_hit(subject.ray, subject.cluster.triangle(subject.lane))
    }

    /// Loads the corners again, so that clear ones need not keep them.
    #[inline(always)]
    fn unclear(subject: &Subject<'_>) -> Option<Intersection> {
        decide(subject.ray, subject.cluster.triangle(subject.lane), subject.rule)
    }
}

/// The hit of a lane that [`Test::certain`] names, its bounds of t that far apart, where it is clear.
#[inline(always)]
pub(crate) fn known(subject: &Subject<'_>, width: f32) -> Option<Intersection> {
    known_hit(subject.ray, subject.cluster.triangle(subject.lane), width)
}

impl Test for Double {
    type Found<L: Lanes> = ();

    #[inline(always)]
    fn filter<L: Lanes>(lanes: L, ray: &RayLanes<L>, cluster: &Cluster) -> (u32, ()) {
        (candidates(lanes, ray, cluster.lanes(lanes)), ())
    }

    #[inline(always)]
    fn clear<L: Lanes>(_: L, (): &(), subject: &Subject<'_>) -> Option<Intersection> {
        let [v0, v1, v2] = subject.cluster.triangle(subject.lane).map(Vec3::as_dvec3);
        let (o, d) = (subject.ray.origin.as_dvec3(), subject.ray.dir.as_dvec3());
        let (s, e1, e2) = (o - v0, v1 - v0, v2 - v0);
        let (p, q) = (e2.cross(d), e1.cross(s));
        let inverse = 1.0 / e1.dot(p);
        let (t, u, v) = (e2.dot(q) * inverse, s.dot(p) * inverse, d.dot(q) * inverse);
        let inside = u >= 0.0 && v >= 0.0 && u + v <= 1.0;
        inside.then_some(Intersection { t: t as f32, u: u as f32, v: v as f32 })
    }
}

impl Test for Plain {
    /// t in units of the scaled direction, u and v.
    type Found<L: Lanes> = Vec3Lanes<L>;

    #[inline(always)]
    fn filter<L: Lanes>(lanes: L, ray: &RayLanes<L>, cluster: &Cluster) -> (u32, Vec3Lanes<L>) {
        moeller_trumbore::<Twice, L>(lanes, ray, cluster.lanes(lanes))
    }

    #[inline(always)]
    fn clear<L: Lanes>(lanes: L, found: &Vec3Lanes<L>, subject: &Subject<'_>) -> Option<Intersection> {
        let [t, u, v] = axes(
            #[inline(always)]
            |i| lanes.lane(found[i], subject.lane),
        );
        Some(Intersection { t: Scale::of(subject.ray.dir).unscaled(t), u, v })
    }
}

impl Test for Fused {
    type Found<L: Lanes> = Vec3Lanes<L>;

    #[inline(always)]
    fn filter<L: Lanes>(lanes: L, ray: &RayLanes<L>, cluster: &Cluster) -> (u32, Vec3Lanes<L>) {
        moeller_trumbore::<Once, L>(lanes, ray, cluster.lanes(lanes))
    }

    #[inline(always)]
    fn clear<L: Lanes>(lanes: L, found: &Vec3Lanes<L>, subject: &Subject<'_>) -> Option<Intersection> {
        Plain::clear(lanes, found, subject)
    }
}

/// The lanes that are hit within the ray's interval, as bits, and t, u and v of all.
#[inline(always)]
fn moeller_trumbore<R: Rounding, L: Lanes>(
    lanes: L,
    ray: &RayLanes<L>,
    [v0, v1, v2]: [Vec3Lanes<L>; 3],
) -> (u32, Vec3Lanes<L>) {
    let zero = lanes.splat(0.0);
    let (s, e1, e2) = (minus::<L>(ray.origin, v0), minus::<L>(v1, v0), minus::<L>(v2, v0));
    let (p, q) = (cross::<R, L>(lanes, e2, ray.dir), cross::<R, L>(lanes, e1, s));
    let inverse = lanes.splat(1.0) / dot::<R, L>(lanes, e1, p);
    let [t, u, v] = [
        dot::<R, L>(lanes, e2, q) * inverse,
        dot::<R, L>(lanes, s, p) * inverse,
        dot::<R, L>(lanes, ray.dir, q) * inverse,
    ];
    // Written so that NaN, which stems from a determinant of zero, fails.
    let inside = lanes.at_most(zero, u) & lanes.at_most(zero, v) & lanes.at_most(u + v, lanes.splat(1.0));
    let within = lanes.less(ray.t_min, t) & lanes.at_most(t, ray.t_max);
    (lanes.bits(inside & within) & 0xff, [t, u, v])
}
