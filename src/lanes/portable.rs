//! Lanes over `wide`, as a reference for tests: compiled for one instruction set, not dispatched.

use super::{Lanes, Sixteen, WIDE, WIDTH};

#[derive(Clone, Copy)]
pub(crate) struct Portable;

impl Lanes for Portable {
    type F32 = wide::f32x8;
    type Mask = wide::f32x8;

    #[inline(always)]
    fn vectorize<R>(self, f: impl FnOnce() -> R) -> R {
        f()
    }
    #[inline(always)]
    fn splat(self, x: f32) -> wide::f32x8 {
        wide::f32x8::splat(x)
    }
    #[inline(always)]
    fn load(self, x: &[f32; WIDTH]) -> wide::f32x8 {
        wide::f32x8::from(*x)
    }
    #[inline(always)]
    fn store(self, x: wide::f32x8) -> [f32; WIDTH] {
        x.to_array()
    }
    #[inline(always)]
    fn mul_add(self, a: wide::f32x8, b: wide::f32x8, c: wide::f32x8) -> wide::f32x8 {
        a.mul_add(b, c)
    }
    #[inline(always)]
    fn abs(self, x: wide::f32x8) -> wide::f32x8 {
        x.abs()
    }
    #[inline(always)]
    fn sign(self, x: wide::f32x8) -> wide::f32x8 {
        self.splat(1.0).copysign(x)
    }
    #[inline(always)]
    fn min(self, a: wide::f32x8, b: wide::f32x8) -> wide::f32x8 {
        a.fast_min(b)
    }
    #[inline(always)]
    fn max(self, a: wide::f32x8, b: wide::f32x8) -> wide::f32x8 {
        a.fast_max(b)
    }
    #[inline(always)]
    fn less(self, a: wide::f32x8, b: wide::f32x8) -> wide::f32x8 {
        a.simd_lt(b)
    }
    #[inline(always)]
    fn at_most(self, a: wide::f32x8, b: wide::f32x8) -> wide::f32x8 {
        a.simd_le(b)
    }
    #[inline(always)]
    fn bits(self, mask: wide::f32x8) -> u32 {
        mask.to_bitmask()
    }
    #[inline(always)]
    fn mask(self, bits: u32) -> wide::f32x8 {
        let lane = |i: usize| f32::from_bits(if bits >> i & 1 != 0 { u32::MAX } else { 0 });
        wide::f32x8::from([lane(0), lane(1), lane(2), lane(3), lane(4), lane(5), lane(6), lane(7)])
    }
    #[inline(always)]
    fn select(self, mask: wide::f32x8, a: wide::f32x8, b: wide::f32x8) -> wide::f32x8 {
        mask.select(a, b)
    }
    #[inline(always)]
    fn interleave(self, a: wide::f32x8, b: wide::f32x8) -> [wide::f32x8; 2] {
        let (a, b) = (a.to_array(), b.to_array());
        [0, 4].map(|i| {
            let [c, d] = [&a[i..i + 4], &b[i..i + 4]];
            wide::f32x8::from([c[0], d[0], c[1], d[1], c[2], d[2], c[3], d[3]])
        })
    }
    #[inline(always)]
    fn join(self, a: wide::f32x8, b: wide::f32x8) -> wide::f32x16 {
        let (a, b) = (a.to_array(), b.to_array());
        wide::f32x16::from(std::array::from_fn(|i| if i < WIDTH { a[i] } else { b[i - WIDTH] }))
    }

    type F64 = wide::f64x4;
    type Mask4 = wide::f64x4;

    #[inline(always)]
    fn splat4(self, x: f64) -> wide::f64x4 {
        wide::f64x4::splat(x)
    }
    #[inline(always)]
    fn load4(self, x: &[f64; 4]) -> wide::f64x4 {
        wide::f64x4::from(*x)
    }
    #[inline(always)]
    fn store4(self, x: wide::f64x4) -> [f64; 4] {
        x.into()
    }
    #[inline(always)]
    fn abs4(self, x: wide::f64x4) -> wide::f64x4 {
        x.abs()
    }
    #[inline(always)]
    fn min4(self, a: wide::f64x4, b: wide::f64x4) -> wide::f64x4 {
        a.min(b)
    }
    #[inline(always)]
    fn max4(self, a: wide::f64x4, b: wide::f64x4) -> wide::f64x4 {
        a.max(b)
    }
    #[inline(always)]
    fn least4(self, x: wide::f64x4) -> f64 {
        x.to_array().into_iter().fold(f64::INFINITY, f64::min)
    }
    #[inline(always)]
    fn greatest4(self, x: wide::f64x4) -> f64 {
        x.to_array().into_iter().fold(f64::NEG_INFINITY, f64::max)
    }
    #[inline(always)]
    fn less4(self, a: wide::f64x4, b: wide::f64x4) -> wide::f64x4 {
        a.simd_lt(b)
    }
    #[inline(always)]
    fn select4(self, mask: wide::f64x4, a: wide::f64x4, b: wide::f64x4) -> wide::f64x4 {
        mask.select(a, b)
    }
    #[inline(always)]
    fn bits4(self, mask: wide::f64x4) -> u32 {
        mask.to_bitmask()
    }
}

impl Sixteen for Portable {
    type F32x16 = wide::f32x16;
    type Mask16 = wide::f32x16;

    #[inline(always)]
    fn splat16(self, x: f32) -> wide::f32x16 {
        wide::f32x16::splat(x)
    }
    #[inline(always)]
    fn load16(self, x: &[f32; WIDE]) -> wide::f32x16 {
        wide::f32x16::from(*x)
    }
    #[inline(always)]
    fn mul_add16(self, a: wide::f32x16, b: wide::f32x16, c: wide::f32x16) -> wide::f32x16 {
        a.mul_add(b, c)
    }
    #[inline(always)]
    fn min16(self, a: wide::f32x16, b: wide::f32x16) -> wide::f32x16 {
        a.fast_min(b)
    }
    #[inline(always)]
    fn max16(self, a: wide::f32x16, b: wide::f32x16) -> wide::f32x16 {
        a.fast_max(b)
    }
    #[inline(always)]
    fn less16(self, a: wide::f32x16, b: wide::f32x16) -> wide::f32x16 {
        a.simd_lt(b)
    }
    #[inline(always)]
    fn bits16(self, mask: wide::f32x16) -> u32 {
        mask.to_bitmask()
    }
}
