//! Extremes: hazards, memory, moved scenes and closed meshes; `octogrid report stability` does more of it.
#![cfg(feature = "oracle")]

#[allow(dead_code)]
mod common;

use std::thread;

use octogrid::oracle::extremes::{crowd, identical, moved, turned};
use octogrid::oracle::hazards::{CLOSED, HAZARDS, Hazard, HazardScene, SceneKind};
use octogrid::oracle::meshes::Mesh;
use octogrid::oracle::rays::{hazards, in_turn};
use octogrid::oracle::watertight::{Leaks, Watertight};
use octogrid::oracle::{Agreement, assert_agree, exact};
use octogrid::{BuildError, BuildOptions, Ray, Scene, Structure, TriMesh};

/// More bytes a triangle than any structure with default parameters takes on any scene here; small scenes
/// may take as many as 1,000 triangles.
const MOST_BYTES: usize = 2_000;

fn scenes(hazard: &Hazard) -> impl Iterator<Item = &HazardScene> {
    hazard.scenes.iter().filter(|scene| scene.kind != SceneKind::Huge)
}

fn sound((vertices, triangles): &Mesh) -> TriMesh<'_> {
    TriMesh::new(vertices, triangles).unwrap()
}

#[test]
fn hazards_are_harmless() {
    let agreement = Agreement { exact: 8, decorated: 4, threads: vec![2], ..Agreement::quick() };
    for hazard in &HAZARDS {
        for scene in scenes(hazard) {
            let seeds = if scene.kind == SceneKind::Seeded { 0..3 } else { 0..1 };
            for seed in seeds {
                let mesh = (scene.mesh)(seed);
                let mesh = sound(&mesh);
                let rays = in_turn(hazard.rays, &mesh, seed, 36);
                if let Err(disagreement) = agreement.check(&mesh, &rays) {
                    panic!("{}, {}, seed {seed}: {disagreement}", hazard.name, scene.name);
                }
            }
        }
    }
}

/// Exact distances which round to an end of the interval but are far from it in units of a long direction or beside
/// a large triangle, from origins so near its corner that bounds of errors are small; packets of rays that go alike.
#[test]
fn least_distances_round_to_the_ends_of_intervals() {
    const LEAST: f64 = f32::from_bits(1) as f64;
    let [one, two] = [1, 2].map(f32::from_bits);
    let ends = [(f32::NEG_INFINITY, -0.0), (-one, 0.0), (0.0, one), (one, two), (-0.0, 1.0)];
    let mut rays = Vec::new();
    for length in [1.0, 4.0, 31.0, 34.0, 39.0, 41.0, 80.0, 99.0, 127.0].map(f64::exp2) {
        let near = (LEAST * length) as f32;
        for distance in [-1.5, -0.5, 0.25, 0.5, 0.75, 1.5, 2.25] {
            for i in 0..64 {
                let ray = Ray::new([near * i as f32, near * -distance, near], [0.0, length as f32, 0.0]);
                let (t_min, t_max) = ends[i % ends.len()];
                rays.push(ray.with_interval(t_min, t_max));
            }
        }
    }
    for size in [4.0, 1e18] {
        let mesh = (vec![[0.0; 3], [size, 0.0, 0.0], [0.0, 0.0, size]], vec![[0, 1, 2]]);
        Agreement { exact: rays.len(), ..Agreement::quick() }.assert(&sound(&mesh), &rays);
    }
}

/// An end of an interval that is beyond the largest f32 in units of the scaled direction.
#[test]
fn long_directions_from_far_away_end_at_hits() {
    let mesh = (vec![[0.0; 3], [0.02, 0.0, 0.0], [0.0, 0.02, 0.01]], vec![[0, 1, 2]; 2]);
    let from = Ray::new([0.001, f32::MAX, f32::MAX], [0.0, -(2f32.powi(125)), -(2f32.powi(125))]);
    let rays = [-1.0, 7.0, 8f32.next_down(), 8.0, f32::MAX].map(|t_max| from.with_interval(-2.0, t_max));
    assert_agree(&sound(&mesh), &rays);
    assert!(exact::any(&sound(&mesh), &rays[3]));
}

fn build(mesh: &TriMesh<'_>, structure: Structure, memory_limit: usize) -> Result<Scene, BuildError> {
    Scene::build(mesh, &BuildOptions { structure: Some(structure), memory_limit, ..Default::default() })
}

/// A build that its limit does not allow for says so.
fn assert_refused(name: &str, mesh: &TriMesh<'_>, structure: Structure, limit: usize) {
    match build(mesh, structure, limit) {
        Err(BuildError::MemoryLimit { limit: told, needed }) => assert!(told == limit && needed > limit),
        other => panic!("{name}, {structure}, limit {limit}: {:?}", other.map(|scene| scene.bytes())),
    }
}

/// The bytes of a scene, which are no more than its triangles warrant.
fn bytes(name: &str, mesh: &TriMesh<'_>, structure: Structure) -> usize {
    let most = MOST_BYTES * (mesh.len() + 1_000);
    let scene = build(mesh, structure, 2 * most).unwrap_or_else(|e| panic!("{name}, {structure}: {e}"));
    println!("{name}, {structure}: {} triangles, {} bytes", mesh.len(), scene.bytes());
    assert!(scene.bytes() <= most, "{name}, {structure}: {} bytes", scene.bytes());
    scene.bytes()
}

#[test]
fn builds_keep_to_their_memory() {
    for scene in HAZARDS.iter().flat_map(scenes) {
        let mesh = (scene.mesh)(1);
        let mesh = sound(&mesh);
        for structure in Structure::ALL {
            let bytes = bytes(scene.name, &mesh, structure);
            for limit in [0, bytes / 16, bytes - 1] {
                assert_refused(scene.name, &mesh, structure, limit);
            }
        }
    }
}

/// A hundred thousand and a million triangles in one place, which would take tens of gigabytes if a grid
/// listed all of them in each of its voxels.
#[test]
fn crowds_keep_to_their_memory() {
    type Crowd = fn(usize) -> Mesh;
    let crowds: [(&str, Crowd); 2] =
        [("identical", |n| identical(1, n)), ("in one cell", |n| crowd(1, 10_000, n))];
    thread::scope(|threads| {
        for (name, crowd) in crowds {
            threads.spawn(move || {
                let [some, many] = [100_000, 1_000_000].map(crowd);
                bytes(name, &sound(&many), Structure::HYBRID);
                for structure in Structure::ALL {
                    bytes(name, &sound(&some), structure);
                    assert_refused(name, &sound(&many), structure, 32 << 20);
                }
            });
        }
    });
}

/// Every OBJ file in the folder OCTOGRID_SCENES, scaled, moved or turned; run it in release mode.
#[cfg(feature = "obj")]
#[test]
fn moved_scene_files() {
    let files = common::scene_files();
    if files.is_empty() {
        common::announce("OCTOGRID_SCENES is not set or holds no OBJ file: no moved scenes were tested");
    }
    let agreement = Agreement { exact: 3, decorated: 3, threads: Vec::new(), ..Agreement::quick() };
    for (i, path) in files.iter().enumerate() {
        let model = octogrid::obj::read_obj(path).unwrap_or_else(|error| panic!("{error}"));
        let mesh = (model.vertices, model.triangles);
        let size = mesh.0.as_flattened().iter().fold(0.0f64, |a, &x| a.max(f64::from(x).abs()));
        let (how, mesh) = match i % 4 {
            0 => ("scaled to 1e-18", moved(&mesh, |v| 1e-18 / size * v)),
            1 => ("scaled to 1e18", moved(&mesh, |v| 1e18 / size * v)),
            2 => ("moved by 1e6 sizes", moved(&mesh, |v| v + 1e6 * size)),
            _ => ("turned", turned(&mesh, 1)),
        };
        let mesh = sound(&mesh);
        if let Err(disagreement) = agreement.check(&mesh, &hazards(&mesh, 1, 48)) {
            panic!("{} {how}: {disagreement}", path.display());
        }
    }
}

/// 10^6 rays in all.
#[test]
fn closed_meshes_are_watertight() {
    let rays = thread::scope(|threads| {
        let send = |scene: &'static HazardScene| threads.spawn(|| rays_of(scene));
        let sent: Vec<_> = CLOSED.iter().map(send).collect();
        sent.into_iter().map(|thread| thread.join().unwrap()).sum::<usize>()
    });
    assert!(rays > 1_000_000, "{rays}");
}

/// Sends rays in a closed mesh, and returns how many.
fn rays_of(scene: &HazardScene) -> usize {
    let mesh = (scene.mesh)(1);
    let rays = if mesh.1.len() > 1 << 14 { 1 << 11 } else { 115_000 };
    let Leaks { inside, outside, first, .. } =
        Watertight::new(sound(&mesh), &Structure::ALL).unwrap().check(1, rays);
    if let Some(disagreement) = first {
        panic!("{}: {disagreement}", scene.name);
    }
    assert!(inside > rays / 2 && outside > rays / 16, "{}: {inside} inside, {outside} outside", scene.name);
    inside + outside
}
