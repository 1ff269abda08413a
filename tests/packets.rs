//! Rays that go alike, in packets and streams, against brute force.
#![cfg(feature = "oracle")]

mod common;

use octogrid::oracle::meshes::{Mesh, MeshKind, random_mesh};
use octogrid::oracle::rays::{RaySet, companions, hazards};
use octogrid::oracle::{Agreement, assert_agree};
use octogrid::{Hit, Ray, Scene, TriMesh};

fn assert_on_companions((vertices, triangles): &Mesh, seed: u64, rays: usize, each: usize) {
    let mesh = TriMesh::new(vertices, triangles).unwrap();
    let rays = companions(&hazards(&mesh, seed, rays), seed, each);
    Agreement { exact: 0, decorated: 0, ..Agreement::quick() }.assert(&mesh, &rays);
}

#[test]
fn companions_of_hazards_on_random_meshes() {
    for kind in MeshKind::ALL {
        for seed in 0..4 {
            assert_on_companions(&random_mesh(seed, kind), seed, 39, 8);
            assert_on_companions(&random_mesh(seed, kind), seed, 13, 64);
        }
    }
}

#[test]
fn companions_of_hazards_on_small_scenes() {
    for (name, mesh) in common::small_scenes() {
        println!("{name}");
        assert_on_companions(&mesh, 1, 130, 64);
    }
}

/// A hit counts up to the last bit of t.
#[test]
fn intervals_that_end_at_a_hit() {
    for kind in MeshKind::ALL {
        let (vertices, triangles) = random_mesh(3, kind);
        let mesh = TriMesh::new(&vertices, &triangles).unwrap();
        let scene = Scene::build(&mesh, &Default::default()).unwrap();
        let camera = RaySet::Camera.rays(&mesh, 3, 256);
        let ends = [f32::next_down, |t| t, f32::next_up];
        let rays: Vec<Ray> = (0..)
            .zip(&camera)
            .filter_map(|(i, ray)| {
                let hit = scene.closest(ray);
                let end = ends[i % 3](hit.t);
                let interval = if i % 2 == 0 { (0.0, end) } else { (end, f32::INFINITY) };
                hit.is_hit().then(|| ray.with_interval(interval.0, interval.1))
            })
            .collect();
        Agreement { exact: 0, decorated: 0, ..Agreement::quick() }.assert(&mesh, &rays);
    }
}

/// Pictures whose rows are taken in tiles, of which the last ones are cut off.
#[test]
fn rows_of_a_camera() {
    for (seed, kind) in (0..).zip(MeshKind::ALL) {
        let (vertices, triangles) = random_mesh(seed, kind);
        let mesh = TriMesh::new(&vertices, &triangles).unwrap();
        let rays = RaySet::Camera.rays(&mesh, seed, 37 * 37);
        for part in [&rays[..], &rays[100..1100]] {
            Agreement { exact: 0, decorated: 0, threads: vec![2], ..Agreement::quick() }.assert(&mesh, part);
        }
    }
}

#[test]
fn every_instruction_set() {
    let (vertices, triangles) = random_mesh(5, MeshKind::ALL[0]);
    let mesh = TriMesh::new(&vertices, &triangles).unwrap();
    assert_agree(&mesh, &companions(&RaySet::Camera.rays(&mesh, 1, 8), 1, 16));
}

/// Streams on the scenes that come with the crate and those of the folder, if there is one.
#[test]
fn streams_answer_as_single_rays_do() {
    let builtin = common::builtin_scenes().map(|(name, mesh)| (name.to_owned(), mesh));
    for (name, (vertices, triangles)) in builtin.chain(files()) {
        println!("{name}");
        let mesh = TriMesh::new(&vertices, &triangles).unwrap();
        let scene = Scene::build(&mesh, &Default::default()).unwrap();
        let aimed = companions(&RaySet::Aimed.rays(&mesh, 1, 20), 1, 64);
        let grazing = companions(&RaySet::Grazing.rays(&mesh, 1, 20), 1, 64);
        let camera = RaySet::Camera.rays(&mesh, 1, 10_000);
        let inside = RaySet::Inside.rays(&mesh, 1, 2_000);
        for rays in [camera, aimed, grazing, inside] {
            assert_streams(&scene, &rays);
        }
    }
}

#[cfg(feature = "obj")]
fn files() -> Vec<(String, Mesh)> {
    let files = common::scene_files();
    if files.is_empty() {
        common::announce("OCTOGRID_SCENES is not set: no scenes from files");
    }
    let load = |file: std::path::PathBuf| {
        let model = octogrid::obj::read_obj(&file).unwrap();
        (file.display().to_string(), (model.vertices, model.triangles))
    };
    files.into_iter().map(load).collect()
}

#[cfg(not(feature = "obj"))]
fn files() -> Vec<(String, Mesh)> {
    Vec::new()
}

#[cfg(feature = "parallel")]
fn assert_streams(scene: &Scene, rays: &[Ray]) {
    let (mut hits, mut occluded) = (vec![Hit::MISS; rays.len()], vec![false; rays.len()]);
    scene.closest_stream(rays, &mut hits);
    scene.occluded_stream(rays, &mut occluded);
    let bits = |hit: Hit| bytemuck::cast::<Hit, [u32; 4]>(hit);
    for ((ray, hit), occluded) in rays.iter().zip(hits).zip(occluded) {
        assert_eq!(bits(scene.closest(ray)), bits(hit), "{ray:?}");
        assert_eq!(scene.occluded(ray), occluded, "{ray:?}");
    }
}

#[cfg(not(feature = "parallel"))]
fn assert_streams(_: &Scene, _: &[Ray]) {}

#[test]
#[cfg(feature = "parallel")]
fn too_many_hits_are_an_error() {
    let (vertices, triangles) = random_mesh(1, MeshKind::ALL[0]);
    let mesh = TriMesh::new(&vertices, &triangles).unwrap();
    let scene = Scene::build(&mesh, &Default::default()).unwrap();
    let rays = RaySet::Random.rays(&mesh, 1, 3000);
    let mut lists = octogrid::HitLists::default();
    scene.all_stream(&rays, usize::MAX, &mut lists).unwrap();
    assert_eq!(lists, scene.all_batch(&rays));
    let all = lists.hits.len();
    assert!(all > 0);
    scene.all_stream(&rays, all, &mut lists).unwrap();
    let error = scene.all_stream(&rays, all - 1, &mut lists).unwrap_err();
    assert_eq!((error.limit, lists.hits.len(), lists.offsets.len()), (all - 1, 0, 0));
}
