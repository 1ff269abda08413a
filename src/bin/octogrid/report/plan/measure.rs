//! Measuring the variants of a scene, in turns, on one thread.

use std::time::Instant;

use octogrid::{Any, Closest, Counting, Counts, Query, Ray, Scene, SceneProfile};
use serde::{Serialize, Serializer};

use super::count;
use super::rays::{Rays, SHADOW, trace, trace_stream};
use super::variants::{Kind, Variant, variants};
use crate::answer::Answer;
use crate::failure::Failure;
use crate::load::{self, Loaded};
use crate::report::statistics::Spread;

/// Figures of one variant of one scene.
#[derive(Serialize)]
pub(super) struct Point {
    pub(super) scene: String,
    pub(super) triangles: usize,
    pub(super) variant: String,
    pub(super) structure: String,
    #[serde(serialize_with = "kind")]
    pub(super) kind: Kind,
    pub(super) bytes_a_triangle: f64,
    pub(super) build_ms: Option<Spread>,
    /// By kind of ray, asked one after the other; none where there are no rays.
    pub(super) ns_a_ray: [Option<Spread>; 3],
    /// The same asked as a stream.
    pub(super) stream_ns_a_ray: [Option<Spread>; 3],
    pub(super) clusters_a_ray: f64,
    pub(super) cache_lines_a_ray: f64,
    pub(super) instructions_a_ray: Option<f64>,
}

fn kind<S: Serializer>(kind: &Kind, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(match kind {
        Kind::Plan => "plan",
        Kind::All => "all",
        Kind::Flipped(..) => "part",
        Kind::Fast => "fast",
        Kind::Structure => "structure",
    })
}

impl Point {
    /// Milliseconds from triangles to an image of `n` rays of each kind, asked as streams, as `render` asks them.
    pub(super) fn image_ms(&self, n: f64) -> f64 {
        let build = self.build_ms.map_or(0.0, |spread| spread.median);
        build + n * sum(&self.stream_ns_a_ray) / 1e6
    }

    /// Nanoseconds of a ray of each kind together, asked one after the other.
    pub(super) fn ns(&self) -> f64 {
        sum(&self.ns_a_ray)
    }

    /// Instructions a ray, or cluster tests and cache lines where they could not be counted.
    pub(super) fn work(&self) -> f64 {
        self.instructions_a_ray.unwrap_or(self.clusters_a_ray + self.cache_lines_a_ray)
    }
}

/// The sum of the medians.
fn sum(spreads: &[Option<Spread>; 3]) -> f64 {
    spreads.iter().flatten().map(|spread| spread.median).sum()
}

/// What rounds gave.
#[derive(Default)]
struct Samples {
    build_ms: Vec<f64>,
    ns: [Vec<f64>; 3],
    stream_ns: [Vec<f64>; 3],
}

/// Measures the variants of a scene; none of a scene without triangles.
///
/// # Errors
/// Where a build fails, and where variants disagree.
pub(super) fn measure(loaded: &Loaded, rays: u32, rounds: u16) -> Result<Vec<Point>, Failure> {
    let profile = SceneProfile::new(&loaded.model.mesh()?);
    if profile.triangles == 0 {
        return Ok(Vec::new());
    }
    let variants = variants(&profile);
    let mut scenes = Vec::new();
    for variant in &variants {
        scenes.push(load::build(&loaded.model, &variant.options)?.0);
    }
    let image = Rays::new(loaded, &scenes[0], rays as usize);
    let mut room = image.answers();
    let mut samples: Vec<Samples> = variants.iter().map(|_| Samples::default()).collect();
    for round in 0..usize::from(rounds) {
        let mut answers = None;
        for turn in 0..variants.len() {
            let at = (round + turn) % variants.len();
            let (scene, ms) = load::build(&loaded.model, &variants[at].options)?;
            samples[at].build_ms.push(ms);
            for answer in samples[at].trace(&scene, &image, &mut room) {
                if *answers.get_or_insert(answer) != answer {
                    let name = &variants[at].name;
                    return Err(Failure::Expected(format!("{}: {name} disagrees on a hit", loaded.name)));
                }
            }
        }
    }
    let instructions = count::instructions(&loaded.name, &variants, rays);
    let all = variants.iter().zip(&scenes).zip(&samples).zip(instructions);
    let point = |(((variant, scene), samples), instructions)| {
        point(loaded, variant, scene, samples, &image, instructions)
    };
    Ok(all.map(point).collect())
}

impl Samples {
    /// Traces all rays, one after the other and as streams; of either a number that depends on all answers.
    fn trace(&mut self, scene: &Scene, image: &Rays, room: &mut [Answer]) -> [u64; 2] {
        let mut sums = [0u64; 2];
        for (kind, rays) in image.kinds().enumerate().filter(|(_, rays)| !rays.is_empty()) {
            let (single, ns) = timed(rays.len(), || trace(scene, kind, rays));
            self.ns[kind].push(ns);
            let (stream, ns) = timed(rays.len(), || trace_stream(scene, rays, &mut room[kind]));
            self.stream_ns[kind].push(ns);
            sums =
                [(sums[0], single), (sums[1], stream)].map(|(sum, n)| sum.wrapping_mul(31).wrapping_add(n));
        }
        sums
    }
}

/// What `trace` gives, and nanoseconds that it takes for each of `n` rays.
fn timed(n: usize, trace: impl FnOnce() -> u64) -> (u64, f64) {
    let start = Instant::now();
    let answer = trace();
    (answer, start.elapsed().as_secs_f64() * 1e9 / n as f64)
}

fn point(
    loaded: &Loaded,
    variant: &Variant,
    scene: &Scene,
    samples: &Samples,
    image: &Rays,
    instructions: Option<u64>,
) -> Point {
    let counts = work(scene, image);
    let a_ray = |n: u64| n as f64 / image.len() as f64;
    Point {
        scene: loaded.name.clone(),
        triangles: scene.triangles(),
        variant: variant.name.clone(),
        structure: scene.structure().to_string(),
        kind: variant.kind,
        bytes_a_triangle: load::bytes_per_triangle(scene),
        build_ms: Spread::of(&samples.build_ms),
        ns_a_ray: samples.ns.each_ref().map(|ns| Spread::of(ns)),
        stream_ns_a_ray: samples.stream_ns.each_ref().map(|ns| Spread::of(ns)),
        clusters_a_ray: a_ray(counts.clusters),
        cache_lines_a_ray: a_ray(counts.cache_lines),
        instructions_a_ray: instructions.map(a_ray),
    }
}

/// The work of all rays.
fn work(scene: &Scene, image: &Rays) -> Counts {
    fn counted(scene: &Scene, ray: &Ray, query: impl Query) -> Counts {
        let mut query = Counting::new(query);
        scene.query(ray, &mut query);
        query.counts()
    }
    let mut counts = Counts::default();
    for (kind, rays) in image.kinds().enumerate() {
        for ray in rays {
            counts += match kind {
                SHADOW => counted(scene, ray, Any::new(ray.t_max)),
                _ => counted(scene, ray, Closest::new(ray.t_max)),
            };
        }
    }
    counts
}
