//! Scenes for the tests.

use std::fs;
use std::path::PathBuf;

use glam::Vec3;
use octogrid::builtin;
use octogrid::oracle::meshes::{Mesh, closed_mesh, cuboid};

/// Small scenes by name.
pub(crate) fn small_scenes() -> Vec<(String, Mesh)> {
    let closed = (0..5).map(|levels| (format!("closed mesh {levels}"), closed_mesh(levels.into(), levels)));
    closed.chain([("cube".to_owned(), cuboid(Vec3::splat(-1.0), Vec3::ONE))]).collect()
}

/// All built-in scenes by name.
pub(crate) fn builtin_scenes() -> impl Iterator<Item = (&'static str, Mesh)> {
    builtin::all().iter().map(|scene| {
        let model = (scene.model)();
        (scene.name, (model.vertices, model.triangles))
    })
}

/// The OBJ files in the folder that the environment variable OCTOGRID_SCENES names, sorted; none
/// where it is not set.
pub(crate) fn scene_files() -> Vec<PathBuf> {
    let Some(folder) = std::env::var_os("OCTOGRID_SCENES") else {
        return Vec::new();
    };
    let entries = fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    files.retain(|path| path.extension().is_some_and(|extension| extension == "obj"));
    files.sort();
    files
}

/// Says something that the test runner does not hide.
pub(crate) fn announce(message: &str) {
    use std::io::Write;
    writeln!(std::io::stderr(), "{message}").expect("standard error is open");
}
