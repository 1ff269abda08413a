//! OBJ files: what is written reads back as the same bits, and no input is worse than an error.
#![cfg(feature = "obj")]

use std::fs;
use std::path::{Path, PathBuf};

use octogrid::obj::{ObjError, read_obj, save_obj};
use octogrid::{Material, Model, builtin};
use tempfile::TempDir;

/// A folder with the file `scene.obj`.
fn folder(obj: &[u8]) -> (TempDir, PathBuf) {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("scene.obj");
    fs::write(&path, obj).unwrap();
    (folder, path)
}

fn read(obj: impl AsRef<[u8]>) -> Result<Model, ObjError> {
    let (_folder, path) = folder(obj.as_ref());
    read_obj(&path)
}

/// The model of an OBJ file with `mtllib a.mtl` and that MTL file.
fn read_with_mtl(obj: &str, mtl: impl AsRef<[u8]>) -> Result<Model, ObjError> {
    let (folder, path) = folder(format!("mtllib a.mtl\n{obj}").as_bytes());
    fs::write(folder.path().join("a.mtl"), mtl).unwrap();
    read_obj(&path)
}

/// The bits of the corners of all triangles.
fn corner_bits(model: &Model) -> Vec<[[u32; 3]; 3]> {
    let bits = |v: u32| model.vertices[v as usize].map(f32::to_bits);
    model.triangles.iter().map(|corners| corners.map(bits)).collect()
}

/// The x coordinates of the corners, which tell the vertices of the small tests apart.
fn corner_xs(model: &Model) -> Vec<[i32; 3]> {
    let x = |v: u32| model.vertices[v as usize][0] as i32;
    model.triangles.iter().map(|corners| corners.map(x)).collect()
}

fn names(model: &Model) -> Vec<&str> {
    (0..model.triangles.len() as u32).map(|t| model.material(t).unwrap().name.as_str()).collect()
}

/// An OBJ file of five vertices, whose x is their index, and more lines.
fn five(rest: &str) -> String {
    format!("v 1 0 0\nv 2 0 0\nv 3 1 0\nv 4 1 1\nv 5 0 1\n{rest}")
}

#[test]
fn round_trip_keeps_bits_order_and_materials() {
    let folder = TempDir::new().unwrap();
    for scene in builtin::all() {
        let model = (scene.model)();
        let path = folder.path().join(format!("{} 1.obj", scene.name));
        save_obj(&model, &path).unwrap();
        let read = read_obj(&path).unwrap();
        assert!(corner_bits(&read) == corner_bits(&model), "{}", scene.name);
        assert!(read.materials == model.materials, "{}", scene.name);
        assert!(read.material_ids == model.material_ids, "{}", scene.name);
        assert_eq!(read.lights(), model.lights(), "{}", scene.name);
    }
    let mut files = fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name());
    assert!(files.all(|name| !name.to_string_lossy().ends_with(".tmp")));
}

#[test]
fn extreme_numbers_keep_their_bits() {
    let tiny = f32::from_bits(1);
    let model = Model {
        vertices: vec![[f32::MAX, -0.0, tiny], [f32::MIN, f32::MIN_POSITIVE, 0.1], [1e-18, 1e18, 1.0 / 3.0]],
        triangles: vec![[2, 0, 1], [0, 0, 1]],
        ..Model::default()
    };
    let (_folder, path) = folder(b"");
    save_obj(&model, &path).unwrap();
    let read = read_obj(&path).unwrap();
    assert_eq!(corner_bits(&read), corner_bits(&model));
    assert!(read.materials.is_empty() && read.material_ids.is_empty());
    assert!(!path.with_extension("mtl").exists());
}

#[test]
fn polygons_are_fans_in_file_order() {
    let model = read(five("f 1 2 3 4 5\nf 5 4 3\nf 2 3 4 1\n")).unwrap();
    assert_eq!(corner_xs(&model), [[1, 2, 3], [1, 3, 4], [1, 4, 5], [5, 4, 3], [2, 3, 4], [2, 4, 1]]);
}

#[test]
fn indices_may_be_negative_or_ahead() {
    let model = read(five("f -5 -4 -1\nf 6 7 1\nv 6 0 0\nf -6 -1 1\nv 7 0 0\n")).unwrap();
    assert_eq!(corner_xs(&model), [[1, 2, 5], [6, 7, 1], [1, 6, 1]]);
}

#[test]
fn corners_with_texture_and_normal_share_vertices() {
    let faces = "vt 0 0\nvt 1 0\nvn 0 0 1\nf 1/1/1 2/2/-1 3//1\nf 1/2 3 4//1\nf -5/-1/-1 2/1/ 3/-2\n";
    let model = read(five(faces)).unwrap();
    assert_eq!(corner_xs(&model), [[1, 2, 3], [1, 3, 4], [1, 2, 3]]);
    assert_eq!(model.vertices.len(), 4);
}

#[test]
fn interleaved_materials_and_groups_keep_file_order() {
    let faces = "f 1 2 3\nusemtl b\no x\nf 2 3 4\nusemtl a\ng y\nf 3 4 5\nf 1 3 5\nusemtl b\ns 1\nf 1 4 5\n";
    let mtl = "newmtl a\nKd 1 0 0\nnewmtl b\nKd 0 1 0\n";
    let model = read_with_mtl(&five(&format!("{faces}usemtl c\n")), mtl).unwrap();
    assert_eq!(corner_xs(&model), [[1, 2, 3], [2, 3, 4], [3, 4, 5], [1, 3, 5], [1, 4, 5]]);
    assert_eq!(names(&model), ["default", "b", "a", "a", "b"]);
    assert_eq!(model.material(1).unwrap().diffuse, [0.0, 1.0, 0.0]);
    assert_eq!(model.vertices.len(), 5);
}

#[test]
fn materials_are_read_and_brought_into_range() {
    let mtl = "# lamp\nKd 9\nnewmtl my lamp #1\n Kd 2 0.5 -1\nKs 1\nKe 5 -1 0\nTr 0.25\nillum x\n\
               newmtl grey\nKd .5\nd -halo 1.5 # too much\nTr 0.5\n";
    let model = read_with_mtl(&five("\tusemtl my lamp #1\nf 1 2 3\nusemtl\tgrey\nf 1 2 3\n"), mtl).unwrap();
    let lamp = Material {
        name: "my lamp #1".to_owned(),
        diffuse: [1.0, 0.5, 0.0],
        emission: [5.0, 0.0, 0.0],
        opacity: 0.75,
    };
    assert_eq!(model.material(0), Some(&lamp));
    assert_eq!(model.material(1), Some(&Material::diffuse("grey", [0.5; 3])));
}

#[test]
fn missing_or_outer_libraries_give_default_materials() {
    for library in ["none.mtl", "../a.mtl", "/etc/passwd", ".", ""] {
        let model = read(five(&format!("mtllib {library}\nusemtl a\nf 1 2 3\n"))).unwrap();
        assert_eq!(model.materials, [Material { name: "a".to_owned(), ..Material::default() }], "{library}");
    }
}

#[test]
fn a_library_outside_of_the_folder_is_not_read() {
    let outer = TempDir::new().unwrap();
    fs::write(outer.path().join("a.mtl"), "newmtl a\nKd 0 0 0\n").unwrap();
    fs::create_dir(outer.path().join("inner")).unwrap();
    let path = outer.path().join("inner/scene.obj");
    fs::write(&path, five("mtllib ../a.mtl\nusemtl a\nf 1 2 3\n")).unwrap();
    assert_eq!(read_obj(&path).unwrap().material(0).unwrap().diffuse, Material::default().diffuse);
}

#[test]
fn a_library_line_may_name_several_files() {
    let (folder, path) = folder(five("mtllib a.mtl none.mtl sub/b.mtl\nusemtl b\nf 1 2 3\n").as_bytes());
    fs::create_dir(folder.path().join("sub")).unwrap();
    fs::write(folder.path().join("a.mtl"), "newmtl a\n").unwrap();
    fs::write(folder.path().join("sub/b.mtl"), "newmtl b\nKd 0 0 1\n").unwrap();
    let model = read_obj(&path).unwrap();
    assert_eq!(model.materials.len(), 2);
    assert_eq!(model.material(0).unwrap().diffuse, [0.0, 0.0, 1.0]);
}

/// Each input with the number of its triangles.
#[test]
fn odd_but_sound_inputs_are_accepted() {
    let cases: Vec<(Vec<u8>, usize)> = vec![
        (b"".to_vec(), 0),
        (b"\n\n# nothing\n".to_vec(), 0),
        (five("").into(), 0),
        (five("f 1 2 3").into(), 1),
        (five("f 1 2 3").replace('\n', "\r\n").into(), 1),
        (format!("\u{feff}{}", five("f 1 2 3")).into(), 1),
        (five("f 1 2 \\\n 3 4 \\\r\n 5\n").into(), 3),
        (five("f 1 2 3\\").into(), 1),
        (five("f 1 2 3 # the first\n  f\t1 2 4").into(), 2),
        (five("f 1 1 1").into(), 1),
        (five("p 1\nl 1 2\nl 1 2 3 4\nl 9 9 9 9\n").into(), 0),
        (five("curv 1 2 3\nvp 1 2\nwhatever\n").into(), 0),
        (five("vt nan\nvn inf 1e999 x\nf 1 2 3").into(), 1),
        (b"v 1 2 3 2\nv 1 2 3 0.5 0.5 0.5\nv 1. +2 .3e1\nf 1 2 3".to_vec(), 1),
        ([five("").as_bytes(), b"# caf\xe9\nusemtl caf\xe9\nf 1 2 3"].concat(), 1),
    ];
    for (input, triangles) in cases {
        let shown = String::from_utf8_lossy(&input).into_owned();
        let model = read(&input).unwrap_or_else(|error| panic!("{shown:?}: {error}"));
        assert_eq!(model.triangles.len(), triangles, "{shown:?}");
        assert!(model.mesh().is_ok(), "{shown:?}");
    }
}

#[test]
fn weights_divide_the_coordinates() {
    let model = read("v 1 2 3 2\nv 0 0 0\nv 1 0 0\nf 1 2 3\n").unwrap();
    assert_eq!(model.vertices[0], [0.5, 1.0, 1.5]);
}

#[test]
fn faults_are_errors_with_their_line() {
    let cases: &[(&str, &str)] = &[
        ("v 0 0\n", "scene.obj:1: expected 3, 4 or 6 numbers, found 2"),
        ("\nv\n", "scene.obj:2: expected 3, 4 or 6 numbers, found 0"),
        ("v 1 2 3 4 5\n", "found 5"),
        ("v 1 2 3 4 5 6 7\n", "found 7"),
        ("v 0 zero 0\n", "\"zero\" is not a number"),
        ("v 1,5 0 0\n", "\"1,5\" is not a number"),
        ("v 0 0 nan\n", "\"nan\" is not a finite"),
        ("v 0 -inf 0\n", "\"-inf\" is not a finite"),
        ("v 0 1e999 0\n", "\"1e999\" is not a finite"),
        ("v 0 1e39 0\n", "\"1e39\" is not a finite"),
        ("v 1 2 3 0\n", "weight of a vertex must not be zero"),
        ("v 1 2 3 nan\n", "\"nan\" is not a finite"),
        ("v 1 1e38 3 1e-10\n", "\"1e38 / 1e-10\" is not a finite"),
        ("v 0 0 0\rv 1 0 0\rv 0 1 0\r", "expected 3, 4 or 6 numbers"),
        ("f\n", "at least 3 corners, found 0"),
        ("v 0 0 0\nf 1\n", ":2: a face needs at least 3 corners, found 1"),
        ("v 0 0 0\nf 1 1\n", ":2: a face needs at least 3 corners, found 2"),
        ("v 0 0 0\nf 1 1 2\n\n", ":2: vertex 2 does not exist: the file has 1"),
        ("f 1 2 3\n", ":1: vertex 3 does not exist"),
        ("v 0 0 0\nf 1 0 1\n", ":2: vertex 0 does not exist"),
        ("v 0 0 0\nf 1 1 -2\n", ":2: vertex -2 does not exist"),
        ("v 0 0 0\nf 1/1 1/1 1/1\n", "texture coordinate 1 does not exist"),
        ("v 0 0 0\nvt 0 0\nf 1/-2 1/1 1/1\n", ":3: texture coordinate -2 does not exist"),
        ("v 0 0 0\nvn 0 0 1\nf 1//1 1//1 1//-7\n", ":3: normal -7 does not exist"),
        ("v 0 0 0\nf 1//0 1 1\n", "normal 0 does not exist"),
        ("v 0 0 0\nvt 0 0\nvn 0 0 1\nf 1 1 1/1/1/1\n", "\"1/1/1/1\" is not a corner"),
        ("v 0 0 0\nf 1 1 x\n", ":2: \"x\" is not a corner"),
        ("v 0 0 0\nf 1 1 1.5\n", "\"1.5\" is not a corner"),
        ("v 0 0 0\nf 1 1 /1\n", "\"/1\" is not a corner"),
        ("v 0 0 0\nf 1 1 99999999999999999999\n", "is not a corner"),
        ("v 0 0 0\nf 1 1 9223372036854775807\n", "vertex 9223372036854775807 does not exist"),
        ("v 0 0 0\nf 1 1 -9223372036854775808\n", "vertex -9223372036854775808 does not exist"),
        ("usemtl\n", ":1: a material needs a name"),
        ("v 0 0 0\n\0\n", ":2: this is not text"),
    ];
    for (input, expected) in cases {
        let error = read(input).expect_err(input).to_string();
        assert!(error.contains(expected), "{input:?}: {error}");
        assert!(!error.contains('\n'), "{input:?}: {error}");
    }
}

#[test]
fn faults_of_materials_are_errors_with_their_line() {
    let cases: &[(&str, &str)] = &[
        ("newmtl\n", "a.mtl:1: a material needs a name"),
        ("newmtl a\nKd 1 0\n", "a.mtl:2: expected 1 or 3 numbers, found 2"),
        ("newmtl a\nKd\n", "expected 1 or 3 numbers, found 0"),
        ("newmtl a\nKd 1 2 3 4\n", "found 4"),
        ("newmtl a\nKd spectral x.rfl\n", "\"spectral\" is not a number"),
        ("newmtl a\nKd nan 0 0\n", "\"nan\" is not a finite"),
        ("newmtl a\n\nKe 1e999 0 0\n", "a.mtl:3: \"1e999\" is not a finite"),
        ("newmtl a\nd\n", "expected 1 number, found 0"),
        ("newmtl a\nd inf\n", "\"inf\" is not a finite"),
        ("newmtl a\nTr one\n", "\"one\" is not a number"),
        ("newmtl a\nTr 0 0\n", "expected 1 number, found 2"),
        ("\0", "a.mtl:1: this is not text"),
    ];
    for (mtl, expected) in cases {
        let error = read_with_mtl(&five("usemtl a\nf 1 2 3\n"), mtl).expect_err(mtl).to_string();
        assert!(error.contains(expected), "{mtl:?}: {error}");
    }
}

#[test]
fn random_lines_never_panic() {
    let words = [
        "v ", "f ", "vt ", "vn ", "usemtl ", "mtllib ", "\n", "\nf 1 2 ", "1 ", "-1 ", "/", "1e39 ", "\\",
        "#", "é", "0.5 ",
    ];
    let mut rng = octogrid::Rng::new(5);
    let (_folder, path) = folder(b"");
    for _ in 0..3_000 {
        let tail: String = (0..rng.below(40)).map(|_| words[rng.below(words.len())]).collect();
        fs::write(&path, five(&tail)).unwrap();
        if let Ok(model) = read_obj(&path) {
            assert!(model.mesh().is_ok(), "{tail:?}");
        }
    }
}

#[test]
fn files_that_cannot_be_read_or_written_are_named() {
    let folder = TempDir::new().unwrap();
    let error = read_obj(&folder.path().join("missing.obj")).unwrap_err().to_string();
    assert!(error.starts_with("can't read ") && error.contains("missing.obj"), "{error}");
    assert!(matches!(read_obj(folder.path()), Err(ObjError::Io { action: "read", .. })));
    let nowhere = folder.path().join("no folder").join("a.obj");
    let error = save_obj(&builtin::cube(), &nowhere).unwrap_err().to_string();
    assert!(error.starts_with("can't write ") && error.contains("a.obj"), "{error}");
    assert!(save_obj(&builtin::cube(), &folder.path().join("same.mtl")).is_err());
}

#[test]
fn a_failure_leaves_the_old_files_and_no_drafts() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("cube.obj");
    fs::write(&path, "old").unwrap();
    fs::create_dir(folder.path().join("cube.mtl")).unwrap();
    assert!(save_obj(&builtin::cube(), &path).is_err());
    assert_eq!(fs::read_to_string(&path).unwrap(), "old");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
}

#[test]
fn models_that_cannot_be_written_are_refused() {
    let (_folder, path) = folder(b"old");
    let refuse = |change: fn(&mut Model)| {
        let mut model = builtin::cube();
        change(&mut model);
        let error = save_obj(&model, &path).unwrap_err();
        assert_eq!(fs::read(&path).unwrap(), b"old");
        error
    };
    assert!(matches!(refuse(|m| m.vertices[0][1] = f32::NAN), ObjError::Mesh(_)));
    assert!(matches!(refuse(|m| m.triangles[0][1] = 8), ObjError::Mesh(_)));
    assert!(matches!(refuse(|m| m.material_ids[3] = 1), ObjError::MaterialIds));
    assert!(matches!(refuse(|m| m.material_ids.truncate(3)), ObjError::MaterialIds));
    assert!(matches!(refuse(|m| m.materials[0].name.clear()), ObjError::MaterialName(_)));
    assert!(matches!(refuse(|m| m.materials[0].name = "a\nf 1 1 1".to_owned()), ObjError::MaterialName(_)));
    assert!(matches!(refuse(|m| m.materials.push(m.materials[0].clone())), ObjError::MaterialName(_)));
}

/// Reads every OBJ file of the folder that `OCTOGRID_SCENES` names.
#[test]
fn scenes_of_the_folder_read() {
    let Some(folder) = std::env::var_os("OCTOGRID_SCENES") else {
        println!("OCTOGRID_SCENES is not set: the sweep over its files was skipped");
        return;
    };
    let paths = fs::read_dir(Path::new(&folder)).unwrap().map(|entry| entry.unwrap().path());
    let mut paths: Vec<PathBuf> = paths.filter(|path| path.extension().is_some_and(|e| e == "obj")).collect();
    paths.sort();
    assert!(!paths.is_empty(), "no OBJ file in {}", folder.display());
    for path in paths {
        let model = read_obj(&path).unwrap_or_else(|error| panic!("{error}"));
        println!("{}: {} triangles", path.display(), model.triangles.len());
        assert!(!model.triangles.is_empty() && model.mesh().is_ok(), "{}", path.display());
    }
}
