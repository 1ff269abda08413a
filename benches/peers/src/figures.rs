//! From samples to the figures of a table.

use crate::clock::Elapsed;
use crate::measure::{Measured, Score, Trace};
use crate::statistics::Spread;

/// Rays of each set that make an image.
const IMAGE_RAYS: f64 = 1e6;
/// The sets that make an image, of `sets::all`.
const IMAGE_SETS: std::ops::Range<usize> = 0..3;

/// The figures of one contender on one scene. Seconds are the processor's with one thread, unless
/// they are named otherwise.
pub(crate) struct Figures {
    pub(crate) build: f64,
    /// Seconds by the clock of a build with two threads, the shortest: neighbours only add to it.
    pub(crate) build_of_two: Option<f64>,
    /// Bytes a triangle.
    pub(crate) held: f64,
    pub(crate) peak: f64,
    /// One for each set.
    pub(crate) sets: Vec<Option<Rate>>,
    /// Seconds to build and to trace the rays of an image.
    pub(crate) image: Option<f64>,
}

/// How fast a set was traced.
#[derive(Clone, Copy)]
pub(crate) struct Rate {
    /// Rays a second.
    pub(crate) rays: f64,
    /// That of the baseline divided into it, median over the rounds.
    pub(crate) ratio: f64,
    pub(crate) wrong: usize,
}

/// The figures of all contenders, the one numbered `baseline` being compared with.
pub(crate) fn of(measured: &Measured, baseline: usize) -> Vec<Figures> {
    let baseline = &measured.scores[baseline];
    measured.scores.iter().map(|score| figures(measured, score, baseline)).collect()
}

fn figures(measured: &Measured, score: &Score, baseline: &Score) -> Figures {
    let a_triangle = |bytes: usize| bytes as f64 / measured.triangles.max(1) as f64;
    let sets = measured.sets.iter().zip(score.traces.iter().zip(&baseline.traces));
    let sets: Vec<Option<Rate>> =
        sets.map(|(&(_, rays, _), (trace, other))| rate(rays, trace.as_ref()?, other.as_ref()?)).collect();
    let build = median(&score.builds, |sample| sample.cpu).unwrap_or(f64::NAN);
    let traced: Option<f64> =
        sets[IMAGE_SETS].iter().map(|rate| rate.map(|rate| IMAGE_RAYS / rate.rays)).sum();
    Figures {
        build,
        build_of_two: score.builds_of_two.iter().map(|sample| sample.wall).reduce(f64::min),
        held: a_triangle(score.bytes.held),
        peak: a_triangle(score.bytes.peak),
        sets,
        image: traced.map(|traced| build + traced),
    }
}

fn rate(rays: usize, trace: &Trace, baseline: &Trace) -> Option<Rate> {
    let cpu = |trace: &Trace| trace.times.iter().map(|sample| sample.cpu).collect::<Vec<_>>();
    let (own, other) = (cpu(trace), cpu(baseline));
    let seconds = Spread::of(&own).filter(|_| rays > 0)?.median;
    Some(Rate {
        rays: rays as f64 / seconds,
        ratio: Spread::of_ratios(&other, &own)?.median,
        wrong: trace.wrong,
    })
}

fn median(samples: &[Elapsed], of: impl Fn(&Elapsed) -> f64) -> Option<f64> {
    Some(Spread::of(&samples.iter().map(of).collect::<Vec<_>>())?.median)
}

/// The geometric mean; none of nothing.
pub(crate) fn geometric_mean(values: &[f64]) -> Option<f64> {
    let sum: f64 = values.iter().map(|value| value.ln()).sum();
    (!values.is_empty()).then(|| (sum / values.len() as f64).exp())
}
