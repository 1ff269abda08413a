//! Properties on random cases: in a regime of small integers, where degeneracies abound, among
//! ordinary floats and among all bit patterns. Equality is demanded in each.
#![cfg(feature = "oracle")]

use glam::Vec3;
use octogrid::oracle::meshes::{closed_mesh, cuboid};
use octogrid::oracle::rays::{RaySet, hazards};
use octogrid::oracle::{Agreement, exact};
use octogrid::{Hit, Ray, Scene, Structure, TriMesh};
use proptest::array::{uniform3, uniform8};
use proptest::collection::vec;
use proptest::num;
use proptest::prelude::*;
use proptest::test_runner::FileFailurePersistence;

type Triangle = [[f32; 3]; 3];

fn config() -> ProptestConfig {
    let file = FileFailurePersistence::WithSource("regressions");
    ProptestConfig { failure_persistence: Some(Box::new(file)), ..ProptestConfig::default() }
}

fn integer(n: i32) -> impl Strategy<Value = f32> + Clone {
    (-n..=n).prop_map(|i| i as f32)
}

/// Of either sign, with exponents that leave room for the products of three in f32.
fn moderate() -> impl Strategy<Value = f32> + Clone {
    (-1.0f32..1.0, -20i32..20).prop_map(|(x, exponent)| x * (exponent as f32).exp2())
}

fn finite() -> impl Strategy<Value = f32> + Clone {
    num::f32::NORMAL | num::f32::SUBNORMAL | num::f32::ZERO
}

fn soup(
    coordinate: impl Strategy<Value = f32> + Clone,
    n: impl Into<proptest::collection::SizeRange>,
) -> impl Strategy<Value = Vec<Triangle>> {
    vec(uniform3(uniform3(coordinate)), n)
}

fn rays_of(values: Vec<[f32; 8]>) -> Vec<Ray> {
    values.into_iter().map(bytemuck::cast).collect()
}

/// Rays with the interval (0, infinity].
fn rays(coordinate: impl Strategy<Value = f32> + Clone) -> impl Strategy<Value = Vec<Ray>> {
    let ray = (uniform3(coordinate.clone()), uniform3(coordinate));
    vec(ray.prop_map(|(origin, dir)| Ray::new(origin, dir)), 1..20)
}

/// Compares all structures on a triangle soup with as few vertices as it has.
fn agree(soup: &[Triangle], rays: &[Ray]) {
    let vertices = soup.concat();
    let triangles: Vec<_> = (0..soup.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let mesh = TriMesh::new(&vertices, &triangles).unwrap();
    Agreement::quick().assert(&mesh, rays);
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn integers(soup in soup(integer(4), 1..40), rays in rays(integer(6))) {
        agree(&soup, &rays);
    }

    #[test]
    fn integer_intervals(
        soup in soup(integer(3), 1..40),
        rays in vec(uniform8(integer(4)), 1..20),
    ) {
        agree(&soup, &rays_of(rays));
    }

    #[test]
    fn moderate_floats(soup in soup(moderate(), 1..40), rays in rays(moderate())) {
        agree(&soup, &rays);
    }

    #[test]
    fn wild_rays(soup in soup(moderate(), 1..20), rays in vec(uniform8(num::f32::ANY), 1..20)) {
        agree(&soup, &rays_of(rays));
    }

    #[test]
    fn wild_meshes(soup in soup(finite(), 1..20), rays in vec(uniform8(num::f32::ANY), 1..20)) {
        agree(&soup, &rays_of(rays));
    }

    #[test]
    fn wild_meshes_under_hazards(soup in soup(finite(), 1..20), seed: u64) {
        let vertices = soup.concat();
        let triangles: Vec<_> = (0..soup.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let mesh = TriMesh::new(&vertices, &triangles).unwrap();
        Agreement::quick().assert(&mesh, &hazards(&mesh, seed, 40));
    }

    #[test]
    fn closed_meshes_are_crossed_an_even_number_of_times(seed: u64, levels in 0u32..4) {
        let (vertices, triangles) = closed_mesh(seed, levels);
        assert_parity(&vertices, &triangles, seed);
    }

    #[test]
    fn boxes_are_crossed_an_even_number_of_times(
        seed: u64,
        min in uniform3(integer(4)),
        size in uniform3(0i32..5),
    ) {
        let min = Vec3::from_array(min);
        let (vertices, triangles) = cuboid(min, min + Vec3::from_array(size.map(|x| x as f32)));
        assert_parity(&vertices, &triangles, seed);
    }
}

/// Rays from outside, at vertices, edges and along axes: `all` reports an even number of crossings,
/// and `closest` sees the surface wherever `all` does.
fn assert_parity(vertices: &[[f32; 3]], triangles: &[[u32; 3]], seed: u64) {
    let mesh = TriMesh::new(vertices, triangles).unwrap();
    let rays: Vec<Ray> = [RaySet::Aimed, RaySet::Axis, RaySet::Planar, RaySet::Random]
        .iter()
        .flat_map(|set| set.rays(&mesh, seed, 10))
        .map(|ray| ray.with_interval(f32::NEG_INFINITY, f32::INFINITY))
        .collect();
    let scenes = Structure::ALL.map(|structure| Scene::build(&mesh, &structure.into()).unwrap());
    for ray in &rays {
        let even = exact::all(&mesh, ray).len();
        assert!(even.is_multiple_of(2), "{even} crossings in exact arithmetic: {ray:?}");
        for scene in &scenes {
            let mut hits = vec![Hit::MISS; triangles.len()];
            let all = scene.all(ray, &mut hits);
            assert!(
                all.complete && all.len == even,
                "{} has {}, not {even}: {ray:?}",
                scene.structure(),
                all.len
            );
            assert!(all.len == 0 || scene.closest(ray).is_hit(), "{}: {ray:?}", scene.structure());
        }
    }
}
