//! The oracles against a third opinion, against each other and against what they claim.
#![cfg(feature = "oracle")]

use glam::{DVec3, Vec3};
use octogrid::Rng;
use octogrid::oracle::meshes::{MeshKind, closed_mesh, cuboid, random_mesh};
use octogrid::oracle::rays::{RaySet, hazards};
use octogrid::oracle::{brute, exact};
use octogrid::{EdgeRule, Ray, TriMesh};
use robust::{Coord3D, orient3d};

/// The sign of d.((p-o) x (q-o)), where all sums are exact in f64.
fn side(o: DVec3, d: DVec3, p: DVec3, q: DVec3) -> f64 {
    let coord = |v: DVec3| Coord3D { x: v.x, y: v.y, z: v.z };
    let sign = orient3d(coord(p), coord(q), coord(o + d), coord(o));
    if sign == 0.0 { 0.0 } else { sign.signum() }
}

/// Whether the line meets the closed triangle, by orientations; `None` where it does not cross.
fn meets(o: DVec3, d: DVec3, [a, b, c]: [DVec3; 3]) -> bool {
    let det = side(a, d, b, c);
    let signs = [side(o, d, b, c), side(o, d, c, a), side(o, d, a, b)];
    det != 0.0 && signs.iter().all(|sign| sign * det >= 0.0)
}

fn integer_case(rng: &mut Rng, n: usize) -> (Ray, [Vec3; 3]) {
    let [o, d, a, b, c] = [(); 5].map(|()| Vec3::from_array([(); 3].map(|()| rng.integer(n))));
    (Ray::new(o, d), [a, b, c])
}

#[test]
fn closed_triangles_agree_with_orientations() {
    let rng = &mut Rng::new(1);
    let mut met = 0;
    for n in [1, 2, 4, 100] {
        for _ in 0..5_000 {
            let (ray, corners) = integer_case(rng, n);
            let (o, d) = (ray.origin.as_dvec3(), ray.dir.as_dvec3());
            let expected = meets(o, d, corners.map(|v| v.as_dvec3()));
            let found = exact::intersect(&ray, corners, EdgeRule::Closed).is_some();
            assert_eq!(found, expected, "{ray:?} {corners:?}");
            met += u32::from(found);
        }
    }
    assert!(met > 1_000, "{met}");
}

/// Moves the origin by (2^-10, 2^-20, 2^-30), which among coordinates of -4..=4 is as good as
/// infinitesimal: sides are integers, and a gradient's components are at most 64.
#[test]
fn crossings_agree_with_orientations_from_a_moved_origin() {
    let rng = &mut Rng::new(2);
    let step = DVec3::new(-10.0, -20.0, -30.0).exp2();
    let mut decided = 0;
    for _ in 0..40_000 {
        let (ray, corners) = integer_case(rng, 4);
        let (o, d) = (ray.origin.as_dvec3() + step, ray.dir.as_dvec3());
        let expected = meets(o, d, corners.map(|v| v.as_dvec3()));
        let found = exact::intersect(&ray, corners, EdgeRule::Crossing);
        assert_eq!(found.is_some(), expected, "{ray:?} {corners:?}");
        let closed = exact::intersect(&ray, corners, EdgeRule::Closed);
        assert!(found.is_none() || found == closed, "{ray:?} {corners:?}");
        decided += u32::from(found != closed);
    }
    assert!(decided > 200, "{decided}");
}

#[test]
fn scaling_by_powers_of_two_changes_t_alone() {
    let rng = &mut Rng::new(3);
    for _ in 0..2_000 {
        let (ray, corners) = integer_case(rng, 9);
        for rule in [EdgeRule::Closed, EdgeRule::Crossing] {
            let hit = exact::intersect(&ray, corners, rule);
            for (space, speed) in [(60, 0), (-60, 0), (0, 30), (-140, -140), (100, -20)] {
                let power = |exponent: i32| (f64::from(exponent)).exp2() as f32;
                let (space, speed) = (power(space), power(speed));
                let scaled = Ray::new(space * ray.origin, speed * ray.dir);
                let found = exact::intersect(&scaled, corners.map(|v| space * v), rule);
                let expected = hit.map(|hit| exact::ExactHit { t: hit.t * (space / speed), ..hit });
                assert_eq!(found, expected, "{ray:?} {corners:?}");
            }
        }
    }
}

#[test]
fn t_rounds_the_quotient_that_f64_can_hold() {
    let rng = &mut Rng::new(4);
    for _ in 0..5_000 {
        let (ray, corners) = integer_case(rng, 50);
        let Some(hit) = exact::intersect(&ray, corners, EdgeRule::Closed) else { continue };
        let [a, b, c] = corners.map(|v| v.as_dvec3());
        let (o, d, n) = (ray.origin.as_dvec3(), ray.dir.as_dvec3(), (b - a).cross(c - a));
        assert_eq!(hit.t, ((a - o).dot(n) / d.dot(n)) as f32, "{ray:?} {corners:?}");
        let point = a + hit.u * (b - a) + hit.v * (c - a);
        assert!(point.distance(o + f64::from(hit.t) * d) < 1e-3, "{ray:?} {corners:?}");
    }
}

/// The scan with its quick rejection against the definition without it.
#[test]
fn scans_miss_nothing() {
    for kind in MeshKind::ALL {
        for seed in 0..6 {
            let (vertices, triangles) = random_mesh(seed, kind);
            let mesh = TriMesh::new(&vertices, &triangles).unwrap();
            for ray in hazards(&mesh, seed, 50) {
                let hit = |prim| exact::intersect(&ray, mesh.corners(prim), EdgeRule::Crossing);
                let counts = |t| ray.is_valid() && ray.t_min < t && t <= ray.t_max;
                let mut expected: Vec<_> = (0..mesh.len() as u32)
                    .filter_map(|prim| hit(prim).map(|hit| (hit.t, prim)))
                    .filter(|&(t, _)| counts(t))
                    .collect();
                expected.sort_by(|a, b| a.partial_cmp(b).unwrap());
                let found: Vec<_> = exact::all(&mesh, &ray).iter().map(|hit| (hit.t, hit.prim)).collect();
                assert_eq!(found, expected, "{kind:?} {seed} {ray:?}");
            }
        }
    }
}

#[test]
fn queries_of_one_oracle_agree() {
    for kind in MeshKind::ALL {
        let (vertices, triangles) = random_mesh(7, kind);
        let mesh = TriMesh::new(&vertices, &triangles).unwrap();
        let rays = hazards(&mesh, 7, 100);
        let answers = brute::answers(&mesh, &rays);
        for (ray, answer) in rays.iter().zip(&answers) {
            assert_eq!(answer.occluded, answer.closest.is_hit());
            assert!(answer.all.first().is_none_or(|first| !first.precedes(&answer.closest)), "{ray:?}");
            assert_eq!(exact::closest(&mesh, ray).prim, answer.closest.prim, "{ray:?}");
            assert_eq!(exact::any(&mesh, ray), answer.occluded, "{ray:?}");
        }
    }
}

#[test]
fn closed_meshes_are_closed() {
    let meshes = (0..4).map(|levels| closed_mesh(5, levels)).chain([cuboid(Vec3::ZERO, Vec3::ONE)]);
    for (_, triangles) in meshes {
        let edges = |[a, b, c]: [u32; 3]| [(a, b), (b, c), (c, a)];
        let all: Vec<_> = triangles.iter().copied().flat_map(edges).collect();
        for &(a, b) in &all {
            assert_eq!(all.iter().filter(|&&edge| edge == (a, b)).count(), 1);
            assert_eq!(all.iter().filter(|&&edge| edge == (b, a)).count(), 1);
        }
    }
}

/// The sine of the angle between a ray and a triangle.
fn sine(ray: &Ray, corners: [Vec3; 3]) -> f64 {
    let [a, b, c] = corners.map(Vec3::as_dvec3);
    (b - a).cross(c - a).normalize().dot(ray.dir.as_dvec3().normalize()).abs()
}

/// A set that no longer hits what it is made for would test nothing.
#[test]
fn ray_sets_meet_what_they_aim_at() {
    let (vertices, triangles) = closed_mesh(5, 2);
    let mesh = TriMesh::new(&vertices, &triangles).unwrap();
    let share = |set: RaySet, count: &dyn Fn(&Ray) -> bool| {
        let rays = set.rays(&mesh, 1, 400);
        assert_eq!(rays.len(), 400);
        rays.iter().filter(|ray| count(ray)).count() as f64 / 400.0
    };
    let line = |ray: &Ray| ray.with_interval(f32::NEG_INFINITY, f32::INFINITY);
    let on_edge = |ray: &Ray| {
        let closed = (0..mesh.len() as u32)
            .filter(|&prim| exact::intersect(ray, mesh.corners(prim), EdgeRule::Closed).is_some());
        closed.count() != exact::all(&mesh, &line(ray)).len()
    };
    let elsewhere = [RaySet::Camera, RaySet::Far, RaySet::Invalid];
    for set in RaySet::ALL.into_iter().filter(|set| !elsewhere.contains(set)) {
        let hits = share(set, &|ray| exact::any(&mesh, &line(ray)));
        assert!(hits > 0.25, "{set:?} {hits}");
    }
    assert!(share(RaySet::Far, &|ray| exact::any(&mesh, ray)) > 0.1);
    assert_eq!(share(RaySet::Invalid, &|ray| ray.is_valid()), 0.0);
    let on_surface = |ray: &Ray| exact::all(&mesh, &line(ray)).iter().any(|hit| hit.t == ray.t_max);
    assert!(share(RaySet::Interval, &on_surface) > 0.1);
    for set in [RaySet::Aimed, RaySet::Axis, RaySet::Diagonal, RaySet::Planar] {
        assert!(share(set, &on_edge) > 0.25, "{set:?}");
    }
    let grazes =
        |ray: &Ray| exact::all(&mesh, &line(ray)).iter().any(|hit| sine(ray, mesh.corners(hit.prim)) < 0.02);
    assert!(share(RaySet::Grazing, &grazes) > 0.25);
}

#[test]
fn ray_sets_take_any_mesh() {
    let wild = (vec![[f32::MAX; 3], [f32::MIN; 3], [0.0; 3]], vec![[0, 1, 2]]);
    let point = (vec![[3.0; 3]], vec![[0, 0, 0]]);
    for (vertices, triangles) in [(vec![], vec![]), wild, point] {
        let mesh = TriMesh::new(&vertices, &triangles).unwrap();
        assert_eq!(hazards(&mesh, 0, 101).len(), 101);
    }
}
