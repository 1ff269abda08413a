//! Medians, and intervals that hold them.

use serde::Serialize;

/// An interval holds the true median with at least this probability, where there are enough samples.
const CONFIDENCE: f64 = 0.9;

/// A median with its confidence interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(super) struct Spread {
    pub(super) median: f64,
    pub(super) low: f64,
    pub(super) high: f64,
}

impl Spread {
    /// Of samples in any order; none where there are no samples.
    ///
    /// The interval runs between two order statistics: n samples leave the true median below the k-th
    /// of them with the probability that n fair coins show heads less than k times. No normal
    /// distribution is assumed, and outliers do no harm.
    pub(super) fn of(samples: &[f64]) -> Option<Self> {
        let mut sorted = samples.to_vec();
        sorted.sort_by(f64::total_cmp);
        let last = sorted.len().checked_sub(1)?;
        let skip = skipped(sorted.len());
        let median = (sorted[last / 2] + sorted[sorted.len() / 2]) / 2.0;
        Some(Self { median, low: sorted[skip], high: sorted[last - skip] })
    }

    /// Of the ratios of samples taken in the same rounds.
    pub(super) fn of_ratios(above: &[f64], below: &[f64]) -> Option<Self> {
        Self::of(&above.iter().zip(below).map(|(a, b)| a / b).collect::<Vec<_>>())
    }
}

/// How many samples to leave out on each side of the interval.
fn skipped(samples: usize) -> usize {
    let (mut skip, mut outside, mut chance) = (0, 0.0, 0.5f64.powi(samples as i32));
    loop {
        // `chance` is that of exactly `skip` heads, `outside` that of fewer.
        outside += chance;
        chance *= (samples - skip) as f64 / (skip + 1) as f64;
        if skip + 1 > samples / 2 || 1.0 - 2.0 * (outside + chance) < CONFIDENCE {
            return skip;
        }
        skip += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_hold_the_median_with_the_confidence() {
        // 1 - 2 P(fewer than k heads of n): 0.9375 for (5, 1), 0.93 for (8, 2), 0.96 for (9, 2).
        assert_eq!([1, 2, 5, 7, 8, 9].map(skipped), [0, 0, 0, 0, 1, 1]);
        let spread = Spread::of(&[9.0, 1.0, 2.0, 90.0, 4.0, 3.0, 5.0, 6.0, 0.0]).unwrap();
        assert_eq!((spread.median, spread.low, spread.high), (4.0, 1.0, 9.0));
        assert_eq!(Spread::of(&[1.0, 2.0]).unwrap().median, 1.5);
        assert_eq!(Spread::of(&[]), None);
    }

    #[test]
    fn ratios_are_paired() {
        let spread = Spread::of_ratios(&[2.0, 20.0, 8.0], &[1.0, 10.0, 4.0]).unwrap();
        assert_eq!((spread.low, spread.high), (2.0, 2.0));
    }
}
