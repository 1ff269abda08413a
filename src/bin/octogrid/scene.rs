//! `octogrid scene`: the built-in scenes as OBJ files.

use std::fs;
use std::path::{Path, PathBuf};

use octogrid::{Model, builtin, obj};

use crate::failure::Failure;
use crate::load;
use crate::output::{Output, folder, say};
use crate::table;

/// Write a built-in scene as an OBJ file with its materials, or list the built-in scenes
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// The name of a built-in scene
    #[arg(required_unless_present = "list")]
    name: Option<String>,
    /// Where the scene goes; the materials go beside it
    #[arg(short, long, value_name = "FILE.obj", required_unless_present = "list")]
    output: Option<PathBuf>,
    /// List the built-in scenes
    #[arg(long, conflicts_with_all = ["name", "output"])]
    list: bool,
}

/// Runs the command.
///
/// # Errors
/// On an unknown name, and where the files can't be written.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let (Some(name), Some(path)) = (&args.name, &args.output) else {
        return say(list());
    };
    let Some(scene) = builtin::by_name(name) else {
        let names = load::names();
        return Err(Failure::Expected(format!("there is no built-in scene '{name}', but {names}")));
    };
    if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("mtl")) {
        return Err(Failure::Usage("the materials get the name FILE.mtl, so the scene needs another".into()));
    }
    save(&(scene.model)(), Output::at(path)?.place()?)
}

fn list() -> impl std::fmt::Display {
    let rows = builtin::all().iter().map(|scene| {
        let triangles = (scene.model)().triangles.len().to_string();
        [scene.name.to_owned(), triangles, scene.description.to_owned()]
    });
    let mut table = table::grid(["scene", "triangles", "description"], rows);
    if let Some(description) = table.column_mut(2) {
        description.set_cell_alignment(comfy_table::CellAlignment::Left);
    }
    table
}

/// Writes the files in a folder of their own and moves them once they are whole, the OBJ file last,
/// since it names the other.
fn save(model: &Model, path: &Path) -> Result<(), Failure> {
    let failure = |e: &dyn std::fmt::Display| Failure::at(path, format_args!("can't write: {e}"));
    let whole = tempfile::tempdir_in(folder(path)).map_err(|e| failure(&e))?;
    let name = path.file_name().unwrap_or(path.as_os_str());
    obj::save_obj(model, &whole.path().join(name)).map_err(|e| failure(&e))?;
    let files = fs::read_dir(whole.path()).and_then(Iterator::collect::<Result<Vec<_>, _>>);
    let mut files = files.map_err(|e| failure(&e))?;
    files.sort_by_key(|file| file.file_name() == name);
    for file in files {
        fs::rename(file.path(), folder(path).join(file.file_name())).map_err(|e| failure(&e))?;
    }
    Ok(())
}
