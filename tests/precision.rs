//! The errors of t, u and v (ARCHITECTURE.md, "Error analysis") against exact arithmetic.
#![cfg(feature = "oracle")]

use glam::{DVec3, Vec3};
use octogrid::oracle::exact;
use octogrid::oracle::meshes::{MeshKind, random_mesh};
use octogrid::oracle::rays::RaySet;
use octogrid::{EdgeRule, Ray, Rng, TriMesh, intersect};

/// t is the exact one rounded, u and v are off by 2^-27 and half a unit in the last place at most. Whether
/// there is a hit.
fn assert_precise(ray: &Ray, corners: [Vec3; 3]) -> bool {
    for rule in [EdgeRule::Crossing, EdgeRule::Closed] {
        let (found, expected) = (intersect(ray, corners, rule), exact::intersect(ray, corners, rule));
        let Some((found, expected)) = found.zip(expected) else {
            assert!(found.is_none() && expected.is_none(), "{ray:?} {corners:?} {found:?} {expected:?}");
            continue;
        };
        assert_eq!(found.t.to_bits(), expected.t.to_bits(), "{ray:?} {corners:?}");
        for (x, y) in [(found.u, expected.u), (found.v, expected.v)] {
            let unit = f64::from(x.next_up()) - f64::from(x);
            let error = (f64::from(x) - y).abs();
            assert!(error <= 0.5f64.powi(27) + 0.5 * unit, "{ray:?} {corners:?}: {x}, not {y}");
            assert!((0.0..=1.0).contains(&x), "{ray:?} {corners:?}: {x}");
        }
    }
    intersect(ray, corners, EdgeRule::Closed).is_some()
}

#[test]
fn meshes_of_all_kinds_under_rays_of_all_sets() {
    let mut hits = 0;
    for kind in MeshKind::ALL {
        for seed in 0..4 {
            let (vertices, triangles) = random_mesh(seed, kind);
            let mesh = TriMesh::new(&vertices, &triangles).unwrap();
            for set in RaySet::ALL.into_iter().filter(|set| *set != RaySet::Invalid) {
                for ray in set.rays(&mesh, seed, 20) {
                    let corners = (0..mesh.len() as u32).map(|prim| mesh.corners(prim));
                    hits += corners.filter(|&corners| assert_precise(&ray, corners)).count();
                }
            }
        }
    }
    assert!(hits > 5_000, "{hits}");
}

/// Needles of an aspect up to 10^8, met almost edge-on, from near and from 10^12 lengths away.
#[test]
fn grazed_needles() {
    let mut rng = Rng::new(1);
    let mut hits = 0;
    for _ in 0..20_000 {
        let (a, b) = (rng.in_cube(), rng.in_cube());
        let thin = a.lerp(b, rng.unit()) + rng.pick(&[1.0, 1e-3, 1e-6, 1e-8]) * rng.in_cube();
        let corners = [a, b, thin].map(DVec3::as_vec3);
        let [a, b, c] = corners.map(Vec3::as_dvec3);
        let target = a.lerp(b, rng.unit()).lerp(c, rng.unit());
        let tilt = rng.pick(&[1.0, 1e-4, 1e-8]) * rng.on_sphere();
        let dir = (b - a) * rng.signed() + (c - a) * rng.signed() + tilt;
        let origin = (target - rng.pick(&[0.0, 1.0, 1e6, 1e12]) * dir).as_vec3();
        hits += usize::from(assert_precise(&Ray::new(origin, dir.as_vec3()), corners));
    }
    assert!(hits > 1_000, "{hits}");
}
