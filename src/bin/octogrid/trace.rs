//! `octogrid trace`: rays of a file against a scene, hits to a file.

use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::ValueEnum;
use octogrid::{BuildOptions, Model, Ray, Scene};
use serde::Serialize;

use crate::answer::Answer;
use crate::args::{BuildArgs, Choice};
use crate::failure::Failure;
use crate::npy;
use crate::output::{Output, say};
use crate::pool::ThreadArgs;
use crate::{load, saved, table};

/// Trace the rays of a NumPy file and write their hits
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// An OBJ file, the name of a built-in scene, or a file of octogrid build
    scene: String,
    /// The rays: float32, shape (n, 8): ox oy oz t_min dx dy dz t_max
    #[arg(long, value_name = "FILE.npy")]
    rays: PathBuf,
    /// What to ask
    #[arg(long, value_enum)]
    query: Question,
    /// Where the hits go
    #[arg(long, value_name = "FILE.npy")]
    hits: PathBuf,
    /// The voxel structure
    #[arg(long, value_enum, default_value = "auto")]
    structure: Choice,
    #[command(flatten)]
    build: BuildArgs,
    #[command(flatten)]
    threads: ThreadArgs,
    /// Ask this many times, and report the best and the median time
    #[arg(long, value_name = "K", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    repeat: u32,
    /// Print one JSON object instead of a table
    #[arg(long)]
    json: bool,
}

/// The values of `--query`.
#[derive(Clone, Copy, Debug, Serialize, ValueEnum)]
#[serde(rename_all = "lowercase")]
enum Question {
    /// The first hit of each ray
    Closest,
    /// Whether a ray hits anything
    Any,
    /// Every hit of each ray, along the ray
    All,
}

/// What a run reports; times hold the queries alone.
#[derive(Serialize)]
struct Report {
    scene: String,
    triangles: usize,
    structure: &'static str,
    build_ms: f64,
    /// Of a structure that was built before.
    #[serde(skip_serializing_if = "Option::is_none")]
    load_ms: Option<f64>,
    bytes_per_triangle: f64,
    query: Question,
    rays: usize,
    hits: usize,
    threads: usize,
    best_s: f64,
    median_s: f64,
    mrays_per_s: f64,
}

/// A scene, and how long it took to have it.
struct Ready {
    scene: Scene,
    build_ms: f64,
    load_ms: Option<f64>,
}

impl Ready {
    fn build(model: &Model, options: &BuildOptions) -> Result<Self, Failure> {
        let (scene, build_ms) = load::build(model, options)?;
        Ok(Self { scene, build_ms, load_ms: None })
    }

    fn load(path: &Path) -> Result<Self, Failure> {
        let (scene, load_ms) = saved::load(path)?;
        Ok(Self { scene, build_ms: 0.0, load_ms: Some(load_ms) })
    }
}

/// Runs the command.
///
/// # Errors
/// On wrong parameters, on files that can't be read or written, and where the build fails.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let options = args.build.options(args.structure)?;
    let is_built = saved::is_named(Path::new(&args.scene));
    if is_built && !(args.structure == Choice::Auto && args.build.is_empty()) {
        let these = "--structure, --params, --force, --quality and --memory-limit";
        let why = format!("{} is built already: leave {these} to octogrid build", args.scene);
        return Err(Failure::Usage(why));
    }
    let output = Output::at(&args.hits)?;
    let model = if is_built { None } else { Some(load::load(&args.scene)?.model) };
    let rays = read_rays(&args.rays)?;
    let (report, answer) = args.threads.run(|| {
        let ready = match &model {
            Some(model) => {
                let asked = rays.len() * args.repeat as usize;
                Ready::build(model, &args.build.for_rays(&options, asked, model))?
            }
            None => Ready::load(Path::new(&args.scene))?,
        };
        let (answer, seconds) = ask(&ready.scene, &rays, args.query, args.repeat);
        Ok((report(args, &ready, rays.len(), &answer, &seconds), answer))
    })?;
    output.write(|file| answer.write(file))?;
    if args.json {
        let json = serde_json::to_string(&report);
        return say(json.map_err(|e| Failure::Expected(e.to_string()))?);
    }
    say(summary(&report))
}

/// Reads the rays.
///
/// # Errors
/// Where the file can't be read or holds something else.
fn read_rays(path: &Path) -> Result<Vec<Ray>, Failure> {
    let file = File::open(path).map_err(|e| Failure::at(path, e))?;
    npy::read_rays(&mut BufReader::with_capacity(1 << 20, file)).map_err(|e| Failure::at(path, e))
}

/// The answer, and the sorted seconds of each repetition.
fn ask(scene: &Scene, rays: &[Ray], question: Question, repeat: u32) -> (Answer, Vec<f64>) {
    let mut answer = match question {
        Question::Closest => Answer::closest(rays.len()),
        Question::Any => Answer::any(rays.len()),
        Question::All => Answer::all(),
    };
    let mut seconds = Vec::new();
    for _ in 0..repeat {
        let start = Instant::now();
        answer.ask(scene, rays);
        seconds.push(start.elapsed().as_secs_f64());
    }
    seconds.sort_by(f64::total_cmp);
    (answer, seconds)
}

fn report(args: &Args, ready: &Ready, rays: usize, answer: &Answer, seconds: &[f64]) -> Report {
    let median_s = (seconds[(seconds.len() - 1) / 2] + seconds[seconds.len() / 2]) / 2.0;
    Report {
        scene: args.scene.clone(),
        triangles: ready.scene.triangles(),
        structure: ready.scene.structure().name(),
        build_ms: ready.build_ms,
        load_ms: ready.load_ms,
        bytes_per_triangle: load::bytes_per_triangle(&ready.scene),
        query: args.query,
        rays,
        hits: answer.hits(),
        threads: rayon::current_num_threads(),
        best_s: seconds[0],
        median_s,
        mrays_per_s: if median_s > 0.0 { rays as f64 / median_s / 1e6 } else { 0.0 },
    }
}

fn summary(report: &Report) -> impl std::fmt::Display + use<> {
    table::pairs([
        ("scene", report.scene.clone()),
        ("triangles", report.triangles.to_string()),
        ("structure", report.structure.to_owned()),
        match report.load_ms {
            Some(ms) => ("load, ms", format!("{ms:.2}")),
            None => ("build, ms", format!("{:.2}", report.build_ms)),
        },
        ("bytes a triangle", format!("{:.1}", report.bytes_per_triangle)),
        ("query", format!("{:?}", report.query).to_lowercase()),
        ("rays", report.rays.to_string()),
        ("hits", report.hits.to_string()),
        ("threads", report.threads.to_string()),
        ("best, s", format!("{:.6}", report.best_s)),
        ("median, s", format!("{:.6}", report.median_s)),
        ("Mray/s", format!("{:.3}", report.mrays_per_s)),
    ])
}
