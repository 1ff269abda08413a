//! `octogrid report paper --sweep`: the best parameters of each structure on a scene.

use std::time::Instant;

use octogrid::{BuildError, BuildOptions, HybridParams, Model, Scene, Structure, UniformParams};
use serde::Serialize;

use super::columns::{octree, recursive};
use super::measure::{built, kilobytes};
use super::rays::Rays;
use super::tables::digits;
use crate::failure::Failure;
use crate::output::say;
use crate::report::folder::{Folder, stem};
use crate::report::machine::Machine;
use crate::report::plot::{Labels, Scale, Series};
use crate::report::statistics::Spread;
use crate::{load, table};

/// Rays of each kind traced a point, at most.
const TRACED: usize = 1 << 16;
/// The least time of so many runs counts at first.
const RUNS: usize = 3;
/// So many of the fastest of each structure are measured once more, in turns.
const FINALISTS: usize = 4;
const ROUNDS: usize = 5;
/// From this many triangles on every other point is left out, to stay within minutes.
const LARGE: usize = 200_000;
/// A point that needs more is left out.
const MEMORY_LIMIT: usize = 2 << 30;

/// A structure with what it takes.
#[derive(Serialize)]
struct Point {
    family: &'static str,
    structure: String,
    #[serde(skip)]
    parameters: Structure,
    /// Seconds of the queries of a whole image.
    rendering: f64,
    /// Whether these are the median of interleaved rounds.
    finalist: bool,
    /// Kilobytes of the voxels.
    memory: f64,
    /// Seconds of the build.
    preprocessing: f64,
}

/// What is written on a scene.
#[derive(Serialize)]
struct Sweep<'a> {
    scene: &'a str,
    triangles: usize,
    rays: usize,
    points: &'a [Point],
    best: Vec<&'a Point>,
}

/// Sweeps scene after scene.
///
/// # Errors
/// Where a scene can't be read or the folder not be written.
pub(super) fn run(scenes: &[String], size: [u32; 2], folder: &Folder) -> Result<(), Failure> {
    for (i, name) in scenes.iter().enumerate() {
        let loaded = load::load(name)?;
        let rays = Rays::new(&loaded, size, TRACED)?;
        let mut points = points(&loaded.model, &rays)?;
        for family in Structure::ALL.map(|structure| structure.name()) {
            finals(&loaded.model, &rays, family, &mut points)?;
        }
        let (triangles, rays) = (loaded.model.triangles.len(), rays.total());
        let sweep = Sweep { scene: name, triangles, rays, points: &points, best: best(&points) };
        say(format_args!("{}{}", if i > 0 { "\n" } else { "" }, summary(&sweep)))?;
        write(folder, &sweep)?;
    }
    say(format_args!("\nplots and figures are in {}", folder.path().display()))
}

/// All points that can be built.
fn points(model: &Model, rays: &Rays) -> Result<Vec<Point>, Failure> {
    let step = if model.triangles.len() > LARGE { 2 } else { 1 };
    let mut points = Vec::new();
    for structure in grid().into_iter().step_by(step) {
        let options =
            BuildOptions { structure: Some(structure), memory_limit: MEMORY_LIMIT, ..Default::default() };
        let start = Instant::now();
        match Scene::build(&model.mesh()?, &options) {
            Ok(scene) => points.push(Point {
                family: structure.name(),
                structure: structure.to_string(),
                parameters: structure,
                finalist: false,
                preprocessing: start.elapsed().as_secs_f64(),
                memory: kilobytes(&scene)?,
                rendering: (0..RUNS).map(|_| render(&scene, rays)).fold(f64::INFINITY, f64::min),
            }),
            Err(BuildError::MemoryLimit { .. } | BuildError::TooLarge { .. }) => {}
            Err(error) => return Err(error.into()),
        }
    }
    Ok(points)
}

/// Measures the fastest points of a structure again, in turns, so that noise favours none of them.
fn finals(model: &Model, rays: &Rays, family: &str, points: &mut [Point]) -> Result<(), Failure> {
    let mut finalists: Vec<&mut Point> = points.iter_mut().filter(|p| p.family == family).collect();
    finalists.sort_by(|a, b| a.rendering.total_cmp(&b.rendering));
    finalists.truncate(FINALISTS);
    let built = finalists.iter().map(|point| built(model, point.parameters));
    let scenes: Vec<Scene> = built.map(|scene| Ok(scene?.0)).collect::<Result<_, Failure>>()?;
    let mut seconds = vec![Vec::new(); scenes.len()];
    for _ in 0..ROUNDS {
        for (scene, seconds) in scenes.iter().zip(&mut seconds) {
            seconds.push(render(scene, rays));
        }
    }
    for (point, seconds) in finalists.into_iter().zip(&seconds) {
        point.finalist = true;
        point.rendering = Spread::of(seconds).map_or(point.rendering, |spread| spread.median);
    }
    Ok(())
}

/// What a plot shows along x.
type Along = fn(&Point) -> f64;

/// Every structure, each of its parameters on a grid.
fn grid() -> Vec<Structure> {
    let mut grid = Vec::new();
    for density in [0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0] {
        grid.push(Structure::Uniform(UniformParams { density }));
    }
    for threshold in [6, 10, 14, 19, 25, 31, 50] {
        grid.extend([2, 3, 4, 6, 8].map(|divisions| recursive(threshold, divisions, true)));
    }
    for threshold in [2, 4, 6, 8, 16] {
        grid.extend([0, 3, 7, 15, 31].map(|plane_weight| octree(threshold, plane_weight)));
    }
    for density in [0.02, 0.05, 0.1, 0.2, 0.5] {
        grid.extend(
            [0, 1, 2, 3, 4]
                .map(|levels| Structure::Hybrid(HybridParams { density, levels, ..HybridParams::DEFAULT })),
        );
    }
    grid
}

/// Seconds of the queries of a whole image.
fn render(scene: &Scene, rays: &Rays) -> f64 {
    let start = Instant::now();
    rays.trace_primary(scene, 0, 1);
    let primary = start.elapsed().as_secs_f64();
    rays.trace_shadow(scene, 0, 1);
    let shadow = start.elapsed().as_secs_f64() - primary;
    primary * rays.primary.factor() + shadow * rays.shadow.factor()
}

/// The fastest finalist of each structure.
fn best(points: &[Point]) -> Vec<&Point> {
    let families = Structure::ALL.map(|structure| structure.name());
    let of = |family| points.iter().filter(move |p| p.finalist && p.family == family);
    families.into_iter().filter_map(|f| of(f).min_by(|a, b| a.rendering.total_cmp(&b.rendering))).collect()
}

fn summary(sweep: &Sweep) -> String {
    let (scene, triangles, points) = (sweep.scene, sweep.triangles, sweep.points.len());
    let rows = sweep.best.iter().map(|point| {
        [
            point.structure.clone(),
            digits(point.rendering),
            digits(sweep.rays as f64 / point.rendering / 1e6),
            digits(point.memory),
            digits(point.preprocessing),
        ]
    });
    let header = ["best", "rendering, s", "Mray/s", "memory, KB", "preprocessing, s"];
    format!("{scene}: {triangles} triangles, {points} points\n{}", table::grid(header, rows))
}

/// `sweep-NAME.json` and two plots.
fn write(folder: &Folder, sweep: &Sweep) -> Result<(), Failure> {
    let stem = stem(sweep.scene);
    #[derive(Serialize)]
    struct File<'a> {
        machine: Machine,
        #[serde(flatten)]
        sweep: &'a Sweep<'a>,
    }
    folder.write_json(&format!("sweep-{stem}.json"), &File { machine: Machine::here(), sweep })?;
    let plots: [(&str, &str, Along); 2] =
        [("memory", "memory, KB", |p| p.memory), ("preprocessing", "preprocessing, s", |p| p.preprocessing)];
    for (suffix, label, x) in plots {
        let title = format!("{stem}: speed against {suffix}");
        let labels = Labels { title: &title, x: label, y: "speed, Mray/s", scale: Scale::Linear };
        folder.write_plot(&format!("sweep-{stem}-{suffix}.svg"), &labels, &series(sweep, x))?;
    }
    Ok(())
}

/// The points of each structure, then the best of each.
fn series(sweep: &Sweep, x: Along) -> Vec<Series> {
    let place = |point: &Point| (x(point), sweep.rays as f64 / point.rendering / 1e6);
    let all = sweep.best.iter().map(|best| Series {
        name: best.family.to_owned(),
        points: sweep.points.iter().filter(|p| p.family == best.family).map(place).collect(),
        joined: false,
        look: None,
    });
    let best = sweep.best.iter().map(|best| Series {
        name: format!("best: {}", best.structure),
        points: vec![place(best)],
        joined: false,
        look: None,
    });
    all.chain(best).collect()
}
