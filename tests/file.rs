//! Saving and loading: the same scene again, or a typed error, whatever a file holds.
#![cfg(all(feature = "file", feature = "oracle"))]

#[allow(dead_code)]
mod common;

use std::io::{self, ErrorKind, Read};

use octogrid::oracle::extremes::crowd;
use octogrid::oracle::meshes::{Mesh, closed_mesh};
use octogrid::oracle::{Agreement, forge, rays::hazards};
use octogrid::{
    Hit, HybridParams, LoadError, MeshMismatch, Ray, RecursiveParams, Scene, Structure, TriMesh, builtin,
};

/// Where the sections start.
const HEADER: usize = 192;

fn build((vertices, triangles): &Mesh, structure: Structure) -> Scene {
    let mesh = TriMesh::new(vertices, triangles).unwrap();
    Scene::build(&mesh, &structure.into()).unwrap()
}

fn saved(scene: &Scene) -> Vec<u8> {
    let mut file = Vec::new();
    scene.save(&mut file).unwrap();
    file
}

#[track_caller]
fn error(file: &[u8]) -> LoadError {
    match Scene::load(file) {
        Err(error) => error,
        Ok(_) => panic!("it was loaded"),
    }
}

fn one_triangle() -> Mesh {
    (vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])
}

/// Small files of both forms, with divided voxels where there are more than one triangle.
fn small_files() -> [Vec<u8>; 3] {
    let list = Structure::Recursive(RecursiveParams { threshold: 2, divisions: 2, top_grid: false });
    let (density, levels) = (1e-3, 1);
    let bricks = HybridParams { density, levels, group_cost: 10.0, brick_cost: 0.0, voxel_cost: 0.0 };
    let crowd = crowd(1, 50, 100);
    let divided = [list, Structure::Hybrid(bricks)].map(|structure| build(&crowd, structure));
    assert!(divided.iter().all(|scene| scene.validate().unwrap().depth > 0));
    let [list, bricks] = divided;
    [build(&one_triangle(), Structure::UNIFORM), list, bricks].map(|scene| saved(&scene))
}

#[test]
fn a_loaded_scene_has_the_same_bits() {
    let empty: Mesh = (vec![], vec![]);
    let flat: Mesh = (vec![[1.0, 2.0, 3.0]], vec![[0, 0, 0]; 20]);
    let mut meshes = vec![empty, flat, one_triangle()];
    meshes.extend(common::small_scenes().into_iter().map(|(_, mesh)| mesh));
    meshes.extend(common::builtin_scenes().map(|(_, mesh)| mesh).filter(|mesh| mesh.1.len() <= 100_000));
    for mesh in &meshes {
        for structure in Structure::ALL {
            let scene = build(mesh, structure);
            let file = saved(&scene);
            // What follows is left alone.
            let mut stream = &[&file[..], b"more"].concat()[..];
            let loaded = Scene::load(&mut stream).unwrap();
            assert_eq!(stream, b"more");
            assert!(saved(&loaded) == file && file.len().is_multiple_of(64), "{structure}");
            assert_eq!(loaded.structure(), structure);
            assert_eq!((loaded.triangles(), loaded.bytes()), (scene.triangles(), scene.bytes()));
            assert_eq!(loaded.validate(), scene.validate());
            assert_eq!(loaded.check_mesh(&TriMesh::new(&mesh.0, &mesh.1).unwrap()), Ok(()));
        }
    }
}

#[test]
fn loaded_scenes_agree_with_the_oracle() {
    for (name, (vertices, triangles)) in common::small_scenes() {
        let mesh = TriMesh::new(&vertices, &triangles).unwrap();
        let subjects = Agreement::thorough().build(&mesh).unwrap().reload().unwrap();
        let report = subjects.check(&hazards(&mesh, 1, 100)).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert!(report.comparisons > 1000);
    }
}

fn assert_same_hits(scene: &Scene, mesh: &TriMesh<'_>) {
    let built = Scene::build(mesh, &Default::default()).unwrap();
    for ray in hazards(mesh, 1, 200) {
        assert_eq!(scene.closest(&ray), built.closest(&ray), "{ray:?}");
    }
}

/// Fails if a type of the arena changes and the version does not.
#[test]
fn a_file_of_version_3_is_read() {
    let file: &[u8] = include_bytes!("../fuzz/regressions/ogrid/cube_hybrid");
    let cube = builtin::cube();
    let (scene, mesh) = (Scene::load(file).unwrap(), cube.mesh().unwrap());
    assert_eq!(scene.check_mesh(&mesh), Ok(()));
    assert_same_hits(&scene, &mesh);

    let file: &[u8] = include_bytes!("../fuzz/regressions/ogrid/clumps_bricks");
    let (vertices, triangles) = crowd(1, 50, 100);
    let (scene, mesh) = (Scene::load(file).unwrap(), TriMesh::new(&vertices, &triangles).unwrap());
    assert_eq!(scene.check_mesh(&mesh), Ok(()));
    assert_eq!(scene.validate().unwrap().depth, 2);
    assert_same_hits(&scene, &mesh);
}

#[test]
fn a_file_that_ends_early_says_so() {
    for file in small_files() {
        for len in 0..file.len() {
            let error = error(&file[..len]);
            assert!(
                matches!(error, LoadError::Truncated { len: l, .. } if l == len as u64),
                "{len}: {error}"
            );
        }
    }
}

#[test]
fn a_changed_byte_is_an_error() {
    for file in small_files() {
        for at in 0..file.len() {
            for change in [1, 0x80, 0xff] {
                let mut file = file.clone();
                file[at] ^= change;
                let error = error(&file);
                let expected = match (at, &error) {
                    (0..8, LoadError::Foreign) | (8..12, LoadError::Version { .. }) => true,
                    (12..HEADER, LoadError::Damaged { section, start }) => {
                        (*section, *start) == ("header", 0)
                    }
                    (HEADER.., LoadError::Damaged { start, .. }) => *start >= 192 && *start <= at as u64,
                    _ => false,
                };
                assert!(expected, "byte {at}: {error}");
            }
        }
    }
}

#[test]
fn foreign_and_newer_files_are_told_apart() {
    for foreign in [&b"# Blender v2.79\nv 0 0 0\n"[..], b"\x89PNG\r\n\x1a\n", b"v", &[0; 1000]] {
        let error = error(foreign);
        assert!(matches!(error, LoadError::Foreign), "{error}");
    }
    let [mut newer, ..] = small_files();
    newer[8] = 4;
    newer.truncate(20); // as its header may have another size
    let error = error(&newer);
    assert!(matches!(error, LoadError::Version { found: 4 }));
    assert!(error.to_string().contains("update octogrid"), "{error}");
}

/// A word at a time, in files whose checksums are right: an error, or a scene whose queries end.
#[test]
fn forged_files_are_errors_or_scenes() {
    let values = [0, 1, 2, 9, 0x3f80_0000, 0x7f80_0000, 0x7fff_ffff, 1 << 31, 0x8000_0001, u32::MAX];
    let rays = hazards(&builtin::sphere(12, 10).mesh().unwrap(), 1, 20);
    let mut counts = [0; 2];
    for file in small_files() {
        // Past the start and the version; later words get three of the values in turns.
        for at in (12..file.len()).step_by(4) {
            let taken = if at < 2000 { values.len() } else { 3 };
            for i in 0..taken {
                let mut file = file.clone();
                file[at..at + 4].copy_from_slice(&values[(at / 4 * 3 + i) % values.len()].to_le_bytes());
                forge::seal(&mut file);
                let loaded = Scene::load(&file[..]);
                counts[usize::from(loaded.is_ok())] += 1;
                loaded.into_iter().for_each(|scene| ask(&scene, &rays));
            }
        }
    }
    assert!(counts[0] > 1000 && counts[1] > 1000, "{counts:?}");
}

/// Every query; hits must be of the scene.
fn ask(scene: &Scene, rays: &[Ray]) {
    for ray in rays {
        let hit = scene.closest(ray);
        assert!(!hit.is_hit() || (hit.prim as usize) < scene.triangles(), "{ray:?}: {hit:?}");
        scene.occluded(ray);
        scene.all(ray, &mut [Hit::MISS; 4]);
    }
}

/// Bricks within bricks, as deep as walks can follow and deeper.
#[test]
fn structures_are_not_too_deep() {
    let file = saved(&build(
        &one_triangle(),
        Structure::Hybrid(HybridParams { levels: 8, ..HybridParams::DEFAULT }),
    ));
    let (start, boxes) = (HEADER + 320, file.len() - 448);
    let rays = hazards(&builtin::triangle().mesh().unwrap(), 1, 100);
    for levels in 1..12u32 {
        // The first voxel of each brick holds the next brick, and the last one the leaf.
        let words: Vec<u32> = (1..=levels).chain([1 << 31]).collect();
        let [zero, one] = [0f32, 1.0].map(|x| [x.to_bits(); 4]);
        let brick = |first| [zero, one, [1, 0, first, 0]].concat();
        let bricks: Vec<u32> = (1..=levels).flat_map(brick).collect();
        let mut deep = file[..start].to_vec();
        for (words, item, section) in [(&words, 1, 1), (&bricks, 12, 3)] {
            let items = words.len() as u64 / item;
            deep[104 + 16 * section..][..8].copy_from_slice(&items.to_le_bytes());
            deep.extend(words.iter().flat_map(|word| word.to_le_bytes()));
            deep.resize(deep.len().next_multiple_of(64), 0);
        }
        deep.extend(&file[boxes..]);
        forge::seal(&mut deep);
        match Scene::load(&deep[..]) {
            Ok(scene) if levels <= 8 => ask(&scene, &rays),
            Err(error) if levels > 8 => assert!(error.to_string().contains("more than 8 levels"), "{error}"),
            result => panic!("{levels} levels: {:?}", result.map(|_| ())),
        }
    }
}

/// A claim of any length takes no more memory than there are bytes.
#[test]
fn claims_are_not_believed() {
    for file in small_files() {
        for (section, name) in ["clusters", "voxels", "references", "bricks", "boxes"].into_iter().enumerate()
        {
            for claim in [1u64 << 20, 1 << 31, 1 << 40, u64::MAX] {
                let mut file = file.clone();
                file[104 + 16 * section..][..8].copy_from_slice(&claim.to_le_bytes());
                forge::seal(&mut file);
                let error = error(&file);
                assert!(matches!(error, LoadError::Truncated { section, .. } if section == name), "{error}");
            }
        }
        let mut file = file.clone();
        file[48..56].copy_from_slice(&(TriMesh::MAX_TRIANGLES as u64).to_le_bytes());
        forge::seal(&mut file);
        let scene = Scene::load(&file[..]).unwrap();
        assert_eq!(scene.triangles(), TriMesh::MAX_TRIANGLES);
        assert!(scene.validate().is_ok());
    }
}

#[test]
fn invalid_structures_say_what_is_wrong() {
    let [_, list, bricks] = small_files();
    let voxels = |file: &[u8]| HEADER + 320 * u64::from_le_bytes(file[104..112].try_into().unwrap()) as usize;
    let ones = u32::MAX.to_le_bytes();
    for (file, at, bytes, said) in [
        (&list, 12, [9, 0, 0, 0], "structure 9"),
        (&list, 20, [1, 0, 0, 0], "divisions"),
        (&list, 28, [1, 0, 0, 0], "unknown"),
        (&list, 84, [0xff; 4], "cell"),
        (&list, 60, [0xff; 4], "lower corner"),
        (&list, 88, [0xff; 4], "top grid"),
        (&list, 100, [1, 0, 0, 0], "padding"),
        (&list, 116, [1, 0, 0, 0], "padding"),
        (&list, 48, [1, 0, 0, 0], "out of range"),
        (&list, HEADER, ones, "corners of cluster 0"),
        (&list, voxels(&list), [1, 0, 0, 0], "used twice"),
        (&list, voxels(&list), [0; 4], "not used"),
        (&bricks, voxels(&bricks), ones, "out of range"),
    ] {
        let mut file = file.clone();
        file[at..at + 4].copy_from_slice(&bytes);
        forge::seal(&mut file);
        let error = error(&file);
        assert!(matches!(error, LoadError::Invalid(_)) && error.to_string().contains(said), "{at}: {error}");
    }
}

/// Gives a byte at a time, and is interrupted before each; fails in the end.
struct Slow<'a>(&'a [u8], bool);

impl Read for Slow<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.1 = !self.1;
        if self.1 {
            return Err(ErrorKind::Interrupted.into());
        }
        if self.0.is_empty() {
            return Err(ErrorKind::ConnectionReset.into());
        }
        self.0.read(&mut buffer[..1])
    }
}

#[test]
fn slow_and_broken_streams() {
    for file in small_files() {
        assert!(Scene::load(Slow(&file, false)).is_ok());
        let error = Scene::load(Slow(&file[..file.len() - 1], false)).err();
        assert!(matches!(error, Some(LoadError::Io(e)) if e.kind() == ErrorKind::ConnectionReset));
    }
}

#[test]
fn a_scene_knows_its_mesh() {
    let (mut vertices, mut triangles) = closed_mesh(2, 2);
    let (line, last) = (vertices.len() as u32, triangles.len());
    vertices.extend([[0.0; 3], [1.0; 3], [2.0; 3]]);
    triangles.push([line, line + 1, line + 2]);
    let scene = build(&(vertices.clone(), triangles.clone()), Structure::HYBRID);
    let check =
        |vertices: &[_], triangles: &[_]| scene.check_mesh(&TriMesh::new(vertices, triangles).unwrap());
    assert_eq!(check(&vertices, &triangles), Ok(()));
    let fewer = MeshMismatch::Count { scene: last + 1, mesh: last };
    assert_eq!(check(&vertices, &triangles[..last]), Err(fewer));
    triangles.swap(0, 1);
    assert!(matches!(check(&vertices, &triangles), Err(MeshMismatch::Triangle { triangle: 0 | 1 })));
    triangles.swap(0, 1);
    // What was a line no longer is one.
    vertices[line as usize + 2] = [2.0, 2.0, 2.0f32.next_up()];
    assert_eq!(check(&vertices, &triangles), Err(MeshMismatch::Triangle { triangle: last as u32 }));
}
