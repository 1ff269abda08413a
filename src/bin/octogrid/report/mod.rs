//! `octogrid report`: measurements, as tables, figures and plots.

mod accuracy;
mod convergence;
mod fit;
mod folder;
mod machine;
mod numbers;
mod paper;
mod plan;
mod plot;
mod scaling;
mod stability;
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
    Accuracy(accuracy::Args),
    Convergence(convergence::Args),
    Stability(stability::Args),
    Scaling(scaling::Args),
    Plan(plan::Args),
}

/// Runs the command.
///
/// # Errors
/// On wrong parameters, on files that can't be read or written, where a build fails, and where answers differ.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    match &args.report {
        Report::Paper(args) => paper::run(args),
        Report::Accuracy(args) => accuracy::run(args),
        Report::Convergence(args) => convergence::run(args),
        Report::Stability(args) => stability::run(args),
        Report::Scaling(args) => scaling::run(args),
        Report::Plan(args) => plan::run(args),
    }
}
