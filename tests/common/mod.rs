//! Scenes for the tests.

use std::fs;
use std::path::{Path, PathBuf};

use glam::Vec3;
use octogrid::Model;
use octogrid::oracle::meshes::{Mesh, closed_mesh, cuboid};

/// Small scenes by name.
pub(crate) fn generated_scenes() -> Vec<(String, Mesh)> {
    let closed = (0..5).map(|levels| (format!("closed mesh {levels}"), closed_mesh(levels.into(), levels)));
    closed.chain([("cube".to_owned(), cuboid(Vec3::splat(-1.0), Vec3::ONE))]).collect()
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

/// Reads the lines `v x y z` and `f a b c` of an OBJ file and skips the others.
pub(crate) fn read_obj(path: &Path) -> Model {
    let text = fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let mut model = Model::default();
    for line in text.lines() {
        match *line.split_whitespace().collect::<Vec<_>>() {
            ["v", x, y, z] => model.vertices.push([x, y, z].map(|x| x.parse().unwrap())),
            ["f", a, b, c] => model.triangles.push([a, b, c].map(|i| i.parse::<u32>().unwrap() - 1)),
            _ => {}
        }
    }
    model
}
