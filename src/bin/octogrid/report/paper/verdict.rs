//! Whether figures bear a claim out.

use std::fmt;

use serde::Serialize;

use super::columns::{Column, Measure, find};
use crate::report::statistics::Spread;

/// Ratios this near to 1 are noise however small their spread.
const BAND: f64 = 0.03;

/// What figures say of a claim, from good to bad.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub(super) enum Verdict {
    #[serde(rename = "holds")]
    Holds,
    #[serde(rename = "within noise")]
    WithinNoise,
    #[serde(rename = "does not hold")]
    DoesNotHold,
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Holds => "holds",
            Self::WithinNoise => "within noise",
            Self::DoesNotHold => "does not hold",
        })
    }
}

/// What is claimed of a ratio.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Claim {
    /// Below 1.
    Less,
    /// At most 1, as far as can be told.
    NotMore,
}

impl Claim {
    /// Decides only where the whole interval lies beyond the band, so that another run, whose interval
    /// overlaps with this one, can't decide otherwise.
    pub(super) fn judge(self, ratio: &Spread) -> Verdict {
        let holds = match self {
            Self::Less => ratio.high < 1.0 - BAND,
            Self::NotMore => ratio.high <= 1.0 + BAND,
        };
        match holds {
            true => Verdict::Holds,
            false if ratio.low > 1.0 + BAND => Verdict::DoesNotHold,
            false => Verdict::WithinNoise,
        }
    }
}

/// A ratio and what it says.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Check {
    pub(super) scene: &'static str,
    pub(super) measure: Measure,
    pub(super) above: String,
    pub(super) claim: &'static str,
    pub(super) below: String,
    pub(super) ratio: Spread,
    pub(super) verdict: Verdict,
}

/// A claim on two structures; none where one of them has no figures.
pub(super) fn check(
    scene: &'static str,
    columns: &[Column],
    measure: Measure,
    above: &str,
    claim: Claim,
    below: &str,
) -> Option<Check> {
    let [a, b] = [find(columns, above)?, find(columns, below)?];
    let ratio = Spread::of_ratios(a.samples(measure), b.samples(measure))?;
    let sign = match claim {
        Claim::Less => "<",
        Claim::NotMore => "<=",
    };
    Some(Check {
        scene,
        measure,
        above: above.to_owned(),
        claim: sign,
        below: below.to_owned(),
        ratio,
        verdict: claim.judge(&ratio),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn judge(claim: Claim, low: f64, high: f64) -> Verdict {
        claim.judge(&Spread { median: f64::midpoint(low, high), low, high })
    }

    #[test]
    fn intervals_decide() {
        assert_eq!(judge(Claim::Less, 0.8, 0.9), Verdict::Holds);
        assert_eq!(judge(Claim::Less, 1.1, 1.2), Verdict::DoesNotHold);
        for (low, high) in [(0.5, 1.1), (0.9, 0.98), (0.99, 1.2), (1.02, 1.9)] {
            assert_eq!(judge(Claim::Less, low, high), Verdict::WithinNoise, "{low} {high}");
        }
        assert_eq!(judge(Claim::NotMore, 0.5, 1.02), Verdict::Holds);
        assert_eq!(judge(Claim::NotMore, 0.9, 1.1), Verdict::WithinNoise);
        assert_eq!(judge(Claim::NotMore, 1.04, 1.1), Verdict::DoesNotHold);
    }
}
