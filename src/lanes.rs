//! SIMD lanes: the only file that names the SIMD crates' backends.
//!
//! A kernel is written once against [`Lanes`] and runs on eight lanes of every instruction set.
//! `dispatch` picks the set at run time, once a query or batch.
//!
//! Lanes are used where an error bound is known, never for final answers, so that it does not matter
//! whether an instruction set fuses a multiplication with an addition.

mod double;
#[cfg(test)]
mod portable;
mod sixteen;
mod vec3;

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Sub};

pub(crate) use double::Doubles;
use fearless_simd::{
    Level, Select, Simd, SimdBase, SimdCombine, SimdFloat, SimdMask, f32x8, f32x16, f64x4, mask32x8, mask64x4,
};
#[cfg(test)]
pub(crate) use portable::Portable;
pub(crate) use sixteen::Sixteen;
pub(crate) use vec3::{Once, Rounding, Twice, Vec3Lanes, cross, dot, minus, splat};

/// Lanes in one operation.
pub(crate) const WIDTH: usize = 8;

/// Lanes in one operation on boxes.
pub(crate) const WIDE: usize = 16;

/// Eight f32 or four f64 lanes: the operations that the kernels need, and no more.
pub(crate) trait Lanes: Sixteen {
    /// Eight values.
    type F32: Copy
        + Add<Output = Self::F32>
        + Sub<Output = Self::F32>
        + Mul<Output = Self::F32>
        + Div<Output = Self::F32>
        + Neg<Output = Self::F32>;
    /// Eight truth values.
    type Mask: Copy + BitAnd<Output = Self::Mask> + BitOr<Output = Self::Mask>;

    /// Runs `f` and all that is inlined into it with the instruction set of the lanes. What is called
    /// without being inlined loses it, and each operation becomes a call.
    fn vectorize<R>(self, f: impl FnOnce() -> R) -> R;
    /// The same value in all lanes.
    fn splat(self, x: f32) -> Self::F32;
    /// A value a lane.
    fn load(self, x: &[f32; WIDTH]) -> Self::F32;
    /// The values.
    fn store(self, x: Self::F32) -> [f32; WIDTH];
    /// The value of one lane.
    ///
    /// # Panics
    /// Where there is no such lane.
    #[inline(always)]
    fn lane(self, x: Self::F32, lane: usize) -> f32 {
        /// Within a cache line, or the load would wait until the store has left the processor.
        #[repr(align(32))]
        struct Aligned([f32; WIDTH]);
        Aligned(self.store(x)).0[lane]
    }
    /// a * b + c, rounded once where the instruction set can do it, else twice.
    fn mul_add(self, a: Self::F32, b: Self::F32, c: Self::F32) -> Self::F32;
    /// The absolute values.
    fn abs(self, x: Self::F32) -> Self::F32;
    /// 1 or -1 with the sign of each value.
    fn sign(self, x: Self::F32) -> Self::F32;
    /// The lesser values; unspecified where one is NaN.
    fn min(self, a: Self::F32, b: Self::F32) -> Self::F32;
    /// The greater values; unspecified where one is NaN.
    fn max(self, a: Self::F32, b: Self::F32) -> Self::F32;
    /// Where a < b; false where one is NaN.
    fn less(self, a: Self::F32, b: Self::F32) -> Self::Mask;
    /// Where a <= b; false where one is NaN.
    fn at_most(self, a: Self::F32, b: Self::F32) -> Self::Mask;
    /// The mask as bits, lane 0 lowest.
    fn bits(self, mask: Self::Mask) -> u32;
    /// The inverse of [`Lanes::bits`].
    fn mask(self, bits: u32) -> Self::Mask;
    /// a where the mask is true, else b.
    fn select(self, mask: Self::Mask, a: Self::F32, b: Self::F32) -> Self::F32;
    /// The values a0 b0 a1 b1 and so on, in two halves.
    fn interleave(self, a: Self::F32, b: Self::F32) -> [Self::F32; 2];
    /// The values of `a`, then those of `b`.
    fn join(self, a: Self::F32, b: Self::F32) -> Self::F32x16;

    /// Four f64 values.
    type F64: Copy
        + Add<Output = Self::F64>
        + Sub<Output = Self::F64>
        + Mul<Output = Self::F64>
        + Div<Output = Self::F64>
        + Neg<Output = Self::F64>;
    /// Four truth values.
    type Mask4: Copy + BitAnd<Output = Self::Mask4>;

    /// The same f64 in four lanes.
    fn splat4(self, x: f64) -> Self::F64;
    /// Four f64.
    fn load4(self, x: &[f64; 4]) -> Self::F64;
    /// The four f64.
    fn store4(self, x: Self::F64) -> [f64; 4];
    /// The absolute values.
    fn abs4(self, x: Self::F64) -> Self::F64;
    /// The lesser values; unspecified where one is NaN.
    fn min4(self, a: Self::F64, b: Self::F64) -> Self::F64;
    /// The greater values; unspecified where one is NaN.
    fn max4(self, a: Self::F64, b: Self::F64) -> Self::F64;
    /// The least of the values; unspecified where one is NaN.
    fn least4(self, x: Self::F64) -> f64;
    /// The greatest of the values; unspecified where one is NaN.
    fn greatest4(self, x: Self::F64) -> f64;
    /// Where a < b; false where one is NaN.
    fn less4(self, a: Self::F64, b: Self::F64) -> Self::Mask4;
    /// a where the mask is true, else b.
    fn select4(self, mask: Self::Mask4, a: Self::F64, b: Self::F64) -> Self::F64;
    /// The mask as bits, lane 0 lowest.
    fn bits4(self, mask: Self::Mask4) -> u32;
}

/// The values for the three axes.
///
/// Lanes must stay in registers and below the dispatch. The functions of arrays are inlined only where
/// the compiler likes to, and so are closures without the attribute: where it does not, each operation
/// on lanes becomes a call.
#[inline(always)]
pub(crate) fn axes<T>(f: impl Fn(usize) -> T) -> [T; 3] {
    [f(0), f(1), f(2)]
}

/// Columns of rows. Interleaving rows that are four apart moves the highest bit of a value's row behind the bits of its
/// column, so that three times swap row and column.
#[inline(always)]
pub(crate) fn transpose<L: Lanes>(lanes: L, mut rows: [L::F32; WIDTH]) -> [L::F32; WIDTH] {
    for _ in 0..3 {
        let [[a, b], [c, d], [e, f], [g, h]] = [
            lanes.interleave(rows[0], rows[4]),
            lanes.interleave(rows[1], rows[5]),
            lanes.interleave(rows[2], rows[6]),
            lanes.interleave(rows[3], rows[7]),
        ];
        rows = [a, b, c, d, e, f, g, h];
    }
    rows
}

/// The lesser one of two numbers, `b` where one is NaN: one instruction, where f32's and f64's own are up to five.
#[inline(always)]
pub(crate) fn lesser<T: PartialOrd>(a: T, b: T) -> T {
    if a < b { a } else { b }
}

/// The greater one of two numbers, likewise.
#[inline(always)]
pub(crate) fn greater<T: PartialOrd>(a: T, b: T) -> T {
    if a > b { a } else { b }
}

/// Lanes of an instruction set that was found at run time.
#[derive(Clone, Copy)]
pub(crate) struct Dispatched<S>(pub(crate) S);

/// The same, not to be copied: a closure takes it by value, which is nothing, where it would keep a pointer to what
/// can be copied. With two pointers to keep at most it is handed over in registers.
#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
pub(crate) struct Token<S>(pub(crate) S);

#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
impl<S> Token<S> {
    #[inline(always)]
    pub(crate) fn lanes(self) -> Dispatched<S> {
        Dispatched(self.0)
    }
}

impl<S: Simd> Lanes for Dispatched<S> {
    type F32 = f32x8<S>;
    type Mask = mask32x8<S>;

    #[inline(always)]
    fn vectorize<R>(self, f: impl FnOnce() -> R) -> R {
        self.0.vectorize(f)
    }
    #[inline(always)]
    fn splat(self, x: f32) -> f32x8<S> {
        f32x8::splat(self.0, x)
    }
    #[inline(always)]
    fn load(self, x: &[f32; WIDTH]) -> f32x8<S> {
        f32x8::from_slice(self.0, x)
    }
    #[inline(always)]
    fn store(self, x: f32x8<S>) -> [f32; WIDTH] {
        x.into()
    }
    #[inline(always)]
    fn mul_add(self, a: f32x8<S>, b: f32x8<S>, c: f32x8<S>) -> f32x8<S> {
        a.mul_add(b, c)
    }
    #[inline(always)]
    fn abs(self, x: f32x8<S>) -> f32x8<S> {
        x.abs()
    }
    #[inline(always)]
    fn sign(self, x: f32x8<S>) -> f32x8<S> {
        self.splat(1.0).copysign(x)
    }
    #[inline(always)]
    fn min(self, a: f32x8<S>, b: f32x8<S>) -> f32x8<S> {
        a.min(b)
    }
    #[inline(always)]
    fn max(self, a: f32x8<S>, b: f32x8<S>) -> f32x8<S> {
        a.max(b)
    }
    #[inline(always)]
    fn less(self, a: f32x8<S>, b: f32x8<S>) -> mask32x8<S> {
        a.simd_lt(b)
    }
    #[inline(always)]
    fn at_most(self, a: f32x8<S>, b: f32x8<S>) -> mask32x8<S> {
        a.simd_le(b)
    }
    #[inline(always)]
    fn bits(self, mask: mask32x8<S>) -> u32 {
        mask.to_bitmask() as u32
    }
    #[inline(always)]
    fn mask(self, bits: u32) -> mask32x8<S> {
        mask32x8::from_bitmask(self.0, u64::from(bits))
    }
    #[inline(always)]
    fn select(self, mask: mask32x8<S>, a: f32x8<S>, b: f32x8<S>) -> f32x8<S> {
        mask.select(a, b)
    }
    #[inline(always)]
    fn interleave(self, a: f32x8<S>, b: f32x8<S>) -> [f32x8<S>; 2] {
        let (low, high) = self.0.interleave_f32x8(a, b);
        [low, high]
    }
    #[inline(always)]
    fn join(self, a: f32x8<S>, b: f32x8<S>) -> f32x16<S> {
        a.combine(b)
    }

    type F64 = f64x4<S>;
    type Mask4 = mask64x4<S>;

    #[inline(always)]
    fn splat4(self, x: f64) -> f64x4<S> {
        f64x4::splat(self.0, x)
    }
    #[inline(always)]
    fn load4(self, x: &[f64; 4]) -> f64x4<S> {
        f64x4::from_slice(self.0, x)
    }
    #[inline(always)]
    fn store4(self, x: f64x4<S>) -> [f64; 4] {
        x.into()
    }
    #[inline(always)]
    fn abs4(self, x: f64x4<S>) -> f64x4<S> {
        x.abs()
    }
    #[inline(always)]
    fn min4(self, a: f64x4<S>, b: f64x4<S>) -> f64x4<S> {
        a.min(b)
    }
    #[inline(always)]
    fn max4(self, a: f64x4<S>, b: f64x4<S>) -> f64x4<S> {
        a.max(b)
    }
    #[inline(always)]
    fn least4(self, x: f64x4<S>) -> f64 {
        x.reduce_min()
    }
    #[inline(always)]
    fn greatest4(self, x: f64x4<S>) -> f64 {
        x.reduce_max()
    }
    #[inline(always)]
    fn less4(self, a: f64x4<S>, b: f64x4<S>) -> mask64x4<S> {
        a.simd_lt(b)
    }
    #[inline(always)]
    fn select4(self, mask: mask64x4<S>, a: f64x4<S>, b: f64x4<S>) -> f64x4<S> {
        mask.select(a, b)
    }
    #[inline(always)]
    fn bits4(self, mask: mask64x4<S>) -> u32 {
        mask.to_bitmask() as u32
    }
}

/// Runs `$body` with `$lanes` bound to the lanes of the instruction set `$isa`.
macro_rules! dispatch {
    ($isa:expr, $lanes:ident => $body:expr) => {
        match $isa.level() {
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            fearless_simd::Level::Avx2(simd) => $crate::lanes::dispatch!(@ simd, $lanes => $body),
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            fearless_simd::Level::Avx512(simd) => $crate::lanes::dispatch!(@ simd, $lanes => $body),
            // Apart, as the target's own set is compiled into the caller, where it would make all pay for its
            // registers.
            #[cfg(all(any(target_arch = "x86", target_arch = "x86_64"), target_feature = "sse2"))]
            level => {
                let simd = level.as_sse2().expect("every level has what the target has");
                $crate::lanes::apart(|| $crate::lanes::dispatch!(@ simd, $lanes => $body))
            }
            #[cfg(not(all(any(target_arch = "x86", target_arch = "x86_64"), target_feature = "sse2")))]
            _ => $crate::lanes::apart(|| $crate::lanes::dispatch_here!($isa, $lanes => $body)),
        }
    };
    (@ $simd:ident, $lanes:ident => $body:expr) => {{
        let token = $crate::lanes::Token($simd);
        fearless_simd::Simd::vectorize($simd, #[inline(always)] || {
            let $lanes = token.lanes();
            $body
        })
    }};
}
pub(crate) use dispatch;

/// The same where all of it may be compiled into the caller.
macro_rules! dispatch_here {
    ($isa:expr, $lanes:ident => $body:expr) => {
        fearless_simd::dispatch!($isa.level(), simd => {
            let $lanes = $crate::lanes::Dispatched(simd);
            $body
        })
    };
}
pub(crate) use dispatch_here;

/// Runs `f` in a function of its own.
#[inline(never)]
pub(crate) fn apart<R>(f: impl FnOnce() -> R) -> R {
    f()
}

/// An instruction set for the queries. Every one gives the same bits.
#[derive(Clone, Copy)]
pub struct Isa(Level);

impl Isa {
    /// The best one of this processor.
    pub fn detect() -> Self {
        let level = Level::new();
        // What SSE4.2 has besides is not worth another copy of all walks.
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        if let (Level::Sse4_2(_), Some(simd)) = (level, level.as_sse2()) {
            return Self(Level::Sse2(simd));
        }
        Self(level)
    }

    /// The one that the crate is compiled for.
    #[inline(always)]
    pub(crate) fn baseline() -> Self {
        Self(Level::baseline())
    }

    /// All that this processor has, the best one last.
    pub fn available() -> Vec<Self> {
        let level = Level::new();
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        let all = [
            level.as_sse2().map(Level::Sse2),
            level.as_avx2().map(Level::Avx2),
            level.as_avx512().map(Level::Avx512),
        ];
        #[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
        let all = [Some(level)];
        all.into_iter().flatten().map(Self).collect()
    }

    #[inline(always)]
    pub(crate) fn level(self) -> Level {
        self.0
    }
}

impl std::fmt::Display for Isa {
    /// `SSE2`, `AVX2`, `AVX-512`, or what this processor's family has instead.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self.0 {
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Level::Sse2(_) => "SSE2",
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Level::Avx2(_) => "AVX2",
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Level::Avx512(_) => "AVX-512",
            _ => std::env::consts::ARCH,
        })
    }
}

impl std::fmt::Debug for Isa {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Isa({self})")
    }
}

impl PartialEq for Isa {
    fn eq(&self, other: &Self) -> bool {
        std::mem::discriminant(&self.0) == std::mem::discriminant(&other.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(lanes: impl Lanes) {
        let a = [1.0, -2.0, 3.0, f32::NAN, 0.0, -0.0, f32::INFINITY, -8.0];
        let b = [2.0, -3.0, 3.0, 1.0, -0.0, 0.0, f32::INFINITY, -7.0];
        let less = lanes.less(lanes.load(&a), lanes.load(&b));
        assert_eq!(lanes.bits(less), 0b1000_0001);
        let chosen = lanes.select(lanes.mask(0b1010_0010), lanes.load(&b), lanes.load(&a));
        let chosen = lanes.store(chosen).map(f32::to_bits);
        assert_eq!(chosen, [1.0, -3.0, 3.0, f32::NAN, 0.0, 0.0, f32::INFINITY, -7.0].map(f32::to_bits));
        let abs = lanes.abs(lanes.load(&a)) - lanes.splat(2.5);
        assert_eq!(lanes.bits(lanes.less(lanes.splat(0.0), abs)), 0b1100_0100);
        let (low, high) =
            (lanes.min(lanes.load(&b), lanes.splat(1.0)), lanes.max(lanes.load(&b), lanes.splat(1.0)));
        assert_eq!(lanes.bits(lanes.less(low, high)), 0b1111_0111);
        let rows = std::array::from_fn::<_, WIDTH, _>(|row| {
            std::array::from_fn::<_, WIDTH, _>(|column| (8 * row + column) as f32)
        });
        let columns = transpose(lanes, rows.map(|row| lanes.load(&row))).map(|column| lanes.store(column));
        assert_eq!(
            columns,
            std::array::from_fn::<_, WIDTH, _>(|column| std::array::from_fn::<_, WIDTH, _>(
                |row| rows[row][column]
            ))
        );
        let (a, b) = (lanes.load4(&[1.0, 2.0, 3.0, f64::NAN]), lanes.splat4(9.0));
        let above = lanes.less4(lanes.splat4(1.5), a);
        assert_eq!(lanes.store4(lanes.select4(above, a, b)), [9.0, 2.0, 3.0, 9.0]);
        assert_eq!(lanes.bits4(above), 0b0110);
        let (a, b) = (lanes.load4(&[1.0, -2.0, -0.0, 4.0]), lanes.splat4(0.5));
        assert_eq!(lanes.store4(lanes.min4(a, b)), [0.5, -2.0, -0.0, 0.5]);
        assert_eq!(lanes.store4(lanes.max4(lanes.abs4(a), b)), [1.0, 2.0, 0.5, 4.0]);
        assert_eq!((lanes.least4(a), lanes.greatest4(a)), (-2.0, 4.0));
    }

    #[test]
    fn every_backend_computes_the_same() {
        check(Portable);
        for isa in Isa::available() {
            dispatch!(isa, lanes => check(lanes));
        }
    }
}
