//! What holds for all built-in scenes.

use std::collections::HashMap;

use super::*;

/// Whether each directed edge occurs once, and its reverse too: a closed, oriented manifold.
fn is_closed(model: &Model) -> bool {
    let mut edges: HashMap<[u32; 2], u32> = HashMap::new();
    for [a, b, c] in &model.triangles {
        for edge in [[*a, *b], [*b, *c], [*c, *a]] {
            *edges.entry(edge).or_default() += 1;
        }
    }
    edges.iter().all(|(&[a, b], &count)| count == 1 && edges.get(&[b, a]) == Some(&1))
}

/// Positive where the outsides of a closed surface are counterclockwise.
fn volume(model: &Model) -> f32 {
    let mesh = model.mesh().unwrap();
    let volume = |triangle| {
        let [a, b, c] = mesh.corners(triangle);
        a.dot(b.cross(c)) / 6.0
    };
    (0..mesh.len() as u32).map(volume).sum()
}

#[test]
fn counts_are_those_of_the_descriptions() {
    let counts: Vec<_> = all().iter().map(|s| (s.name, (s.model)().triangles.len())).collect();
    let expected = [
        ("room", 3_368),
        ("interior", 97_036),
        ("soup", 100_000),
        ("stadium", 100_012),
        ("sphere", 8_064),
        ("torus", 8_192),
        ("cube", 12),
        ("plane", 2_048),
        ("triangle", 1),
        ("empty", 0),
        ("slivers", 5_248),
    ];
    assert_eq!(counts, expected);
}

#[test]
fn scenes_are_sound() {
    for scene in all() {
        let model = (scene.model)();
        assert_eq!(model, (scene.model)(), "{} is not deterministic", scene.name);
        assert!(model.mesh().is_ok(), "{}", scene.name);
        assert_eq!(model.material_ids.len(), model.triangles.len(), "{}", scene.name);
        assert!(model.material_ids.iter().all(|&id| (id as usize) < model.materials.len()), "{}", scene.name);
        assert!(!scene.cameras.is_empty(), "{}", scene.name);
        assert_eq!(by_name(scene.name).map(|s| s.name), Some(scene.name));
    }
    assert!(by_name("nowhere").is_none());
}

#[test]
fn no_triangle_has_area_zero() {
    for scene in all() {
        let model = (scene.model)();
        for (i, corners) in model.triangles.iter().enumerate() {
            let [a, b, c] = corners.map(|v| glam::Vec3::from_array(model.vertices[v as usize]).as_dvec3());
            assert!((b - a).cross(c - a).length() > 0.0, "{}: triangle {i}", scene.name);
        }
    }
}

#[test]
fn closed_scenes_are_closed() {
    for (model, expected) in [
        (cube(), 8.0),
        (sphere(64, 64), 4.18),
        (icosphere(4), 4.18),
        (torus(128, 32), 3.15),
        (stadium(), -1e9),
    ] {
        assert!(is_closed(&model));
        let volume = volume(&model);
        assert!((volume / expected - 1.0).abs() < 0.02, "volume {volume}, expected {expected}");
    }
    assert!(!is_closed(&plane(4)));
    assert_eq!(icosphere(3).triangles.len(), 20 * 64);
}

#[test]
fn parts_are_closed() {
    use builder::Builder;
    use furniture::{baluster, column, leg, vase};
    use glam::{DVec3, dvec3};
    let parts: [fn(&mut Builder); 8] = [
        |b| b.cushion(DVec3::ZERO, DVec3::ONE, 3),
        |b| b.beam(DVec3::ZERO, dvec3(1.0, 0.5, 2.0), 0.1, 0.1),
        |b| b.arch(DVec3::ZERO, DVec3::X, 0.2, 1.0, 8),
        |b| leg(b, DVec3::ZERO, 0.1, 1.0, 7),
        |b| vase(b, DVec3::ZERO, 1.0, 12, 3),
        |b| baluster(b, DVec3::ZERO, 1.0, 12, 2),
        |b| column(b, DVec3::ZERO, 0.4, 6.0, 20, 6),
        |b| b.lathe(DVec3::ZERO, &[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], 5),
    ];
    for (i, part) in parts.into_iter().enumerate() {
        let mut b = Builder::default();
        part(&mut b);
        let model = b.finish();
        assert!(is_closed(&model), "part {i}");
        assert!(volume(&model) > 0.0, "part {i}");
    }
}
