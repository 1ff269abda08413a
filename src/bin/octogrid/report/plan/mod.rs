//! `octogrid report plan`: what leaving out saves, and how the plan's choice compares with the others.

mod bars;
mod count;
mod files;
mod measure;
mod rays;
mod savings;
mod variants;

use std::path::PathBuf;

use octogrid::SceneProfile;

use self::files::Report;
use self::rays::Rays;
use super::folder::Folder;
use super::machine::Machine;
use crate::failure::Failure;
use crate::frame::each_band;
use crate::load;
use crate::output::say;
use crate::{pool, table};

/// Measure what leaving out saves, and whether the plan's choice is the best
///
/// Builds each scene as its plan says, fast, with all parts, with each part the other way round, and as every
/// structure with default parameters, and traces rays of an image: from the camera, to the lights, and from
/// where they meet the scene any way. One after the other, which is what parts are judged by, and as streams,
/// which is how an image is rendered. All in turns on one thread. Instructions are counted under valgrind,
/// where there is one; else the tables show cluster tests and cache lines. Writes report.json, report.csv and
/// savings.svg.
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// OBJ files or built-in scenes [default: all built-in scenes]
    #[arg(value_name = "SCENE")]
    scenes: Vec<String>,
    /// The folder for the files, made if there is none
    #[arg(long, value_name = "DIR", default_value = "report-plan")]
    out: PathBuf,
    /// About how many rays of each kind
    #[arg(long, value_name = "N", default_value = "4096", value_parser = clap::value_parser!(u32).range(1..=1 << 24))]
    rays: u32,
    /// Measure this many times, in turns
    #[arg(long, value_name = "N", default_value_t = 5)]
    #[arg(value_parser = clap::value_parser!(u16).range(1..=1000))]
    rounds: u16,
    /// Trace the rays in one variant, for valgrind to count
    #[arg(long, value_name = "VARIANT", hide = true)]
    count: Option<String>,
}

/// Runs the command.
///
/// # Errors
/// On a scene or a folder that can't be used, where a build fails, and where variants disagree.
pub(super) fn run(args: &Args) -> Result<(), Failure> {
    if let Some(variant) = &args.count {
        return pool::of(1)?.install(|| count_one(args, variant));
    }
    let folder = Folder::at(&args.out)?;
    let names = match &args.scenes[..] {
        [] => octogrid::builtin::all().iter().map(|scene| scene.name.to_owned()).collect(),
        names => names.to_vec(),
    };
    let scenes = names.iter().map(|name| load::load(name)).collect::<Result<Vec<_>, _>>()?;
    pool::of(1)?.install(|| {
        let machine = Machine::here();
        say(table::pairs(machine.pairs()))?;
        let mut points = Ok(Vec::new());
        each_band(scenes.len(), 1, |at| {
            if let Ok(all) = &mut points {
                match measure::measure(&scenes[at.start], args.rays, args.rounds) {
                    Ok(of_scene) => all.push(of_scene),
                    Err(failure) => points = Err(failure),
                }
            }
        });
        let points: Vec<_> = points?.into_iter().filter(|points| !points.is_empty()).collect();
        let report = Report { machine, rays: args.rays, rounds: args.rounds, scenes: points };
        say(format_args!("\n{}", files::tables(&report)))?;
        files::write(&folder, &report)?;
        say(format_args!("\nreport.json, report.csv and savings.svg are in {}", folder.path().display()))
    })
}

/// Traces the rays of the one scene in one variant.
fn count_one(args: &Args, variant: &str) -> Result<(), Failure> {
    let [scene] = &args.scenes[..] else {
        return Err(Failure::Usage("--count needs one scene".into()));
    };
    let loaded = load::load(scene)?;
    let variants = variants::variants(&SceneProfile::new(&loaded.model.mesh()?));
    let found = variants.iter().find(|v| v.name == variant);
    let found = found.ok_or_else(|| Failure::Usage(format!("no variant '{variant}'")))?;
    let (planned, _) = load::build(&loaded.model, &Default::default())?;
    let image = Rays::new(&loaded, &planned, args.rays as usize);
    let (scene, _) = load::build(&loaded.model, &found.options)?;
    count::counted(&scene, &image);
    Ok(())
}
