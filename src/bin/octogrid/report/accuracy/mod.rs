//! `octogrid report accuracy`: the error of kernels against the time that they take.

mod errors;
mod files;
mod measure;
mod pareto;
mod rays;
mod truth;
mod variants;

use std::path::PathBuf;

use octogrid::{Scene, Structure};

use self::files::{Measured, Report};
use super::folder::Folder;
use super::machine::Machine;
use crate::failure::Failure;
use crate::output::say;
use crate::{load, table};

/// Measure the error of kernels against their run time
///
/// Traces rays from easy to hard with every kernel on every structure, in turns on one thread, and
/// compares the answers with exact arithmetic: wrong hits and misses, wrong triangles, and the errors
/// of t, u and v in units in the last place. Writes report.json, report.csv and Pareto plots as SVG.
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// OBJ files or built-in scenes
    #[arg(value_name = "SCENE", default_values_t = ["interior".to_owned()])]
    scenes: Vec<String>,
    /// The folder for the files, made if there is none
    #[arg(long, value_name = "DIR", default_value = "report-accuracy")]
    out: PathBuf,
    /// Rays a set
    #[arg(long, value_name = "N", default_value = "4000", value_parser = clap::value_parser!(u32).range(1..=1 << 24))]
    rays: u32,
    /// Measure this many times, in turns
    #[arg(long, value_name = "N", default_value_t = 7)]
    #[arg(value_parser = clap::value_parser!(u16).range(1..=1000))]
    rounds: u16,
    /// Chooses the rays
    #[arg(long, value_name = "S", default_value = "0")]
    seed: u64,
}

/// Runs the command.
///
/// # Errors
/// On a scene or a folder that can't be used, and where a build fails.
pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let folder = Folder::at(&args.out)?;
    let machine = Machine::here();
    say(table::pairs(machine.pairs()))?;
    let mut scenes = Vec::new();
    for name in &args.scenes {
        let measured = measure_scene(args, name)?;
        say(format_args!("\n{}", files::tables(&measured)))?;
        scenes.push(measured);
    }
    let report = Report { machine, seed: args.seed, rounds: args.rounds.into(), scenes: &scenes };
    files::write(&folder, &report)?;
    say(format_args!("\nreport.json, report.csv and plots are in {}", folder.path().display()))
}

fn measure_scene(args: &Args, name: &str) -> Result<Measured, Failure> {
    let loaded = load::load(name)?;
    let (reference, _) = load::build(&loaded.model, &Default::default())?;
    let mesh = loaded.model.mesh()?;
    let mut sets = Vec::new();
    for set in rays::sets(&loaded, &reference, args.rays as usize, args.seed)? {
        let truths = truth::truth(&reference, &mesh, &set.rays)?;
        sets.push((set, truths));
    }
    let built = |structure: Structure| Ok(load::build(&loaded.model, &structure.into())?.0);
    let scenes = variants::structures()?.into_iter().map(built).collect::<Result<Vec<Scene>, Failure>>()?;
    let points = measure::measure(&scenes, &sets, args.rounds.into());
    Ok(Measured { scene: name.to_owned(), triangles: mesh.len(), points })
}
