//! `octogrid report paper`: Dmitriev's tables, repeated.

mod columns;
mod conclusions;
mod families;
mod files;
mod measure;
mod published;
mod rays;
mod sweep;
mod tables;
mod verdict;

use std::path::PathBuf;

use self::conclusions::Figures;
use self::files::Report;
use self::measure::Measured;
use self::rays::Rays;
use super::folder::Folder;
use super::machine::Machine;
use crate::failure::Failure;
use crate::output::say;
use crate::pool::ThreadArgs;
use crate::{load, render, table};

/// The paper's scenes, the large one first.
const SCENES: [&str; 2] = ["interior", "room"];
/// Rays of each kind traced a round and structure, at most, without `--full`.
const TRACED: usize = 1 << 18;

/// Repeat Dmitriev's "Efficiency issues on Ray Tracing Machine"
///
/// Measures the paper's structures on `interior` and `room`, its two scenes, and says which of its
/// conclusions hold. Writes report.json, report.csv and plots as SVG.
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// The folder for the files, made if there is none
    #[arg(long, value_name = "DIR", default_value = "report-paper")]
    out: PathBuf,
    /// Width and height of the image in pixels
    #[arg(long, value_name = "WxH", default_value = "800x600", value_parser = render::parse_size)]
    size: [u32; 2],
    /// Measure this many times, in turns
    #[arg(long, value_name = "N", default_value_t = 9)]
    #[arg(value_parser = clap::value_parser!(u16).range(1..=1000))]
    rounds: u16,
    /// Trace all rays of the image, not some of its rows
    #[arg(long)]
    full: bool,
    /// Instead, look for the best parameters on these scenes [default: interior room]
    #[arg(long, value_name = "SCENE", num_args = 0..)]
    sweep: Option<Vec<String>>,
    #[command(flatten)]
    threads: ThreadArgs,
}

/// Runs the command.
///
/// # Errors
/// On a scene or a folder that can't be used, and where a build fails.
pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let folder = Folder::at(&args.out)?;
    args.threads.run(|| match &args.sweep {
        Some(scenes) if scenes.is_empty() => sweep::run(&SCENES.map(str::to_owned), args.size, &folder),
        Some(scenes) => sweep::run(scenes, args.size, &folder),
        None => report(args, &folder),
    })
}

fn report(args: &Args, folder: &Folder) -> Result<(), Failure> {
    let machine = Machine::here();
    say(table::pairs(machine.pairs()))?;
    let measured = [measure(args, SCENES[0])?, measure(args, SCENES[1])?];
    for measured in &measured {
        say(format_args!("\n{}", tables::figures(measured)))?;
    }
    let paper = SCENES.map(published::columns);
    let ours = conclusions::judge(measured[0].figures(), measured[1].figures());
    let figures = |i: usize| Figures { scene: SCENES[i], columns: &paper[i], blind: None };
    let papers = conclusions::judge(figures(0), figures(1));
    say(format_args!("\n{}", tables::conclusions(&ours, &papers)))?;
    let report = Report {
        machine,
        size: args.size,
        rounds: args.rounds.into(),
        full: args.full,
        scenes: &measured,
        conclusions: &ours,
        conclusions_of_papers_figures: &papers,
        paper,
    };
    files::write(folder, &report)?;
    say(format_args!("\nreport.json, report.csv and plots are in {}", folder.path().display()))
}

fn measure(args: &Args, scene: &'static str) -> Result<Measured, Failure> {
    let loaded = load::load(scene)?;
    let most = if args.full { usize::MAX } else { TRACED };
    let rays = Rays::new(&loaded, args.size, most)?;
    measure::measure(scene, &loaded, &rays, args.rounds.into())
}

impl Measured {
    fn figures(&self) -> Figures<'_> {
        Figures { scene: self.scene, columns: &self.columns, blind: Some(&self.blind) }
    }
}
