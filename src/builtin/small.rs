//! Small scenes for tests, each with one property taken to its end.

use std::collections::HashMap;

use glam::{DVec3, dvec3};

use super::builder::Builder;
use super::trig::sin_cos;
use crate::model::Model;
use crate::rng::Rng;

fn build(part: impl FnOnce(&mut Builder)) -> Model {
    let mut b = Builder::default();
    b.paint("clay", [0.7, 0.6, 0.5]);
    part(&mut b);
    b.finish()
}

/// No triangle.
pub fn empty() -> Model {
    Model::default()
}

/// The triangle (0, 0, 0), (1, 0, 0), (0, 1, 0).
pub fn triangle() -> Model {
    build(|b| {
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Y].map(|p| b.vertex(p));
        b.triangle(corners);
    })
}

/// The cube [-1, 1]^3, closed; 12 triangles.
pub fn cube() -> Model {
    build(|b| b.cuboid(DVec3::NEG_ONE, DVec3::ONE))
}

/// The square [-1, 1]^2 in the plane y = 0, facing up; 2 * cells^2 triangles.
pub fn plane(cells: u32) -> Model {
    build(|b| b.patch(cells, cells, |u, v| dvec3(2.0 * u - 1.0, 0.0, 1.0 - 2.0 * v)))
}

/// The unit sphere with poles on the y axis, closed; 2 * segments * (rings - 1) triangles.
pub fn sphere(segments: u32, rings: u32) -> Model {
    build(|b| b.sphere(DVec3::ZERO, 1.0, segments, rings))
}

/// A torus of radii 1 and 0.4 about the y axis, closed; 2 * segments * sides triangles.
pub fn torus(segments: u32, sides: u32) -> Model {
    build(|b| b.torus(DVec3::ZERO, 1.0, 0.4, segments, sides))
}

/// The unit sphere as an icosahedron divided `level` times, closed; 20 * 4^level triangles.
pub fn icosphere(level: u32) -> Model {
    build(|b| {
        let (mut points, mut faces) = icosahedron();
        for _ in 0..level {
            faces = divide(&faces, &mut points);
        }
        for point in points {
            b.vertex(point);
        }
        for face in faces {
            b.triangle(face);
        }
    })
}

fn icosahedron() -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let golden = (1.0 + 5f64.sqrt()) / 2.0;
    let mut points = Vec::new();
    for axis in 0..3 {
        for (short, long) in [(-1.0, -golden), (1.0, -golden), (1.0, golden), (-1.0, golden)] {
            let mut point = DVec3::ZERO;
            (point[axis], point[(axis + 1) % 3]) = (short, long);
            points.push(point.normalize());
        }
    }
    // The faces are the triples of points at the distance of an edge.
    let near = |i: usize, j: usize| points[i].dot(points[j]) > 0.4;
    let mut faces = Vec::new();
    for (i, j, k) in (0..12).flat_map(|i| (i + 1..12).flat_map(move |j| (j + 1..12).map(move |k| (i, j, k))))
    {
        if near(i, j) && near(j, k) && near(k, i) {
            let outward = points[i].cross(points[j]).dot(points[k]) > 0.0;
            faces.push(if outward { [i, j, k] } else { [i, k, j] }.map(|x| x as u32));
        }
    }
    (points, faces)
}

/// Divides each face into four; the middles of edges are shared.
fn divide(faces: &[[u32; 3]], points: &mut Vec<DVec3>) -> Vec<[u32; 3]> {
    let mut middles = HashMap::new();
    let mut middle = |a: u32, b: u32| {
        *middles.entry([a.min(b), a.max(b)]).or_insert_with(|| {
            points.push((points[a as usize] + points[b as usize]).normalize());
            (points.len() - 1) as u32
        })
    };
    let mut divided = Vec::with_capacity(4 * faces.len());
    for &[a, b, c] in faces {
        let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
        divided.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
    }
    divided
}

/// `n` triangles strewn over the unit cube, each about as large as the mean distance of their
/// centres; no two share a vertex. Corners may lie a little outside of the cube.
pub fn soup(n: usize, seed: u64) -> Model {
    let mut rng = Rng::new(seed);
    // Halve the size for each factor of 8 in number: a cube root would differ between platforms.
    let mut size = 0.5;
    let mut number = n;
    while number >= 8 {
        number /= 8;
        size /= 2.0;
    }
    build(|b| {
        for _ in 0..n {
            let centre = dvec3(rng.unit(), rng.unit(), rng.unit());
            let mut corner = || centre + dvec3(rng.unit() - 0.5, rng.unit() - 0.5, rng.unit() - 0.5) * size;
            let corners = [corner(), corner(), corner()].map(|p| b.vertex(p));
            b.triangle(corners);
        }
    })
}

/// A sphere of 100,000 triangles and diameter 1 in the middle of a box with sides of 1,000.
pub fn stadium() -> Model {
    build(|b| {
        b.shell(DVec3::splat(-500.0), DVec3::splat(500.0), [[0.3, 0.5, 0.2], [0.6; 3], [0.6, 0.7, 0.9]]);
        b.paint("ball", [0.2, 0.4, 0.8]);
        b.sphere(DVec3::ZERO, 0.5, 250, 201);
    })
}

/// Sheets of triangles with longest edge over height from about 1 to 1e8, a sheet of 128 for each
/// power of ten, and a disc of 4,096 needles that meet in its centre.
pub fn slivers() -> Model {
    build(|b| {
        let mut height = 1.0;
        for power in 0..=8 {
            let level = 0.125 * f64::from(power);
            b.patch(64, 1, |u, v| dvec3(v, level + 0.25 * v, 64.0 * u * height));
            height /= 10.0;
        }
        let centre = b.vertex(dvec3(-2.0, 0.0, 0.0));
        let rim: Vec<u32> = (0..4096)
            .map(|i| {
                let (sin, cos) = sin_cos(f64::from(i) / 4096.0);
                b.vertex(dvec3(cos - 2.0, 0.5 * cos, -sin))
            })
            .collect();
        for (i, &corner) in rim.iter().enumerate() {
            b.triangle([centre, corner, rim[(i + 1) % rim.len()]]);
        }
    })
}
