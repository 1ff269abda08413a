//! Exact arithmetic on sums of f64 terms, for the few decisions that rounding leaves open.
//!
//! Source: J. R. Shewchuk, "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric
//! Predicates", 1997: an [`Expansion`] is a sum of non-overlapping f64 terms of increasing magnitude.
//! Here every input is an f32, so no term overflows, and none underflows: a product of four f32 is a
//! multiple of 2^-596 below 2^512.

/// a + b as a rounded sum and its error.
#[inline]
pub(crate) fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let bb = sum - a;
    (sum, (a - (sum - bb)) + (b - bb))
}

/// a * b as a rounded product and its error (Dekker's split, so that no FMA is needed).
#[inline]
pub(crate) fn two_product(a: f64, b: f64) -> (f64, f64) {
    let split = |x: f64| {
        let c = 134_217_729.0 * x;
        let high = c - (c - x);
        (high, x - high)
    };
    let product = a * b;
    let ((ah, al), (bh, bl)) = (split(a), split(b));
    (product, ((ah * bh - product) + ah * bl + al * bh) + al * bl)
}

/// An exact sum of up to `N` f64 terms.
///
/// A difference of two f64 has 2 terms, a product twice the product of its factors' terms, a sum the
/// sum of its terms.
#[derive(Clone, Copy)]
pub(crate) struct Expansion<const N: usize> {
    terms: [f64; N],
    len: usize,
}

/// A component of a difference of vectors.
pub(crate) type Difference = Expansion<2>;

/// A component of a cross product of differences.
pub(crate) type Cross = Expansion<16>;

/// A dot product of a difference and a cross product.
pub(crate) type Triple = Expansion<192>;

impl Difference {
    /// a - b.
    pub(crate) fn new(a: f64, b: f64) -> Self {
        let mut e = Self::ZERO;
        e.grow(a);
        e.grow(-b);
        e
    }
}

impl<const N: usize> Expansion<N> {
    const ZERO: Self = Self { terms: [0.0; N], len: 0 };

    /// Adds one term.
    fn grow(&mut self, term: f64) {
        let mut carry = term;
        let mut len = 0;
        for i in 0..self.len {
            let (sum, error) = two_sum(carry, self.terms[i]);
            if error != 0.0 {
                self.terms[len] = error;
                len += 1;
            }
            carry = sum;
        }
        if carry != 0.0 {
            self.terms[len] = carry;
            len += 1;
        }
        self.len = len;
    }

    fn terms(&self) -> &[f64] {
        &self.terms[..self.len]
    }

    /// Adds `sign * a * b`.
    fn add_product<const A: usize, const B: usize>(&mut self, a: &Expansion<A>, b: &Expansion<B>, sign: f64) {
        for &x in a.terms() {
            for &y in b.terms() {
                let (product, error) = two_product(x, sign * y);
                self.grow(error);
                self.grow(product);
            }
        }
    }

    /// self - other.
    pub(crate) fn minus<const B: usize, const R: usize>(&self, other: &Expansion<B>) -> Expansion<R> {
        let mut e = Expansion::ZERO;
        self.terms().iter().for_each(|&x| e.grow(x));
        other.terms().iter().for_each(|&x| e.grow(-x));
        e
    }

    /// -1, 0 or 1.
    pub(crate) fn sign(&self) -> f64 {
        self.terms().last().map_or(0.0, |x| x.signum())
    }

    /// The value with a relative error of a few 2^-53.
    pub(crate) fn estimate(&self) -> f64 {
        self.terms().iter().sum()
    }
}

/// The dot product.
pub(crate) fn dot(a: &[Difference; 3], b: &[Cross; 3]) -> Triple {
    let mut e = Triple::ZERO;
    for axis in 0..3 {
        e.add_product(&a[axis], &b[axis], 1.0);
    }
    e
}

/// The cross product.
pub(crate) fn cross(a: &[Difference; 3], b: &[Difference; 3]) -> [Cross; 3] {
    std::array::from_fn(|axis| {
        let (j, k) = ((axis + 1) % 3, (axis + 2) % 3);
        let mut e = Cross::ZERO;
        e.add_product(&a[j], &b[k], 1.0);
        e.add_product(&a[k], &b[j], -1.0);
        e
    })
}

/// numerator / denominator rounded to the nearest f32, ties to even; a zero is positive.
///
/// The denominator must not be zero.
pub(crate) fn divide_to_f32(numerator: &Triple, denominator: &Triple) -> f32 {
    let estimate = (numerator.estimate() / denominator.estimate()) as f32;
    let mut t = estimate.clamp(f32::MIN, f32::MAX);
    // The estimate is good to 2^-50, so the nearest f32 is at most one step away.
    while t.is_finite() {
        let above = compare(numerator, denominator, midpoint(t, t.next_up()));
        let below = compare(numerator, denominator, midpoint(t.next_down(), t));
        let even = t.to_bits().is_multiple_of(2);
        t = if above > 0.0 || (above == 0.0 && !even) {
            t.next_up()
        } else if below < 0.0 || (below == 0.0 && !even) {
            t.next_down()
        } else {
            break;
        };
    }
    t + 0.0
}

/// The sign of numerator / denominator - x.
fn compare(numerator: &Triple, denominator: &Triple, x: f64) -> f64 {
    let mut rest: Expansion<576> = numerator.minus(&Difference::ZERO);
    rest.add_product(denominator, &Difference::new(x, 0.0), -1.0);
    rest.sign() * denominator.sign()
}

/// Halfway between two neighbouring f32, exact in f64; beyond the largest one as if the range went on.
pub(crate) fn midpoint(low: f32, high: f32) -> f64 {
    const BEYOND: f64 = f32::MAX as f64 * (1.0 + 1.0 / ((1u64 << 25) - 2) as f64);
    match (low.is_finite(), high.is_finite()) {
        (true, true) => 0.5 * (f64::from(low) + f64::from(high)),
        (true, false) => BEYOND,
        (false, true) => -BEYOND,
        (false, false) => f64::from(low),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(x: f64) -> Triple {
        Difference::new(x, 0.0).minus(&Difference::ZERO)
    }

    #[test]
    fn cancellation_leaves_the_exact_rest() {
        let big = value(1e30);
        let sum: Triple = big.minus::<192, 192>(&value(-1.0)).minus(&big);
        assert_eq!((sum.sign(), sum.estimate()), (1.0, 1.0));
        let (product, error) = two_product(1.0 + f64::EPSILON, 1.0 - f64::EPSILON);
        assert_eq!((product, error), (1.0, -f64::EPSILON * f64::EPSILON));
    }

    #[test]
    fn the_vectors_of_a_right_handed_system() {
        let v = |x: [f64; 3]| x.map(|x| Difference::new(x, 0.0));
        let n = cross(&v([3.0, 0.0, 0.0]), &v([0.0, 5.0, 0.0]));
        assert_eq!(n.map(|e| e.estimate()), [0.0, 0.0, 15.0]);
        assert_eq!(dot(&v([7.0, 7.0, 2.0]), &n).estimate(), 30.0);
    }

    #[test]
    fn division_rounds_to_nearest_even() {
        let ulp = f64::from(f32::EPSILON);
        let div = |a: f64, b: f64| divide_to_f32(&value(a), &value(b));
        assert_eq!(div(1.0 + 0.5 * ulp, 1.0), 1.0);
        assert_eq!(div(1.0 + 1.5 * ulp, 1.0), (1.0 + 2.0 * ulp) as f32);
        assert_eq!(div(-(1.0 + 0.5001 * ulp), 1.0), -(1.0 + ulp) as f32);
        assert_eq!(div(1.0, -3.0), -1.0 / 3.0);
        assert_eq!(div(0.0, 3.0), 0.0);
        assert_eq!(div(1e39, 1.0), f32::INFINITY);
        assert_eq!(div(1e-46, 1.0), 0.0);
        assert_eq!(div(1.2e-45, -1.0).to_bits(), (-f32::from_bits(1)).to_bits());
        assert_eq!(div(1e-46, -1.0).to_bits(), 0);
        // Just above a tie that f64 cannot see.
        let above_tie: Triple = value(1.0 + 0.5 * ulp).minus(&value(-1e-40));
        assert_eq!(divide_to_f32(&above_tie, &value(1.0)), 1.0f32.next_up());
    }

    #[test]
    fn the_last_midpoint_is_where_f32_overflows() {
        let last = midpoint(f32::MAX, f32::INFINITY);
        assert_eq!(last as f32, f32::INFINITY);
        assert_eq!(last.next_down() as f32, f32::MAX);
    }
}
