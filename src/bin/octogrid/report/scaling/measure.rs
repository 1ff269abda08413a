//! Measuring all scenes in all sizes, in turns.
//!
//! A round leads every scene in every size through a build and the closest hits of the same rays, on one
//! thread and on all, each time starting with the other. Ratios are taken within a round.

use std::time::Instant;

use octogrid::{BuildOptions, Hit, Model, Ray, Rng};
use rayon::ThreadPool;
use serde::Serialize;

use crate::failure::Failure;
use crate::frame::each_band;
use crate::report::statistics::Spread;
use crate::{load, pool, survey};

/// A scene in one size, and the rays that it is asked for.
pub(super) struct Case {
    scene: String,
    model: Model,
    rays: Vec<Ray>,
}

impl Case {
    /// With `n` rays from anywhere in the box around the model, in any direction.
    pub(super) fn new(scene: &str, model: Model, n: usize, seed: u64) -> Self {
        let (low, high) = survey::bounds(&model).unwrap_or_default();
        let mut rng = Rng::new(seed);
        let ray = |_| {
            let origin = low + (high - low) * (0.5 * rng.in_cube() + 0.5);
            Ray::new(origin.as_vec3(), rng.on_sphere().as_vec3())
        };
        let rays = (0..n).map(ray).collect();
        Self { scene: scene.to_owned(), model, rays }
    }
}

/// A scene in one size.
#[derive(Serialize)]
pub(super) struct Point {
    pub(super) scene: String,
    pub(super) triangles: usize,
    pub(super) bytes_a_triangle: f64,
    /// Of a triangle.
    pub(super) build: Cost,
    /// Of a ray.
    pub(super) trace: Cost,
}

/// The time of one of many.
#[derive(Serialize)]
pub(super) struct Cost {
    /// Nanoseconds on one thread.
    pub(super) ns: Option<Spread>,
    /// The time on one thread relative to that on all.
    pub(super) speedup: Option<Spread>,
}

impl Cost {
    /// `seconds` for `n`, on one thread and on all, by round.
    fn new(seconds: &[Vec<f64>; 2], n: usize) -> Self {
        let ns: Vec<f64> = seconds[0].iter().map(|s| s * 1e9 / n as f64).collect();
        Self { ns: Spread::of(&ns), speedup: Spread::of_ratios(&seconds[0], &seconds[1]) }
    }
}

/// What the rounds of one case gave: seconds on one thread and on all, by round.
#[derive(Default)]
struct Samples {
    build: [Vec<f64>; 2],
    trace: [Vec<f64>; 2],
    bytes_a_triangle: f64,
    hits: Vec<Hit>,
}

/// Measures all cases on one thread and on as many as the current pool has.
///
/// # Errors
/// Where a build fails, and where numbers of threads disagree.
pub(super) fn measure(cases: &[Case], rounds: usize) -> Result<Vec<Point>, Failure> {
    let pools = [pool::of(1)?, pool::of(rayon::current_num_threads())?];
    let mut samples: Vec<Samples> = cases.iter().map(|_| Samples::default()).collect();
    let mut done = Ok(());
    each_band(rounds * cases.len(), 1, |at| {
        let (round, case) = (at.start / cases.len(), at.start % cases.len());
        for turn in 0..2 {
            if done.is_ok() {
                done = samples[case].add(&cases[case], &pools, (round + turn) % 2);
            }
        }
    });
    done?;
    Ok(cases.iter().zip(samples).map(point).collect())
}

impl Samples {
    /// Builds and traces on one of the pools.
    fn add(&mut self, case: &Case, pools: &[ThreadPool; 2], at: usize) -> Result<(), Failure> {
        pools[at].install(|| {
            let (scene, ms) = load::build(&case.model, &BuildOptions::default())?;
            let mut hits = vec![Hit::MISS; case.rays.len()];
            let start = Instant::now();
            scene.closest_batch(&case.rays, &mut hits);
            self.trace[at].push(start.elapsed().as_secs_f64());
            self.build[at].push(ms / 1e3);
            self.bytes_a_triangle = load::bytes_per_triangle(&scene);
            if self.hits.is_empty() {
                self.hits = hits;
            } else if self.hits != hits {
                return Err(Failure::Expected("the numbers of threads disagree on a hit".into()));
            }
            Ok(())
        })
    }
}

fn point((case, samples): (&Case, Samples)) -> Point {
    let triangles = case.model.triangles.len();
    Point {
        scene: case.scene.clone(),
        triangles,
        bytes_a_triangle: samples.bytes_a_triangle,
        build: Cost::new(&samples.build, triangles),
        trace: Cost::new(&samples.trace, case.rays.len()),
    }
}
