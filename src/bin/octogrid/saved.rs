//! Structures that `octogrid build` has saved.

use std::fs::File;
use std::path::Path;
use std::time::Instant;

use octogrid::{Model, Scene};

use crate::failure::Failure;

/// Whether that is how files of structures are named.
pub(crate) fn is_named(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("ogrid"))
}

/// A structure and the milliseconds that it took to load.
///
/// # Errors
/// Where the file can't be read or holds something else.
pub(crate) fn load(path: &Path) -> Result<(Scene, f64), Failure> {
    let start = Instant::now();
    let file = File::open(path).map_err(|e| Failure::at(path, e))?;
    let scene = Scene::load(file).map_err(|e| Failure::at(path, e))?;
    Ok((scene, start.elapsed().as_secs_f64() * 1e3))
}

/// The same, if it is that of `model`.
///
/// # Errors
/// Where it is not, besides.
pub(crate) fn load_for(path: &Path, model: &Model) -> Result<(Scene, f64), Failure> {
    let (scene, ms) = load(path)?;
    scene.check_mesh(&model.mesh()?).map_err(|e| Failure::at(path, e))?;
    Ok((scene, ms))
}
