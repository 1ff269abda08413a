//! `octogrid report convergence`: the error of images against the time that they take.

mod files;
mod image;
mod measure;

use std::path::PathBuf;

use octogrid::{Scene, Structure};

use self::files::Report;
use self::image::{Reference, View};
use self::measure::{Measured, Plan};
use super::folder::Folder;
use super::machine::Machine;
use crate::failure::Failure;
use crate::integrators::Integrator;
use crate::output::say;
use crate::pool::ThreadArgs;
use crate::{load, render, table};

/// Samples of the reference for each one of the longest run: its own error adds 3% to that run's.
const REFERENCE: u32 = 16;

/// Measure the error of images against their run time
///
/// Renders each scene with each integrator, structure and a rising number of samples, and compares
/// the luminance with a reference of 16 times as many samples, but for pixels that are white there.
/// Tells the slope of error over seconds on logarithmic axes, and the seconds to an error of 1% of the
/// mean if it falls with the root of time. Writes report.json, report.csv, summary.csv and plots as
/// SVG.
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// OBJ files or built-in scenes
    #[arg(value_name = "SCENE", default_values_t = ["room".to_owned(), "interior".to_owned()])]
    scenes: Vec<String>,
    /// The folder for the files, made if there is none
    #[arg(long, value_name = "DIR", default_value = "report-convergence")]
    out: PathBuf,
    /// Width and height of the images in pixels
    #[arg(long, value_name = "WxH", default_value = "96x72", value_parser = render::parse_size)]
    size: [u32; 2],
    /// The most samples a pixel; the others are powers of two below
    #[arg(long, value_name = "N", default_value = "32", value_parser = clap::value_parser!(u32).range(2..=1 << 16))]
    samples: u32,
    /// Measure this many times, in turns
    #[arg(long, value_name = "N", default_value_t = 3)]
    #[arg(value_parser = clap::value_parser!(u16).range(1..=1000))]
    rounds: u16,
    /// Chooses the random numbers
    #[arg(long, value_name = "S", default_value = "0")]
    seed: u64,
    /// How light is found
    #[arg(long, value_enum, value_name = "INTEGRATOR", value_delimiter = ',')]
    #[arg(default_values_t = [Integrator::Direct, Integrator::Path, Integrator::Photon])]
    integrators: Vec<Integrator>,
    #[command(flatten)]
    threads: ThreadArgs,
}

/// Runs the command.
///
/// # Errors
/// On a scene or a folder that can't be used, where a build fails, and on a scene without lights unless
/// only the integrator `direct` is asked for.
pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let folder = Folder::at(&args.out)?;
    args.threads.run(|| {
        let machine = Machine::here();
        say(table::pairs(machine.pairs()))?;
        let mut measured = Vec::new();
        for scene in &args.scenes {
            measure_scene(args, scene, &mut measured)?;
        }
        let size = args.size;
        let report = Report { machine, size, seed: args.seed, target: measure::TARGET, measured: &measured };
        files::write(&folder, &report)?;
        say(format_args!(
            "\nreport.json, report.csv, summary.csv and plots are in {}",
            folder.path().display()
        ))
    })
}

/// Measures all integrators on a scene, and says what it finds.
fn measure_scene(args: &Args, name: &str, measured: &mut Vec<Measured>) -> Result<(), Failure> {
    let loaded = load::load(name)?;
    let built = |structure: Structure| {
        let (scene, _) = load::build(&loaded.model, &structure.into())?;
        Ok((structure, scene))
    };
    // The default first, since others are compared with it.
    let scenes = Structure::ALL.into_iter().rev().map(built).collect::<Result<Vec<(_, Scene)>, Failure>>()?;
    let views: Vec<_> = scenes.iter().map(|(s, scene)| (*s, View::new(&loaded, scene, args.size))).collect();
    let plan = Plan { samples: powers(args.samples), rounds: args.rounds.into(), seed: args.seed };
    let mut references: Vec<(Integrator, Reference)> = Vec::new();
    for &integrator in &args.integrators {
        let kind = reference_of(integrator);
        if references.iter().all(|(of, _)| *of != kind) {
            let samples = REFERENCE * args.samples;
            let image = views[0].1.image(kind, samples, !args.seed)?;
            references.push((kind, Reference::new(samples, image)));
        }
        let Some((_, reference)) = references.iter().find(|(of, _)| *of == kind) else { continue };
        measured.push(measure::measure(&views, name, integrator, reference, &plan)?);
        say(format_args!("\n{}", files::table(&measured[measured.len() - 1])))?;
    }
    Ok(())
}

/// The integrator of the reference. `path` and `photon` converge to the same radiance; a reference by
/// `photon` would hide its own blur.
fn reference_of(integrator: Integrator) -> Integrator {
    match integrator {
        Integrator::Photon => Integrator::Path,
        other => other,
    }
}

/// The powers of two below a number, and the number.
fn powers(most: u32) -> Vec<u32> {
    let below = std::iter::successors(Some(1u32), |n| n.checked_mul(2)).take_while(|&n| n < most);
    below.chain([most]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_double() {
        assert_eq!(powers(2), [1, 2]);
        assert_eq!(powers(8), [1, 2, 4, 8]);
        assert_eq!(powers(12), [1, 2, 4, 8, 12]);
    }
}
