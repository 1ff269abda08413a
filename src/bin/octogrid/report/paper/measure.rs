//! Measuring structures on a scene, in turns.
//!
//! Whatever else the machine does slows all structures alike: each round leads every structure
//! through the first piece of the rays, then through the second, and so on, each time starting with
//! another one. Ratios are taken within a round.

use std::time::Instant;

use octogrid::{Cluster, Model, Scene, Structure};
use serde::Serialize;

use super::columns::{Column, Measure, octree, structures};
use super::rays::Rays;
use crate::failure::Failure;
use crate::load::{self, Loaded};
use crate::report::statistics::Spread;

/// Pieces of the rays.
const PIECES: usize = 8;
/// Rounds of builds, at most.
const BUILDS: usize = 5;
/// The highest threshold of an octree that knows no planes: what O\[4,15\] keeps of one plane.
const MOST_BLIND: u32 = 64;

/// All that was measured on a scene.
#[derive(Serialize)]
pub(super) struct Measured {
    pub(super) scene: &'static str,
    pub(super) triangles: usize,
    pub(super) primary_rays: usize,
    pub(super) shadow_rays: usize,
    /// Those that were traced in each round; the times are extrapolated to all.
    pub(super) traced_primary_rays: usize,
    pub(super) traced_shadow_rays: usize,
    /// The name of the octree that knows no planes and holds as much memory as O\[4,15\].
    pub(super) blind: String,
    pub(super) columns: Vec<Column>,
    /// Voxels, clusters and cache lines a ray, by structure.
    pub(super) work: Vec<[f64; 3]>,
}

impl Measured {
    /// Rays of both kinds of an image.
    pub(super) fn rays(&self) -> usize {
        self.primary_rays + self.shadow_rays
    }

    pub(super) fn spread(&self, column: &Column, measure: Measure) -> Option<Spread> {
        Spread::of(column.samples(measure))
    }
}

/// Builds and traces all structures.
///
/// # Errors
/// Where a build fails, and where structures disagree.
pub(super) fn measure(
    name: &'static str,
    loaded: &Loaded,
    rays: &Rays,
    rounds: usize,
) -> Result<Measured, Failure> {
    let model = &loaded.model;
    let mut structures = structures();
    let blind = equal_memory(model)?;
    if !structures.contains(&blind) {
        structures.push(blind);
    }
    let (scenes, preprocessing) = build(model, &structures, rounds.min(BUILDS))?;
    let rendering = render(&scenes, rays, rounds)?;
    let mut columns = Vec::new();
    for ((scene, rendering), preprocessing) in scenes.iter().zip(rendering).zip(preprocessing) {
        let structure = scene.structure().to_string();
        columns.push(Column { structure, rendering, memory: vec![kilobytes(scene)?], preprocessing });
    }
    Ok(Measured {
        scene: name,
        triangles: model.triangles.len(),
        primary_rays: rays.primary.total,
        shadow_rays: rays.shadow.total,
        traced_primary_rays: rays.primary.rays.len(),
        traced_shadow_rays: rays.shadow.rays.len(),
        blind: blind.to_string(),
        columns,
        work: scenes.iter().map(|scene| rays.work(scene)).collect(),
    })
}

/// The octree without planes whose memory is nearest to that of O\[4,15\], by bisection.
fn equal_memory(model: &Model) -> Result<Structure, Failure> {
    let bytes = |structure| built(model, structure).map(|(scene, _)| scene.bytes());
    let target = bytes(Structure::OCTREE)?;
    let (mut low, mut high) = (1, MOST_BLIND);
    while high - low > 1 {
        let middle = u32::midpoint(low, high);
        // Memory falls as the threshold rises.
        if bytes(octree(middle, 0))? > target {
            low = middle;
        } else {
            high = middle;
        }
    }
    let nearer = bytes(octree(low, 0))?.abs_diff(target) < bytes(octree(high, 0))?.abs_diff(target);
    Ok(octree(if nearer { low } else { high }, 0))
}

/// A scene and the seconds that its build took.
pub(super) fn built(model: &Model, structure: Structure) -> Result<(Scene, f64), Failure> {
    let (scene, ms) = load::build(model, &structure.into())?;
    Ok((scene, ms / 1e3))
}

/// The voxels' memory; the paper's figures can't hold the triangles either, being smaller than them.
pub(super) fn kilobytes(scene: &Scene) -> Result<f64, Failure> {
    let parts = scene.validate().map_err(|violation| Failure::Expected(violation.to_string()))?;
    Ok((scene.bytes() - parts.clusters * size_of::<Cluster>()) as f64 / 1024.0)
}

/// The scenes, and for each the seconds of each round.
fn build(
    model: &Model,
    structures: &[Structure],
    rounds: usize,
) -> Result<(Vec<Scene>, Vec<Vec<f64>>), Failure> {
    let mut seconds = vec![Vec::new(); structures.len()];
    let mut scenes = Vec::new();
    for round in 0..rounds {
        for (&structure, seconds) in structures.iter().zip(&mut seconds) {
            let (scene, taken) = built(model, structure)?;
            seconds.push(taken);
            if round == 0 {
                scenes.push(scene);
            }
        }
    }
    Ok((scenes, seconds))
}

/// For each scene the seconds of a whole image, by round.
fn render(scenes: &[Scene], rays: &Rays, rounds: usize) -> Result<Vec<Vec<f64>>, Failure> {
    let mut seconds = vec![vec![0.0; rounds]; scenes.len()];
    for round in 0..rounds {
        for piece in 0..PIECES {
            let mut answers = Vec::new();
            for turn in 0..scenes.len() {
                let at = (turn + round + piece) % scenes.len();
                let (answer, taken) = trace(&scenes[at], rays, piece);
                seconds[at][round] += taken;
                answers.push(answer);
            }
            if answers.iter().any(|answer| *answer != answers[0]) {
                return Err(Failure::Expected("the structures disagree on a hit".into()));
            }
        }
    }
    Ok(seconds)
}

/// The answers to a piece of the rays, and the seconds of the part of the image that it stands for.
fn trace(scene: &Scene, rays: &Rays, piece: usize) -> ([u64; 2], f64) {
    let start = Instant::now();
    let primary = rays.trace_primary(scene, piece, PIECES);
    let between = Instant::now();
    let shadow = rays.trace_shadow(scene, piece, PIECES);
    let taken = [between - start, between.elapsed()].map(|duration| duration.as_secs_f64());
    ([primary, shadow], taken[0] * rays.primary.factor() + taken[1] * rays.shadow.factor())
}
