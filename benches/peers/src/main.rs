//! octogrid beside other ray tracers on the same triangles and rays. See README.md.

mod clock;
mod command;
mod figures;
mod measure;
mod memory;
mod peer;
mod peers;
mod reference;
mod roster;
mod samples;
mod sets;
mod tables;
mod threads;
mod triangle;

// Of the command's reports, as their items are for the module above.
#[path = "../../../src/bin/octogrid/report/machine.rs"]
mod machine;
#[path = "../../../src/bin/octogrid/report/statistics.rs"]
mod statistics;

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Parser;
use octogrid::builtin;

use command::{camera, failure, load, output, saved, streams, survey, viewpoint};
use failure::Failure;
use load::Loaded;
use machine::Machine;
use output::{Output, say};
use roster::{BASELINE, Contender};

/// The built-in scene `soup` with more triangles than it has.
const LARGE_SOUP: (&str, usize) = ("soup-1m", 1_000_000);

/// Measures octogrid and other ray tracers on the same triangles and rays.
#[derive(Parser)]
#[command(max_term_width = 100)]
struct Args {
    /// A scene: an OBJ file or a built-in name; several with one option each
    #[arg(long = "scene", value_name = "SCENE", default_values = ["room", "interior", LARGE_SOUP.0, "stadium"])]
    scenes: Vec<String>,
    /// Contenders, separated by commas; a name that ends in a hyphen stands for all that begin so, `all`
    /// for all [default: those marked in the list]
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    peers: Vec<String>,
    /// List the contenders, those with * being measured by default
    #[arg(long)]
    list: bool,
    #[command(flatten)]
    effort: measure::Effort,
    /// Folder for table.md and samples.csv
    #[arg(long, value_name = "DIR", default_value = "results")]
    out: PathBuf,
}

fn main() -> ExitCode {
    match run(&Args::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(Failure::Usage(what) | Failure::Expected(what)) => {
            eprintln!("peers: {what}");
            ExitCode::FAILURE
        }
    }
}

fn run(args: &Args) -> Result<(), Failure> {
    if args.list {
        return roster::all()
            .iter()
            .try_for_each(|c| say(format_args!("{}{}", c.name, if c.usual { " *" } else { "" })));
    }
    if !peers::embree::library_is_there() {
        return Err(Failure::Expected("there is no Embree: run setup.sh, or set PEERS_EMBREE".into()));
    }
    std::fs::create_dir_all(&args.out).map_err(|e| Failure::at(&args.out, e))?;
    let [table_file, samples_file] = ["table.md", "samples.csv"].map(|name| Output::at(&args.out.join(name)));
    let (table_file, samples_file) = (table_file?, samples_file?);
    let contenders = chosen(&args.peers)?;
    let baseline = contenders.iter().position(|c| c.name == BASELINE).expect("it is always chosen");
    let (mut scenes, mut figures, mut text) = (Vec::new(), Vec::new(), heading());
    say(&text)?;
    for name in &args.scenes {
        let loaded = load(name)?;
        let measured = measure::scene(&loaded, &contenders, &args.effort)
            .map_err(|what| Failure::Expected(format!("{name}: {what}")))?;
        figures.push(figures::of(&measured, baseline));
        let table = tables::scene(&measured, &contenders, &figures[figures.len() - 1]);
        say(format_args!("\n{table}"))?;
        text += &format!("\n{table}\n");
        scenes.push(measured);
        // After each scene, so that a run that is stopped leaves what it has.
        samples_file.write(|file| Ok(samples::write(file, &scenes, &contenders)?))?;
    }
    let means = tables::means(&scenes, &contenders, &figures, baseline);
    say(format_args!("\n{means}"))?;
    table_file.write(|file| writeln!(file, "{text}\n{means}"))
}

/// The contenders that are asked for, and the baseline.
fn chosen(names: &[String]) -> Result<Vec<Contender>, Failure> {
    let asked = |contender: &Contender, name: &String| {
        contender.name == name
            || name == "all"
            || (name.ends_with('-') && contender.name.starts_with(name.as_str()))
    };
    let all = roster::all();
    if let Some(name) = names.iter().find(|name| !all.iter().any(|c| asked(c, name))) {
        return Err(Failure::Usage(format!("there is no contender '{name}': see --list")));
    }
    let wanted = |c: &Contender| {
        c.name == BASELINE || if names.is_empty() { c.usual } else { names.iter().any(|name| asked(c, name)) }
    };
    Ok(all.into_iter().filter(wanted).collect())
}

/// A scene, by its name without folder and ending.
fn load(name: &str) -> Result<Loaded, Failure> {
    if name == LARGE_SOUP.0 {
        let cameras = builtin::by_name("soup").map_or(&[][..], |soup| soup.cameras);
        return Ok(Loaded { name: name.to_owned(), model: builtin::soup(LARGE_SOUP.1, 1), cameras });
    }
    let loaded = load::load(name)?;
    let stem = Path::new(name).file_stem().unwrap_or_default().to_string_lossy().into_owned();
    Ok(Loaded { name: stem, ..loaded })
}

/// Where and how this was measured.
fn heading() -> String {
    let machine = Machine::here();
    let [cpu, _, isa, compiler, date] = machine.pairs();
    let avx2 = if cfg!(target_feature = "avx2") { "with" } else { "without" };
    let facts = [cpu.1, format!("octogrid's instruction set {}", isa.1), compiler.1, date.1].join(", ");
    format!("# octogrid and its peers\n\n{facts}; compiled {avx2} AVX2 throughout; `{}`", machine.command)
}
