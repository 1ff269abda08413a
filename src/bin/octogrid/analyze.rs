//! `octogrid analyze`: what a scene is made of, what of a structure it needs, and the structures side by side.

use octogrid::{BuildOptions, Forced, Model, Plan, SceneProfile, Statistics};

use crate::args::{BuildArgs, Choice};
use crate::failure::Failure;
use crate::load::{self, Loaded};
use crate::output::say;
use crate::{survey, table};

/// Measure a scene, plan what it needs, and compare the structures on it
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// An OBJ file or the name of a built-in scene
    scene: String,
    /// Build only this structure [default: the plan's and the four of voxels]
    #[arg(long, value_enum)]
    structure: Option<Choice>,
    #[command(flatten)]
    build: BuildArgs,
}

/// Runs the command.
///
/// # Errors
/// On wrong parameters, on a scene that can't be read, and where no build succeeds.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let options = match args.structure {
        Some(choice) => vec![args.build.options(choice)?],
        None => args.build.options_of_all()?,
    };
    let loaded = load::load(&args.scene)?;
    let measured: Vec<_> = options.iter().map(|options| measure(&loaded.model, options)).collect();
    let profile = SceneProfile::new(&loaded.model.mesh()?);
    let plan = plan(&loaded.model, &profile, &options[0], &measured[0]);
    let facts = table::pairs(geometry(&loaded).into_iter().chain(lie(&profile)));
    let text = format!("{facts}\n\n{plan}\n\n{}", structures(&options, &measured));
    // One structure over the limit says nothing of the others, but is the answer where it is alone.
    let failure = measured.into_iter().filter_map(Result::err).next_back();
    match failure {
        Some(failure) if options.len() == 1 => Err(failure),
        _ => say(text),
    }
}

type Measured = Result<(f64, f64, Statistics), Failure>;

/// Milliseconds, bytes a triangle, and the parts of a structure that holds all its invariants.
fn measure(model: &Model, options: &BuildOptions) -> Measured {
    let (scene, build_ms) = load::build(model, options)?;
    let statistics = scene.validate().map_err(|violation| Failure::Expected(violation.to_string()))?;
    Ok((build_ms, load::bytes_per_triangle(&scene), statistics))
}

/// The plan, and what it saves. `measured` is of the first structure that was asked for, the plan's if none was.
fn plan(model: &Model, profile: &SceneProfile, options: &BuildOptions, measured: &Measured) -> String {
    let plan = Plan::new(profile, options.forced);
    let built = |measured: &Measured| match measured {
        Ok((ms, bytes, _)) => format!("{bytes:.1} bytes a triangle, built in {ms:.2} ms"),
        Err(Failure::Usage(what) | Failure::Expected(what)) => format!("not built ({what})"),
    };
    let measure = |forced| built(&measure(model, &BuildOptions { structure: None, forced, ..*options }));
    let planned = if options.structure.is_none() { built(measured) } else { measure(options.forced) };
    let all = measure(Forced::all(true));
    format!("Plan: {}\n{plan}\nThat is {planned}; with all parts {all}.", plan.structure())
}

/// How the triangles lie, as far as the plan depends on it.
fn lie(profile: &SceneProfile) -> Vec<(&'static str, String)> {
    vec![
        ("least over greatest extent", format!("{:.3}", profile.flatness)),
        ("largest coordinate over extent", format!("{:.3e}", profile.magnitude)),
        ("triangles around an average one", format!("{:.0}", profile.crowding)),
        ("voxels with triangles, of one for 80", format!("{:.1}%", 100.0 * profile.evenness)),
    ]
}

fn geometry(loaded: &Loaded) -> Vec<(&'static str, String)> {
    let model = &loaded.model;
    let triangles = model.triangles.len();
    let (groups, grouped) = survey::coplanar(model);
    let percent = |part: usize| format!("{:.1}%", 100.0 * part as f64 / triangles.max(1) as f64);
    let [one, two, more] = survey::edges(model);
    let (low, high) = survey::bounds(model).unwrap_or_default();
    let point = |p: glam::DVec3| format!("{} {} {}", p.x as f32, p.y as f32, p.z as f32);
    let edges = survey::longest_edges(model);
    let quantile = |part: f64| edges.get(((edges.len().max(1) - 1) as f64 * part) as usize).unwrap_or(&0.0);
    let quantiles = [0.0, 0.1, 0.5, 0.9, 1.0].map(|part| format!("{:.3e}", quantile(part)));
    // Zero-length triangles would make the spread infinite.
    let shortest = edges.iter().find(|&&edge| edge > 0.0).unwrap_or(&1.0);
    vec![
        ("scene", loaded.name.clone()),
        ("vertices", model.vertices.len().to_string()),
        ("triangles", triangles.to_string()),
        ("materials", model.materials.len().to_string()),
        ("lights", model.lights().len().to_string()),
        ("lowest corner", point(low)),
        ("highest corner", point(high)),
        ("zero-area triangles", survey::degenerate(model).to_string()),
        ("repeated triangles", survey::repeated(model).to_string()),
        ("planes with several triangles", groups.to_string()),
        ("triangles in them", percent(grouped)),
        ("triangles in a plane of two axes", percent(survey::axis_aligned(model))),
        ("edges of one, two, more triangles", format!("{one} {two} {more}")),
        ("longest edge, quantiles 0 10 50 90 100%", quantiles.join(" ")),
        ("longest edge, largest / smallest", format!("{:.3e}", quantile(1.0) / shortest)),
    ]
}

/// One row a structure.
fn structures(options: &[BuildOptions], measured: &[Measured]) -> String {
    let header = [
        "structure",
        "build, ms",
        "bytes/tri",
        "clusters",
        "empty",
        "leaves",
        "nodes",
        "references",
        "refs/cluster",
        "depth",
    ];
    let mut failures = String::new();
    let mut rows = Vec::new();
    for (options, measured) in options.iter().zip(measured) {
        let name = options.structure.map_or("auto".to_owned(), |structure| structure.to_string());
        match measured {
            Ok((build_ms, bytes, parts)) => rows.push(row(name, *build_ms, *bytes, parts)),
            Err(Failure::Usage(what) | Failure::Expected(what)) => {
                failures += &format!("\n{name}: {what}");
            }
        }
    }
    format!("{}{failures}", table::grid(header, rows))
}

fn row(name: String, build_ms: f64, bytes: f64, parts: &Statistics) -> [String; 10] {
    [
        name,
        format!("{build_ms:.2}"),
        format!("{bytes:.1}"),
        parts.clusters.to_string(),
        parts.empty.to_string(),
        parts.leaves.to_string(),
        parts.nodes.to_string(),
        parts.references.to_string(),
        format!("{:.2}", parts.references as f64 / parts.clusters.max(1) as f64),
        parts.depth.to_string(),
    ]
}
