//! `octogrid report`: the measurements of a paper, repeated.

mod columns;
mod conclusions;
mod families;
mod files;
mod machine;
mod measure;
mod paper;
mod plot;
mod published;
mod rays;
mod statistics;
mod sweep;
mod tables;
mod verdict;

use clap::Subcommand;

use crate::failure::Failure;

/// Repeat the measurements of a paper and judge its conclusions
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
