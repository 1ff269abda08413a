//! Quotients of integers of any length, rounded to floating point.

use num_bigint::{BigInt, BigUint, Sign};

/// `numerator / denominator * 2^exponent`, rounded to the nearest f32, ties to even.
///
/// Infinite where the rounded value is beyond the largest f32. A quotient of zero is +0.0, and a
/// negative one that rounds to zero is -0.0.
///
/// # Panics
/// Where the denominator is zero.
pub(super) fn to_f32(numerator: &BigInt, denominator: &BigInt, exponent: i64) -> f32 {
    const PRECISION: i64 = f32::MANTISSA_DIGITS as i64;
    const LEAST_EXPONENT: i64 = -149;
    if numerator.sign() == Sign::NoSign {
        return 0.0;
    }
    let (mantissa, scale) = quotient(numerator.magnitude(), denominator.magnitude());
    let scale = scale + exponent;
    let bits = i64::from(mantissa.ilog2()) + 1;
    let unit = (bits + scale - PRECISION).max(LEAST_EXPONENT);
    let rounded = shift_to_even(mantissa, unit - scale);
    // At most 2^24 units of a power of two: exact in f64, and in f32 unless it overflows.
    let magnitude = if unit > 127 { f32::INFINITY } else { (rounded as f64 * power_of_two(unit)) as f32 };
    if numerator.sign() == denominator.sign() { magnitude } else { -magnitude }
}

/// `numerator / denominator` with a relative error below 2^-52; zero where it is below 2^-900.
///
/// # Panics
/// Where the denominator is zero, or the quotient beyond the range of f64.
pub(super) fn to_f64(numerator: &BigInt, denominator: &BigInt) -> f64 {
    if numerator.sign() == Sign::NoSign {
        return 0.0;
    }
    let (mantissa, scale) = quotient(numerator.magnitude(), denominator.magnitude());
    let magnitude = if scale < -960 { 0.0 } else { mantissa as f64 * power_of_two(scale) };
    if numerator.sign() == denominator.sign() { magnitude } else { -magnitude }
}

/// The quotient of two positive integers as `mantissa * 2^scale`.
///
/// The mantissa has 62 or 63 bits; the lowest one stands for itself or for any remainder, so that
/// rounding to fewer bits, even twice, gives what rounding the exact quotient gives.
fn quotient(numerator: &BigUint, denominator: &BigUint) -> (u64, i64) {
    let shift = 61 + denominator.bits() as i64 - numerator.bits() as i64;
    let (n, d) = match u64::try_from(shift) {
        Ok(left) => (numerator << left, denominator.clone()),
        Err(_) => (numerator.clone(), denominator << shift.unsigned_abs()),
    };
    let whole = &n / &d;
    let sticky = u64::from(&whole * &d != n);
    let whole = u64::try_from(whole).expect("62 bits at most");
    (whole << 1 | sticky, -shift - 1)
}

/// `value / 2^shift` to the nearest integer, ties to even; `shift` is positive.
fn shift_to_even(value: u64, shift: i64) -> u64 {
    if shift > 64 {
        return 0;
    }
    let value = u128::from(value);
    let (whole, rest, half) = (value >> shift, value & ((1 << shift) - 1), 1u128 << (shift - 1));
    let up = rest > half || (rest == half && whole & 1 == 1);
    (whole + u128::from(up)) as u64
}

/// 2^exponent for the exponents of normal f64.
fn power_of_two(exponent: i64) -> f64 {
    assert!((-1022..=1023).contains(&exponent), "2^{exponent} is not a normal f64");
    f64::from_bits(((exponent + 1023) as u64) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Rng;

    fn round(numerator: i64, denominator: i64, exponent: i64) -> f32 {
        to_f32(&numerator.into(), &denominator.into(), exponent)
    }

    #[test]
    fn ties_go_to_even() {
        let one = 1i64 << 24;
        assert_eq!(round(one + 1, 1, 0), one as f32);
        assert_eq!(round(one + 3, 1, 0), (one + 4) as f32);
        assert_eq!(round(2 * one + 3, 2, 0), (one + 2) as f32);
        assert_eq!(round((one + 1) * 1_000_003 + 1, 1_000_003, 0), (one + 2) as f32);
        assert_eq!(round((one + 1) * 1_000_003 - 1, 1_000_003, 0), one as f32);
        assert_eq!(round(2 * one - 1, 1, 0), (2 * one) as f32);
    }

    #[test]
    fn signs_multiply_and_zero_is_positive() {
        assert_eq!(round(-3, -2, 0), 1.5);
        assert_eq!(round(3, -2, 0), -1.5);
        assert_eq!(round(0, -2, 0).to_bits(), 0);
        assert_eq!(round(-1, 1, -400).to_bits(), (-0.0f32).to_bits());
    }

    #[test]
    fn subnormals_round_to_their_own_unit() {
        assert_eq!(round(1, 1, -149).to_bits(), 1);
        assert_eq!(round(1, 1, -150).to_bits(), 0);
        assert_eq!(round(3, 2, -150).to_bits(), 1);
        assert_eq!(round(3, 1, -150).to_bits(), 2);
        assert_eq!(round(5, 1, -150).to_bits(), 2);
        assert_eq!(round((1 << 24) - 1, 1, -150), f32::MIN_POSITIVE);
        assert_eq!(round(1, 1, -4000).to_bits(), 0);
    }

    #[test]
    fn overflow_begins_half_a_unit_above_the_largest() {
        let largest = (1i64 << 24) - 1;
        assert_eq!(round(largest, 1, 104), f32::MAX);
        assert_eq!(round(4 * largest + 1, 4, 104), f32::MAX);
        assert_eq!(round(2 * largest + 1, 2, 104), f32::INFINITY);
        assert_eq!(round(-1, 1, 128), f32::NEG_INFINITY);
        assert_eq!(round(1, 1, 4000), f32::INFINITY);
    }

    #[test]
    fn quotients_of_f32_agree_with_the_processor() {
        let mut rng = Rng::new(1);
        for _ in 0..10_000 {
            let [a, b] = [(); 2].map(|()| rng.below(1 << 24) as i64 + 1);
            let exponent = rng.below(280) as i64 - 150;
            // Rounding a quotient of 24-bit integers to 53 bits first does not change its 24.
            let expected = (a as f64 / b as f64 * power_of_two(exponent)) as f32;
            if expected >= f32::MIN_POSITIVE {
                assert_eq!(round(a, b, exponent), expected, "{a}/{b}*2^{exponent}");
            }
            let error = to_f64(&a.into(), &b.into()) - a as f64 / b as f64;
            assert!(error.abs() <= a as f64 / b as f64 * f64::EPSILON);
        }
    }
}
