//! `octogrid report stability`: hazards without a failure, closed meshes without a leak.

mod closed;
mod files;
mod hazards;
mod tables;

use std::path::PathBuf;

use self::files::Report;
use super::folder::Folder;
use super::machine::Machine;
use crate::failure::Failure;
use crate::frame::each_band;
use crate::output::say;
use crate::pool::ThreadArgs;
use crate::table;

/// Rounds that are traced at once, in parallel.
const BAND: usize = 2;

/// Look for a ray that is lost, counted twice or answered differently
///
/// Traces hazardous rays in hazardous scenes and compares the four structures with brute force, bit for
/// bit, and brute force with exact arithmetic. Sends rays at edges, vertices and triangles of closed
/// meshes, which none may leave unseen, and which each must cross an odd number of times from inside and
/// an even number of times from outside.
///
/// The work is cut into rounds, each made from the seed and its number alone: a run says at its end with
/// which --from-round to go on. The first failure is printed with its ray and triangles, and the exit
/// code is 1. Writes report.json and report.csv.
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// OBJ files or built-in scenes whose closed parts are tested too
    #[arg(value_name = "SCENE")]
    scenes: Vec<String>,
    /// Trace about so many rays, in whole rounds, at least one
    #[arg(long, value_name = "N", default_value_t = 1_000_000)]
    rays: u64,
    /// Make other scenes and rays
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// The number of the first round
    #[arg(long, value_name = "K", default_value_t = 0)]
    from_round: u64,
    /// The folder for the files, made if there is none
    #[arg(long, value_name = "DIR", default_value = "report-stability")]
    out: PathBuf,
    #[command(flatten)]
    threads: ThreadArgs,
}

/// One round of one seed.
#[derive(Clone, Copy)]
struct Round {
    seed: u64,
    number: u64,
}

impl Round {
    /// Rounds of this many bring the huge scenes once, at their end.
    const HUGE: u64 = 128;

    /// The seed of all that is random in the round.
    fn random(self) -> u64 {
        let mut rng = octogrid::Rng::new(self.seed);
        rng.bits() ^ octogrid::Rng::new(self.number).bits()
    }

    fn has_huge_scenes(self) -> bool {
        self.number % Self::HUGE == Self::HUGE - 1
    }
}

/// A failure, as text, with its round.
#[derive(Clone)]
struct Found {
    round: u64,
    text: String,
}

impl Found {
    fn new(round: Round, hazard: &str, scene: &str, what: &dyn std::fmt::Display) -> Self {
        let Round { seed, number } = round;
        Self {
            round: number,
            text: format!("{hazard}, {scene}, --seed {seed} --from-round {number}:\n{what}"),
        }
    }

    /// The one of the earlier round.
    fn first(a: Option<Self>, b: Option<Self>) -> Option<Self> {
        a.into_iter().chain(b).min_by_key(|found| found.round)
    }
}

/// Runs the command.
///
/// # Errors
/// On a scene or a folder that can't be used, and where there is a failure.
pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let folder = Folder::at(&args.out)?;
    args.threads.run(|| report(args, &folder))
}

fn report(args: &Args, folder: &Folder) -> Result<(), Failure> {
    let machine = Machine::here();
    say(table::pairs(machine.pairs()))?;
    let meshes = closed::sources(&args.scenes)?;
    let mut meshes = closed::build(&meshes)?;
    let a_round = hazards::RAYS_A_ROUND + meshes.iter().map(closed::Case::rays_a_round).sum::<u64>();
    let count = args.rays.div_ceil(a_round).max(1);
    let round = |i: u64| Round { seed: args.seed, number: args.from_round.saturating_add(i) };
    let scenes = hazards::sources((0..count).any(|i| round(i).has_huge_scenes()));
    let mut hazards = hazards::build(&scenes);

    let mut done = Ok(());
    each_band(count as usize, BAND, |band| {
        let rounds: Vec<Round> = band.map(|i| round(i as u64)).collect();
        let hazards = || hazards::trace(&mut hazards, &rounds);
        let closed = || closed::trace(&mut meshes, &rounds);
        let ((), result) = rayon::join(hazards, closed);
        done = std::mem::replace(&mut done, Ok(())).and(result);
    });
    done?;

    let report = Report::new(machine, round(0), round(count), &hazards, &meshes);
    files::write(folder, &report)?;
    say(tables::all(&report))?;
    say(format_args!("report.json and report.csv are in {}", folder.path().display()))?;
    match report.failures {
        0 => Ok(()),
        n => Err(Failure::Expected(format!("{n} failures"))),
    }
}
