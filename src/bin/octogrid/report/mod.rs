//! `octogrid report`: measurements, as tables, figures and plots.

mod folder;
mod machine;
mod paper;
mod plot;
mod statistics;

use clap::Subcommand;

use crate::failure::Failure;

/// Measure and judge: tables, figures and plots
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    #[command(subcommand)]
    report: Report,
}

#[derive(Debug, Subcommand)]
enum Report {
    Paper(paper::Args),
}

/// Runs the command.
///
/// # Errors
/// On wrong parameters, on files that can't be read or written, and where a build fails.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let Report::Paper(args) = &args.report;
    paper::run(args)
}
