//! Writing of OBJ and MTL files. Numbers have as many digits as it takes to read the same bits.

use std::collections::HashSet;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::process;
use std::sync::atomic::{AtomicU32, Ordering};

use super::error::ObjError;
use crate::model::Model;

/// Writes the model to `path`, and its materials, if any, to an MTL file of the same name beside
/// it. Each file is complete or not there: it is written under another name and then renamed.
///
/// # Errors
/// [`ObjError::Io`], and the variants on models that can't be written.
pub fn save_obj(model: &Model, path: &Path) -> Result<(), ObjError> {
    check(model)?;
    let mtl = path.with_extension("mtl");
    if mtl == path || file_name(&mtl).contains(char::is_control) {
        return Err(ObjError::io("write", path, io::Error::from(io::ErrorKind::InvalidFilename)));
    }
    let library = if model.materials.is_empty() { None } else { Some(file_name(&mtl)) };
    let obj = Draft::write(path, |out| write_obj(model, library.as_deref(), out))?;
    if library.is_some() {
        Draft::write(&mtl, |out| write_mtl(model, out))?.publish()?;
    }
    obj.publish()
}

/// Writes vertices and triangles, and `usemtl` at each change of material; `library` is the name
/// of the MTL file.
///
/// # Errors
/// Those of `out`.
pub fn write_obj(model: &Model, library: Option<&str>, out: &mut impl Write) -> io::Result<()> {
    if let Some(library) = library {
        writeln!(out, "mtllib {library}")?;
    }
    for [x, y, z] in &model.vertices {
        writeln!(out, "v {x} {y} {z}")?;
    }
    let mut last = None;
    for (i, corners) in model.triangles.iter().enumerate() {
        let id = model.material_ids.get(i);
        if id != last {
            if let Some(material) = model.material(i as u32) {
                writeln!(out, "usemtl {}", material.name)?;
            }
            last = id;
        }
        let [a, b, c] = corners.map(|v| u64::from(v) + 1);
        writeln!(out, "f {a} {b} {c}")?;
    }
    Ok(())
}

/// Writes the materials.
///
/// # Errors
/// Those of `out`.
pub fn write_mtl(model: &Model, out: &mut impl Write) -> io::Result<()> {
    for material in &model.materials {
        writeln!(out, "newmtl {}", material.name)?;
        for (keyword, [r, g, b]) in [("Kd", material.diffuse), ("Ke", material.emission)] {
            writeln!(out, "{keyword} {r} {g} {b}")?;
        }
        writeln!(out, "d {}", material.opacity)?;
    }
    Ok(())
}

fn check(model: &Model) -> Result<(), ObjError> {
    model.mesh().map_err(ObjError::Mesh)?;
    let ids = &model.material_ids;
    let is_complete = ids.is_empty() || ids.len() == model.triangles.len();
    if !is_complete || ids.iter().any(|&id| id as usize >= model.materials.len()) {
        return Err(ObjError::MaterialIds);
    }
    let mut names = HashSet::new();
    for name in model.materials.iter().map(|material| &material.name) {
        let is_plain = !name.is_empty() && name.trim() == name && !name.ends_with('\\');
        if !is_plain || name.contains(char::is_control) || !names.insert(name) {
            return Err(ObjError::MaterialName(name.clone()));
        }
    }
    Ok(())
}

fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// A file under a temporary name in the folder of its target; removed unless published.
struct Draft {
    draft: PathBuf,
    target: PathBuf,
}

impl Draft {
    fn write(
        target: &Path,
        content: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
    ) -> Result<Self, ObjError> {
        static NUMBER: AtomicU32 = AtomicU32::new(0);
        let number = NUMBER.fetch_add(1, Ordering::Relaxed);
        let name = format!(".{}.{}-{number}.tmp", file_name(target), process::id());
        let draft = Self { draft: target.with_file_name(name), target: target.to_owned() };
        let write = || {
            let mut out = BufWriter::new(File::create_new(&draft.draft)?);
            content(&mut out)?;
            out.flush()
        };
        write().map_err(|source| ObjError::io("write", target, source))?;
        Ok(draft)
    }

    fn publish(self) -> Result<(), ObjError> {
        fs::rename(&self.draft, &self.target).map_err(|source| ObjError::io("write", &self.target, source))
    }
}

impl Drop for Draft {
    fn drop(&mut self) {
        // Nothing is left of it after a rename, and nothing can be done about a failure.
        let _ = fs::remove_file(&self.draft);
    }
}
