//! Wavefront OBJ files.

use std::fs;

use octogrid::obj::{ObjError, read_obj, save_obj};
use octogrid::{Model, Scene};

/// An OBJ text and, after a `~`, that of `a.mtl` beside it: what is read is a mesh, can be built,
/// and is the same after it was written and read again.
pub fn obj(data: &[u8]) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let [read, written] = ["read.obj", "written.obj"].map(|name| folder.path().join(name));
    for (name, text) in ["read.obj", "a.mtl"].into_iter().zip(data.splitn(2, |&byte| byte == b'~')) {
        fs::write(folder.path().join(name), text).expect("the folder can be written");
    }
    let Ok(model) = read_obj(&read) else { return };
    let mesh = model.mesh().expect("what is read is a mesh");
    Scene::build(&mesh, &Default::default()).unwrap().validate().unwrap();
    match save_obj(&model, &written) {
        Ok(()) => assert_eq!(content(&read_obj(&written).unwrap()), content(&model)),
        Err(ObjError::MaterialName(_)) => {}
        Err(error) => panic!("{error}"),
    }
}

/// All but unused vertices and the numbers of the others.
fn content(model: &Model) -> impl PartialEq + std::fmt::Debug + use<'_> {
    let corners = model.triangles.iter().map(|t| t.map(|i| model.vertices[i as usize].map(f32::to_bits)));
    (corners.collect::<Vec<_>>(), &model.materials, &model.material_ids)
}
