//! Reading and writing of Wavefront OBJ files with their MTL files.
//!
//! Triangles are numbered in file order over the whole scene; a polygon is a fan about its first
//! corner. Points, lines, curves and unknown keywords are skipped. tobj parses numbers and divides
//! polygons, but it accepts infinite coordinates, takes lines for faces, and panics on some
//! indices; so `fence` checks each line first and hands on only what tobj reads soundly.

mod error;
mod fence;
mod write;

use std::collections::HashMap;
use std::fs;
use std::path::{Component, Path, PathBuf};

pub use error::{ObjError, Problem};
pub use write::{save_obj, write_mtl, write_obj};

use crate::model::{Material, Model};
use fence::Fenced;

/// Reads a scene.
///
/// An MTL file that is missing, or outside of the folder of the OBJ file, is no error: its
/// materials are then the default one under their names. Faces before the first `usemtl` have the
/// material `default`; where no face has a material, `material_ids` is empty.
///
/// # Errors
/// [`ObjError`] names the file and, for faults of content, the line.
pub fn read_obj(path: &Path) -> Result<Model, ObjError> {
    let text = read_text(path)?;
    let fenced = fence::obj(&text).map_err(|(line, problem)| ObjError::at(path, line, problem))?;
    let options = tobj::LoadOptions { triangulate: true, single_index: true, ..Default::default() };
    let no_materials = |_: &Path| Err(tobj::LoadError::OpenFileFailed);
    let (parts, _) = tobj::load_obj_buf(&mut fenced.text.as_bytes(), &options, no_materials)
        .map_err(|error| ObjError::Refused { path: path.to_owned(), reason: error.to_string() })?;
    let mut model = Model::default();
    // Without `o`, `g` and `usemtl` lines there is one part: vertices stay shared over the file.
    for mesh in parts.into_iter().map(|part| part.mesh) {
        model.vertices.extend(mesh.positions.chunks_exact(3).map(|v| [v[0], v[1], v[2]]));
        model.triangles.extend(mesh.indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]));
    }
    assign_materials(&mut model, &fenced, path)?;
    Ok(model)
}

/// The text of a file; a byte sequence that is not UTF-8 can only matter in names.
fn read_text(path: &Path) -> Result<String, ObjError> {
    let bytes = fs::read(path).map_err(|source| ObjError::io("read", path, source))?;
    if let Some(at) = bytes.iter().position(|&byte| byte == 0) {
        let line = 1 + bytes[..at].iter().filter(|&&byte| byte == b'\n').count();
        return Err(ObjError::at(path, line, Problem::NotText));
    }
    let text = String::from_utf8_lossy(&bytes);
    Ok(text.trim_start_matches('\u{feff}').to_owned())
}

fn assign_materials(model: &mut Model, fenced: &Fenced, path: &Path) -> Result<(), ObjError> {
    for library in &fenced.libraries {
        for file in library_files(path, library) {
            model.materials.extend(read_mtl(&file)?);
        }
    }
    if fenced.runs.is_empty() {
        return Ok(());
    }
    let mut ids: HashMap<String, u32> =
        (0..).zip(&model.materials).map(|(id, material)| (material.name.clone(), id)).collect();
    let mut id_of = |name: &str| {
        *ids.entry(name.to_owned()).or_insert_with(|| {
            model.materials.push(Material { name: name.to_owned(), ..Material::default() });
            (model.materials.len() - 1) as u32
        })
    };
    let starts = fenced.runs.iter().map(|&(start, _)| start);
    if starts.clone().next() > Some(0) {
        model.material_ids.resize(fenced.runs[0].0, id_of("default"));
    }
    let ends = starts.skip(1).chain([model.triangles.len()]);
    for ((_, name), end) in fenced.runs.iter().zip(ends) {
        model.material_ids.resize(end, id_of(name));
    }
    Ok(())
}

/// The files that a `mtllib` line names: one whose name may hold spaces, or several.
fn library_files(obj: &Path, names: &str) -> Vec<PathBuf> {
    let inside = |name: &str| {
        let path = Path::new(name);
        let is_below = path.components().all(|c| matches!(c, Component::Normal(_) | Component::CurDir));
        let path = obj.with_file_name("").join(path);
        (is_below && path.is_file()).then_some(path)
    };
    match inside(names) {
        Some(file) => vec![file],
        None => names.split_whitespace().filter_map(inside).collect(),
    }
}

/// Reads the materials of an MTL file: `Kd`, `Ke`, and `d` or else `Tr`, brought into range.
fn read_mtl(path: &Path) -> Result<Vec<Material>, ObjError> {
    let text = read_text(path)?;
    let fenced = fence::mtl(&text).map_err(|(line, problem)| ObjError::at(path, line, problem))?;
    let (materials, _) = tobj::load_mtl_buf(&mut fenced.as_bytes())
        .map_err(|error| ObjError::Refused { path: path.to_owned(), reason: error.to_string() })?;
    Ok(materials.into_iter().map(convert).collect())
}

fn convert(material: tobj::Material) -> Material {
    let plain = Material::default();
    let transparency = material.unknown_param.get("Tr").and_then(|t| t.parse::<f32>().ok());
    let opacity = material.dissolve.or(transparency.map(|t| 1.0 - t)).unwrap_or(plain.opacity);
    Material {
        name: material.name,
        diffuse: material.diffuse.unwrap_or(plain.diffuse).map(|x| x.clamp(0.0, 1.0)),
        emission: material.emissive.unwrap_or(plain.emission).map(|x| x.max(0.0)),
        opacity: opacity.clamp(0.0, 1.0),
    }
}
