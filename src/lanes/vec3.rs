//! Three-component vectors, a vector a lane.

use glam::Vec3;

use super::Lanes;

/// Lanes of three-component vectors.
pub(crate) type Vec3Lanes<L> = [<L as Lanes>::F32; 3];

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
