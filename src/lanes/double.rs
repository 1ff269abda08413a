//! Eight f64 lanes, for decisions on eight rays at once.

use std::ops::{Add, Div, Mul, Sub};

use fearless_simd::{Simd, SimdBase, SimdMask, f64x4};

use super::{Dispatched, Lanes, WIDTH};

/// Eight f64 lanes beside eight f32 lanes. No product is fused with a sum, so that every instruction set
/// computes the same bits, which are those of scalar code.
pub(crate) trait Doubles: Lanes {
    /// Eight f64 values.
    type F64x8: Copy
        + Add<Output = Self::F64x8>
        + Sub<Output = Self::F64x8>
        + Mul<Output = Self::F64x8>
        + Div<Output = Self::F64x8>;

    /// The same f64 in all lanes.
    fn splat8(self, x: f64) -> Self::F64x8;
    /// A value a lane.
    fn load8(self, x: &[f64; WIDTH]) -> Self::F64x8;
    /// The values.
    fn store8(self, x: Self::F64x8) -> [f64; WIDTH];
    /// The same values, which f64 holds all.
    fn widen(self, x: Self::F32) -> Self::F64x8;
    /// The nearest f32, ties to even.
    fn narrow(self, x: Self::F64x8) -> Self::F32;
    /// The absolute values.
    fn abs8(self, x: Self::F64x8) -> Self::F64x8;
    /// Where a < b, as bits; not where one is NaN.
    fn less8(self, a: Self::F64x8, b: Self::F64x8) -> u32;
    /// Where a <= b, as bits; not where one is NaN.
    fn at_most8(self, a: Self::F64x8, b: Self::F64x8) -> u32;
}

/// Two registers of four: wider ones lower the clock of some processors.
#[derive(Clone, Copy)]
pub(crate) struct Pair<T>(T, T);

impl<T: Add<Output = T>> Add for Pair<T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        Self(self.0 + b.0, self.1 + b.1)
    }
}

impl<T: Sub<Output = T>> Sub for Pair<T> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        Self(self.0 - b.0, self.1 - b.1)
    }
}

impl<T: Mul<Output = T>> Mul for Pair<T> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, b: Self) -> Self {
        Self(self.0 * b.0, self.1 * b.1)
    }
}

impl<T: Div<Output = T>> Div for Pair<T> {
    type Output = Self;
    #[inline(always)]
    fn div(self, b: Self) -> Self {
        Self(self.0 / b.0, self.1 / b.1)
    }
}

impl<S: Simd> Doubles for Dispatched<S> {
    type F64x8 = Pair<f64x4<S>>;

    #[inline(always)]
    fn splat8(self, x: f64) -> Self::F64x8 {
        Pair(f64x4::splat(self.0, x), f64x4::splat(self.0, x))
    }
    #[inline(always)]
    fn load8(self, x: &[f64; WIDTH]) -> Self::F64x8 {
        Pair(f64x4::from_slice(self.0, &x[..4]), f64x4::from_slice(self.0, &x[4..]))
    }
    #[inline(always)]
    fn store8(self, x: Self::F64x8) -> [f64; WIDTH] {
        let mut all = [0.0; WIDTH];
        x.0.store_slice(&mut all[..4]);
        x.1.store_slice(&mut all[4..]);
        all
    }
    #[inline(always)]
    fn widen(self, x: Self::F32) -> Self::F64x8 {
        let (low, high) = self.0.widen_f32x8(x);
        Pair(low, high)
    }
    #[inline(always)]
    fn narrow(self, x: Self::F64x8) -> Self::F32 {
        self.0.narrow_f64x4(x.0, x.1)
    }
    #[inline(always)]
    fn abs8(self, x: Self::F64x8) -> Self::F64x8 {
        Pair(x.0.abs(), x.1.abs())
    }
    #[inline(always)]
    fn less8(self, a: Self::F64x8, b: Self::F64x8) -> u32 {
        (a.0.simd_lt(b.0).to_bitmask() | a.1.simd_lt(b.1).to_bitmask() << 4) as u32
    }
    #[inline(always)]
    fn at_most8(self, a: Self::F64x8, b: Self::F64x8) -> u32 {
        (a.0.simd_le(b.0).to_bitmask() | a.1.simd_le(b.1).to_bitmask() << 4) as u32
    }
}
