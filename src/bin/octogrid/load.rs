//! From the name on the command line to triangles and their structure.

use std::path::Path;
use std::time::Instant;

use octogrid::builtin::{self, Camera};
use octogrid::{BuildOptions, Model, Scene};

use crate::failure::Failure;
use crate::saved;

/// A scene by its name.
pub(crate) struct Loaded {
    /// As on the command line.
    pub(crate) name: String,
    /// The triangles.
    pub(crate) model: Model,
    /// The cameras of a built-in scene.
    pub(crate) cameras: &'static [Camera],
}

/// Makes a built-in scene or reads an OBJ file; a built-in name wins.
///
/// # Errors
/// Where the file can't be read or used.
pub(crate) fn load(name: &str) -> Result<Loaded, Failure> {
    if let Some(scene) = builtin::by_name(name) {
        return Ok(Loaded { name: name.to_owned(), model: (scene.model)(), cameras: scene.cameras });
    }
    let path = Path::new(name);
    if !path.exists() {
        let names = names();
        return Err(Failure::at(path, format_args!("no such file, nor a built-in scene ({names})")));
    }
    if saved::is_named(path) {
        let remedy = "give the scene that it was built from; render takes this file with --accel";
        return Err(Failure::at(path, format_args!("holds a structure, no scene: {remedy}")));
    }
    let model = octogrid::obj::read_obj(path)?;
    model.mesh().map_err(|e| Failure::at(path, e))?;
    Ok(Loaded { name: name.to_owned(), model, cameras: &[] })
}

/// The names of the built-in scenes, separated by commas.
pub(crate) fn names() -> String {
    builtin::all().iter().map(|b| b.name).collect::<Vec<_>>().join(", ")
}

/// A scene and the milliseconds that its build took.
///
/// # Errors
/// As [`Scene::build`].
pub(crate) fn build(model: &Model, options: &BuildOptions) -> Result<(Scene, f64), Failure> {
    let mesh = model.mesh()?;
    let start = Instant::now();
    let scene = Scene::build(&mesh, options)?;
    Ok((scene, start.elapsed().as_secs_f64() * 1e3))
}

/// The bytes of the structure a triangle; 0 where there is none.
pub(crate) fn bytes_per_triangle(scene: &Scene) -> f64 {
    scene.bytes() as f64 / scene.triangles().max(1) as f64
}
