//! `octogrid report scaling`: what a triangle and a ray cost as scenes grow.

mod files;
mod measure;
mod sizes;

use std::path::PathBuf;

use self::files::Report;
use super::folder::Folder;
use super::machine::Machine;
use crate::failure::Failure;
use crate::output::say;
use crate::pool::ThreadArgs;
use crate::table;

/// Triangles of the largest scenes with `--full`.
const FULL: u32 = 10_000_000;

/// Measure what a triangle and a ray cost as scenes grow
///
/// Builds the default structure of each scene in sizes from 10^4 triangles on, and asks it for the
/// closest hits of random rays from within its box, on one thread and on all: time and memory a triangle,
/// time a ray, and the speed-up by threads. `soup` is made in each size; of other scenes as many
/// triangles are divided into four as it takes. Sizes below a scene's own are left out, and where all
/// are, it is measured as it is. Writes report.json, report.csv and plots as SVG.
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// OBJ files or built-in scenes
    #[arg(value_name = "SCENE", default_values_t = ["soup".to_owned(), "interior".to_owned()])]
    scenes: Vec<String>,
    /// The folder for the files, made if there is none
    #[arg(long, value_name = "DIR", default_value = "report-scaling")]
    out: PathBuf,
    /// The most triangles; the other sizes are powers of ten below, from 10^4 on
    #[arg(long, value_name = "N", default_value = "1000000")]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=100_000_000))]
    largest: u32,
    /// Go on to 10^7 triangles
    #[arg(long, conflicts_with = "largest")]
    full: bool,
    /// Rays a scene
    #[arg(long, value_name = "N", default_value = "20000", value_parser = clap::value_parser!(u32).range(1..=1 << 24))]
    rays: u32,
    /// Measure this many times, in turns
    #[arg(long, value_name = "N", default_value_t = 5)]
    #[arg(value_parser = clap::value_parser!(u16).range(1..=1000))]
    rounds: u16,
    /// Chooses the rays
    #[arg(long, value_name = "S", default_value = "0")]
    seed: u64,
    #[command(flatten)]
    threads: ThreadArgs,
}

/// Runs the command.
///
/// # Errors
/// On a scene or a folder that can't be used, on a scene without triangles, and where a build fails.
pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let folder = Folder::at(&args.out)?;
    args.threads.run(|| {
        let machine = Machine::here();
        say(table::pairs(machine.pairs()))?;
        let largest = if args.full { FULL } else { args.largest };
        let mut cases = Vec::new();
        for scene in &args.scenes {
            for model in sizes::models(scene, largest as usize)? {
                cases.push(measure::Case::new(scene, model, args.rays as usize, args.seed));
            }
        }
        let points = measure::measure(&cases, args.rounds.into())?;
        let report =
            Report { machine, rays: args.rays, rounds: args.rounds, seed: args.seed, points: &points };
        say(format_args!("\n{}", files::table(&report)))?;
        files::write(&folder, &report)?;
        say(format_args!("\nreport.json, report.csv and plots are in {}", folder.path().display()))
    })
}
