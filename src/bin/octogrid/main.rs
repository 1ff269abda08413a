//! The command `octogrid`: pictures, hits and numbers of triangle scenes.
//!
//! Exit codes: 0 success; 1 expected failure, told in one line on standard error; 2 wrong usage.

mod analyze;
mod answer;
mod args;
mod build;
mod camera;
mod failure;
mod frame;
mod heat;
mod integrators;
mod layers;
mod legend;
mod lights;
mod load;
mod npy;
mod output;
mod params;
mod pool;
mod render;
mod report;
mod saved;
mod scene;
mod shade;
mod streams;
mod survey;
mod table;
mod tone;
mod trace;
mod viewpoint;

use std::io::Write;
use std::process::ExitCode;

use clap::error::ErrorKind;
use clap::{CommandFactory, Parser, Subcommand};

use failure::Failure;

/// Ray queries against triangle scenes with voxel structures.
#[derive(Parser)]
#[command(name = "octogrid", version, max_term_width = 100)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Render(render::Args),
    Trace(trace::Args),
    Analyze(analyze::Args),
    Build(build::Args),
    Scene(scene::Args),
    Report(report::Args),
}

fn main() -> ExitCode {
    let done = match Cli::parse().command {
        Command::Render(args) => render::run(&args),
        Command::Trace(args) => trace::run(&args),
        Command::Analyze(args) => analyze::run(&args),
        Command::Build(args) => build::run(&args),
        Command::Scene(args) => scene::run(&args),
        Command::Report(args) => report::run(&args),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(Failure::Usage(what)) => {
            let _ = Cli::command().error(ErrorKind::ValueValidation, what).print();
            ExitCode::from(2)
        }
        Err(Failure::Expected(what)) => {
            let line = what.split_whitespace().collect::<Vec<_>>().join(" ");
            let _ = writeln!(std::io::stderr(), "octogrid: {line}");
            ExitCode::from(1)
        }
    }
}
