//! Measuring all kernels on all structures, in turns.
//!
//! A round leads every structure and on it every kernel through the same rays, on one thread, each time
//! starting with another one. Ratios are taken within a round.

use std::time::Instant;

use octogrid::{Closest, Hit, Kernel, Ray, Scene, Structure};
use serde::{Serialize, Serializer};

use super::errors::{Errors, Summary};
use super::rays::Set;
use super::truth::Truth;
use super::variants;
use crate::report::statistics::Spread;

/// The name of all sets together.
pub(super) const ALL: &str = "all";

/// A kernel on a structure and a set of rays.
#[derive(Serialize)]
pub(super) struct Point {
    pub(super) set: &'static str,
    #[serde(serialize_with = "kernel")]
    pub(super) kernel: Kernel,
    #[serde(serialize_with = "structure")]
    pub(super) structure: Structure,
    /// What one gets without asking.
    pub(super) default: bool,
    /// Nanoseconds a ray on one thread.
    pub(super) ns: Option<Spread>,
    /// The same relative to the plain kernel on the same structure.
    pub(super) to_plain: Option<Spread>,
    #[serde(flatten)]
    pub(super) errors: Summary,
}

fn kernel<S: Serializer>(kernel: &Kernel, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(&variants::name(*kernel))
}

fn structure<S: Serializer>(structure: &Structure, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(structure)
}

/// A kernel on a structure: seconds by set and round, and errors by set.
struct Variant<'a> {
    kernel: Kernel,
    scene: &'a Scene,
    seconds: Vec<Vec<f64>>,
    errors: Vec<Errors>,
}

/// The points of each set, then those of all sets together.
pub(super) fn measure(scenes: &[Scene], sets: &[(Set, Vec<Truth>)], rounds: usize) -> Vec<Point> {
    let of =
        |scene| Kernel::ALL.map(|kernel| Variant { kernel, scene, seconds: Vec::new(), errors: Vec::new() });
    let mut variants: Vec<Variant> = scenes.iter().flat_map(of).collect();
    for (set, truths) in sets {
        let mut hits = vec![Hit::MISS; set.rays.len()];
        for variant in &mut variants {
            let mut errors = Errors::default();
            trace(variant.scene, variant.kernel, &set.rays, &mut hits);
            errors.add(truths, &hits);
            variant.errors.push(errors);
            variant.seconds.push(Vec::new());
        }
        for round in 0..rounds {
            for turn in 0..variants.len() {
                let at = (turn + round * Kernel::ALL.len()) % variants.len();
                let variant = &mut variants[at];
                let seconds = trace(variant.scene, variant.kernel, &set.rays, &mut hits);
                variant.seconds.last_mut().into_iter().for_each(|rounds| rounds.push(seconds));
            }
        }
    }
    let mut points: Vec<Point> = Vec::new();
    for (i, (set, _)) in sets.iter().enumerate() {
        points.extend(self::points(&variants, set.name, i..i + 1));
    }
    points.extend(self::points(&variants, ALL, 0..sets.len()));
    points
}

/// Seconds for the closest hits of all rays.
fn trace(scene: &Scene, kernel: Kernel, rays: &[Ray], hits: &mut [Hit]) -> f64 {
    let start = Instant::now();
    for (ray, hit) in rays.iter().zip(hits) {
        let mut query = Closest::new(ray.t_max);
        scene.query_with(kernel, ray, &mut query);
        *hit = query.hit();
    }
    start.elapsed().as_secs_f64()
}

/// One point a variant, over some of the sets.
fn points(variants: &[Variant], set: &'static str, sets: std::ops::Range<usize>) -> Vec<Point> {
    let seconds = |variant: &Variant| -> Vec<f64> {
        let of = &variant.seconds[sets.clone()];
        let rounds = of.first().map_or(0, Vec::len);
        (0..rounds).map(|round| of.iter().map(|seconds| seconds[round]).sum()).collect()
    };
    let point = |variant: &Variant| {
        let mut errors = Errors::default();
        variant.errors[sets.clone()].iter().for_each(|of_set| errors.merge(of_set));
        let errors = errors.summary();
        let own = seconds(variant);
        let same = |v: &&Variant| std::ptr::eq(v.scene, variant.scene) && v.kernel == Kernel::Plain;
        let ns: Vec<f64> = own.iter().map(|s| s * 1e9 / errors.rays.max(1) as f64).collect();
        let structure = variant.scene.structure();
        Point {
            set,
            kernel: variant.kernel,
            structure,
            default: variants::is_default(variant.kernel, structure),
            ns: Spread::of(&ns),
            to_plain: variants.iter().find(same).and_then(|plain| Spread::of_ratios(&own, &seconds(plain))),
            errors,
        }
    };
    variants.iter().map(point).collect()
}
