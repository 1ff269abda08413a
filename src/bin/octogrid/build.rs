//! `octogrid build`: the structure of a scene to a file.

use std::path::PathBuf;
use std::time::Instant;

use crate::args::{BuildArgs, Choice};
use crate::failure::Failure;
use crate::output::{Output, say};
use crate::pool::ThreadArgs;
use crate::{load, saved, table};

/// Build the structure of a scene and save it, for trace and for render --accel
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// An OBJ file or the name of a built-in scene
    scene: String,
    /// Where the structure goes
    #[arg(short, long, value_name = "FILE.ogrid")]
    output: PathBuf,
    /// The voxel structure
    #[arg(long, value_enum, default_value = "auto")]
    structure: Choice,
    #[command(flatten)]
    build: BuildArgs,
    #[command(flatten)]
    threads: ThreadArgs,
}

/// Runs the command.
///
/// # Errors
/// On wrong parameters, on files that can't be read or written, and where the build fails.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let options = args.build.options(args.structure)?;
    if !saved::is_named(&args.output) {
        return Err(Failure::Usage("the name of the output must end in .ogrid, by which it is known".into()));
    }
    let output = Output::at(&args.output)?;
    let loaded = load::load(&args.scene)?;
    let (scene, build_ms) = args.threads.run(|| load::build(&loaded.model, &options))?;
    let start = Instant::now();
    let mut bytes = 0;
    output.write(|file| {
        scene.save(&mut *file)?;
        bytes = file.get_ref().metadata()?.len();
        Ok(())
    })?;
    let save_ms = start.elapsed().as_secs_f64() * 1e3;
    say(table::pairs([
        ("scene", loaded.name),
        ("triangles", scene.triangles().to_string()),
        ("structure", scene.structure().to_string()),
        ("build, ms", format!("{build_ms:.2}")),
        ("bytes a triangle", format!("{:.1}", load::bytes_per_triangle(&scene))),
        ("save, ms", format!("{save_ms:.2}")),
        ("bytes of the file", bytes.to_string()),
    ]))
}
