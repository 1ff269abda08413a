//! Measuring an integrator on a scene: error by samples, seconds by samples and structure.
//!
//! All structures give the same image, which is checked, so its error is found once. Seconds are
//! measured in rounds, in each of which all structures render the same image in turns, each time
//! starting with another one: whatever else the machine does slows all alike.

use std::time::Instant;

use octogrid::Structure;
use serde::Serialize;

use super::image::{Image, Reference, View};
use crate::failure::Failure;
use crate::integrators::Integrator;
use crate::report::fit;
use crate::report::statistics::Spread;

/// The error, relative to the mean luminance, whose time is told.
pub(super) const TARGET: f64 = 0.01;

/// How to measure.
pub(super) struct Plan {
    /// Samples a pixel of each image.
    pub(super) samples: Vec<u32>,
    pub(super) rounds: usize,
    pub(super) seed: u64,
}

/// An integrator on a scene.
#[derive(Serialize)]
pub(super) struct Measured {
    pub(super) scene: String,
    pub(super) integrator: String,
    pub(super) reference_samples: u32,
    /// Samples a pixel of each image.
    pub(super) samples: Vec<u32>,
    /// The error of each image, relative to the mean luminance.
    pub(super) rmse: Vec<f64>,
    /// The slope of error over samples; none where there is no error.
    pub(super) slope: Option<f64>,
    pub(super) curves: Vec<Curve>,
}

/// The seconds of one structure.
#[derive(Serialize)]
pub(super) struct Curve {
    pub(super) structure: String,
    /// Of each image, by round.
    pub(super) rounds: Vec<Vec<f64>>,
    /// Of each image.
    pub(super) seconds: Vec<Spread>,
    /// The slope of error over seconds, of each round.
    pub(super) slope: Option<Spread>,
    /// Seconds until the error is [`TARGET`] if from the longest run on it falls with the root of time.
    pub(super) to_target: Option<Spread>,
    /// The same relative to the first structure.
    pub(super) relative: Option<Spread>,
}

/// Measures.
///
/// # Errors
/// Where the integrator finds no lights, and where structures disagree.
pub(super) fn measure(
    views: &[(Structure, View)],
    name: &str,
    integrator: Integrator,
    reference: &Reference,
    plan: &Plan,
) -> Result<Measured, Failure> {
    let mut rounds = vec![vec![Vec::new(); plan.samples.len()]; views.len()];
    let mut rmse = Vec::new();
    for (i, &samples) in plan.samples.iter().enumerate() {
        let mut first: Option<Image> = None;
        for round in 0..plan.rounds {
            for turn in 0..views.len() {
                let at = (turn + round) % views.len();
                let start = Instant::now();
                let image = views[at].1.image(integrator, samples, plan.seed)?;
                rounds[at][i].push(start.elapsed().as_secs_f64());
                if *first.get_or_insert_with(|| image.clone()) != image {
                    return Err(Failure::Expected("the structures disagree on an image".into()));
                }
            }
        }
        rmse.extend(first.map(|image| reference.rmse(&image)));
    }
    let over_samples: Vec<_> = plan.samples.iter().map(|&n| f64::from(n)).zip(rmse.iter().copied()).collect();
    Ok(Measured {
        scene: name.to_owned(),
        integrator: integrator.to_string(),
        reference_samples: reference.samples,
        samples: plan.samples.clone(),
        slope: fit::slope(&over_samples),
        curves: curves(views, rounds, &rmse),
        rmse,
    })
}

/// `rounds` are seconds by structure, image and round.
fn curves(views: &[(Structure, View)], rounds: Vec<Vec<Vec<f64>>>, rmse: &[f64]) -> Vec<Curve> {
    let factor = rmse.last().map_or(0.0, |rmse| (rmse / TARGET).powi(2));
    let to_target = |rounds: &[Vec<f64>]| -> Vec<f64> {
        rounds.last().into_iter().flatten().map(|seconds| seconds * factor).collect()
    };
    let first = rounds.first().map_or(Vec::new(), |rounds| to_target(rounds));
    let curve = |(rounds, (structure, _)): (Vec<Vec<f64>>, &(Structure, View))| {
        let to_target = to_target(&rounds);
        Curve {
            structure: structure.to_string(),
            seconds: rounds.iter().filter_map(|seconds| Spread::of(seconds)).collect(),
            slope: Spread::of(&slopes(&rounds, rmse)),
            to_target: Spread::of(&to_target),
            relative: Spread::of_ratios(&to_target, &first),
            rounds,
        }
    };
    rounds.into_iter().zip(views).map(curve).collect()
}

/// The slope of error over seconds in each round.
fn slopes(seconds: &[Vec<f64>], rmse: &[f64]) -> Vec<f64> {
    let rounds = seconds.iter().map(Vec::len).min().unwrap_or(0);
    let slope = |round: usize| {
        let points: Vec<_> = seconds.iter().map(|s| s[round]).zip(rmse.iter().copied()).collect();
        fit::slope(&points)
    };
    (0..rounds).filter_map(slope).collect()
}
