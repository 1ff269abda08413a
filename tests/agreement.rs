//! Every structure against both oracles, on generated scenes and on real ones.
#![cfg(feature = "oracle")]

mod common;

use glam::Vec3;
use octogrid::oracle::meshes::{Mesh, MeshKind, closed_mesh, cuboid, random_mesh};
use octogrid::oracle::rays::{RaySet, hazards};
use octogrid::oracle::{Agreement, assert_agree};
use octogrid::{Ray, TriMesh};

fn assert_on_hazards((vertices, triangles): &Mesh, seed: u64, rays: usize) {
    let mesh = TriMesh::new(vertices, triangles).unwrap();
    assert_agree(&mesh, &hazards(&mesh, seed, rays));
}

#[test]
fn random_meshes() {
    for kind in MeshKind::ALL {
        for seed in 0..4 {
            assert_on_hazards(&random_mesh(seed, kind), seed, 100);
        }
    }
}

#[test]
fn small_scenes() {
    for (name, mesh) in common::small_scenes() {
        println!("{name}");
        assert_on_hazards(&mesh, 1, 200);
    }
}

#[test]
fn builtin_scenes() {
    for (name, (vertices, triangles)) in common::builtin_scenes() {
        println!("{name}");
        let mesh = TriMesh::new(&vertices, &triangles).unwrap();
        assert_on_rays_of_all_kinds(name, &mesh, [1000, 1000, 100]);
    }
}

/// The four structures against brute force on random, camera and aimed rays, of which some also against
/// exact arithmetic.
fn assert_on_rays_of_all_kinds(name: &str, mesh: &TriMesh<'_>, rays: [usize; 3]) {
    let sets = [RaySet::Random, RaySet::Camera, RaySet::Aimed];
    for ((set, n), exact) in sets.into_iter().zip(rays).zip([20, 0, 40]) {
        let rays: Vec<Ray> = set.rays(mesh, 1, n);
        let agreement = Agreement { exact, decorated: 500, ..Agreement::quick() };
        if let Err(disagreement) = agreement.check(mesh, &rays) {
            panic!("{name}, {set:?} rays: {disagreement}");
        }
    }
}

#[test]
fn no_triangles() {
    assert_on_hazards(&(vec![], vec![]), 1, 100);
    assert_on_hazards(&(vec![[1.0, 2.0, 3.0]], vec![[0, 0, 0]; 20]), 1, 100);
}

/// A small mesh in a scene 10^6 times as large.
#[test]
fn teapot_in_a_stadium() {
    let (mut vertices, mut triangles) = closed_mesh(3, 3);
    let near = TriMesh::new(&vertices, &triangles).unwrap();
    let mut rays = hazards(&near, 1, 200);
    let first = vertices.len() as u32;
    let (far, faces) = cuboid(Vec3::splat(-1e9), Vec3::splat(1e9));
    triangles.extend(faces.iter().map(|face| face.map(|i| i + first)));
    let (far, near) = (far, std::mem::take(&mut vertices));
    let vertices = [near, far].concat();
    let mesh = TriMesh::new(&vertices, &triangles).unwrap();
    rays.extend(hazards(&mesh, 2, 200));
    assert_agree(&mesh, &rays);
}

/// The same scene from 10^-18 to 10^18 times the size.
#[test]
fn extreme_scales() {
    for scale in [1e-36, 1e-18, 1e18, 1e34] {
        let (vertices, triangles) = closed_mesh(9, 2);
        let vertices = vertices.iter().map(|v| v.map(|x| x * scale)).collect();
        assert_on_hazards(&(vertices, triangles), 1, 100);
    }
}

/// Every OBJ file in the folder OCTOGRID_SCENES; run it in release mode.
#[cfg(feature = "obj")]
#[test]
fn scene_files() {
    let files = common::scene_files();
    if files.is_empty() {
        common::announce("OCTOGRID_SCENES is not set or holds no OBJ file: the sweep was skipped");
    }
    for path in files {
        let name = path.display().to_string();
        let model = octogrid::obj::read_obj(&path).unwrap_or_else(|error| panic!("{error}"));
        let mesh = model.mesh().unwrap_or_else(|error| panic!("{name}: {error}"));
        let start = std::time::Instant::now();
        assert_on_rays_of_all_kinds(&name, &mesh, [10_000, 10_000, 2_000]);
        println!("{name}: {} triangles, {:.1?}", mesh.len(), start.elapsed());
    }
}
