//! Sixteen f32 lanes, for boxes: one operation where registers are that wide, two where they are half of it.

use std::ops::BitOr;

use fearless_simd::{Simd, SimdBase, SimdFloat, SimdMask, f32x16, mask32x16};

use super::{Dispatched, WIDE};

/// Sixteen f32 lanes beside the eight of [`Lanes`](super::Lanes).
pub(crate) trait Sixteen: Copy {
    /// Sixteen values.
    type F32x16: Copy;
    /// Sixteen truth values.
    type Mask16: Copy + BitOr<Output = Self::Mask16>;

    /// The same value in all lanes.
    fn splat16(self, x: f32) -> Self::F32x16;
    /// A value a lane.
    fn load16(self, x: &[f32; WIDE]) -> Self::F32x16;
    /// a * b + c, rounded once where the instruction set can do it, else twice.
    fn mul_add16(self, a: Self::F32x16, b: Self::F32x16, c: Self::F32x16) -> Self::F32x16;
    /// The lesser values; unspecified where one is NaN.
    fn min16(self, a: Self::F32x16, b: Self::F32x16) -> Self::F32x16;
    /// The greater values; unspecified where one is NaN.
    fn max16(self, a: Self::F32x16, b: Self::F32x16) -> Self::F32x16;
    /// Where a < b; false where one is NaN.
    fn less16(self, a: Self::F32x16, b: Self::F32x16) -> Self::Mask16;
    /// The mask as bits, lane 0 lowest.
    fn bits16(self, mask: Self::Mask16) -> u32;
}

impl<S: Simd> Sixteen for Dispatched<S> {
    type F32x16 = f32x16<S>;
    type Mask16 = mask32x16<S>;

    #[inline(always)]
    fn splat16(self, x: f32) -> f32x16<S> {
        f32x16::splat(self.0, x)
    }
    #[inline(always)]
    fn load16(self, x: &[f32; WIDE]) -> f32x16<S> {
        f32x16::from_slice(self.0, x)
    }
    #[inline(always)]
    fn mul_add16(self, a: f32x16<S>, b: f32x16<S>, c: f32x16<S>) -> f32x16<S> {
        a.mul_add(b, c)
    }
    #[inline(always)]
    fn min16(self, a: f32x16<S>, b: f32x16<S>) -> f32x16<S> {
        a.min(b)
    }
    #[inline(always)]
    fn max16(self, a: f32x16<S>, b: f32x16<S>) -> f32x16<S> {
        a.max(b)
    }
    #[inline(always)]
    fn less16(self, a: f32x16<S>, b: f32x16<S>) -> mask32x16<S> {
        a.simd_lt(b)
    }
    #[inline(always)]
    fn bits16(self, mask: mask32x16<S>) -> u32 {
        mask.to_bitmask() as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::{Isa, Lanes, Portable, dispatch};

    fn check<L: Lanes>(lanes: L) {
        let values: [f32; WIDE] = std::array::from_fn(|i| i as f32 - 8.0);
        let (a, one) = (lanes.load16(&values), lanes.splat16(1.0));
        let bits = |a, b| lanes.bits16(lanes.less16(a, b));
        assert_eq!(bits(a, one), 0x01ff);
        assert_eq!(lanes.bits16(lanes.less16(a, one) | lanes.less16(one, a)), 0xfdff);
        assert_eq!(bits(lanes.min16(a, one), one), 0x01ff);
        assert_eq!(bits(one, lanes.max16(a, one)), 0xfc00);
        assert_eq!(bits(lanes.mul_add16(a, a, one), lanes.splat16(17.5)), 0x1ff0);
        assert_eq!(bits(lanes.splat16(f32::NAN), a), 0);
        assert_eq!(bits(lanes.join(lanes.splat(0.5), lanes.splat(2.0)), one), 0x00ff);
    }

    #[test]
    fn every_backend_computes_the_same() {
        check(Portable);
        for isa in Isa::available() {
            dispatch!(isa, lanes => check(lanes));
        }
    }
}
