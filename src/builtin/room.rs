//! A closed room: a table and chairs in the middle, lamps on the walls.

use glam::dvec3;

use super::Camera;
use super::builder::Builder;
use super::furniture::{chair, picture, table, vase};
use super::trig::sin_cos;
use crate::model::Model;

pub(super) const CAMERAS: [Camera; 3] = [
    Camera::new([-2.7, 1.9, 2.2], [0.2, 0.6, -0.2], 55.0),
    Camera::new([2.6, 1.3, 2.1], [-0.5, 0.75, -0.6], 50.0),
    Camera::new([0.4, 2.5, -1.9], [0.0, 0.5, 0.3], 60.0),
];

/// A room of 6 x 2.8 x 5 metres: 3,368 triangles, 5 lights.
pub fn room() -> Model {
    let mut b = Builder::default();
    let floor = [0.42, 0.27, 0.16];
    b.shell(dvec3(-3.0, 0.0, -2.5), dvec3(3.0, 2.8, 2.5), [floor, [0.72, 0.68, 0.58], [0.85; 3]]);
    rug(&mut b);
    b.paint("table wood", [0.36, 0.18, 0.08]);
    table(&mut b, dvec3(1.8, 0.76, 1.0), 12);
    b.paint("porcelain", [0.2, 0.42, 0.62]);
    vase(&mut b, dvec3(0.2, 0.76, -0.1), 0.34, 12, 1);
    chairs(&mut b);
    door(&mut b);
    lamps(&mut b);
    b.place(dvec3(0.0, 1.6, -2.5), 0.0, |b| picture(b, [0.6, 0.4], "seascape", [0.1, 0.3, 0.45]));
    b.place(dvec3(-3.0, 1.6, 0.0), 0.25, |b| picture(b, [0.4, 0.5], "portrait", [0.5, 0.2, 0.15]));
    b.finish()
}

/// 200 triangles with gentle waves.
fn rug(b: &mut Builder) {
    b.paint("rug", [0.5, 0.1, 0.12]);
    b.patch(10, 10, |u, v| {
        let wave = sin_cos(3.0 * u).0 * sin_cos(2.0 * v).0;
        dvec3(3.4 * u - 1.7, 0.012 + 0.006 * wave, 1.2 - 2.4 * v)
    });
}

/// 4 * 468 triangles.
fn chairs(b: &mut Builder) {
    let seats = [([-0.45, -0.75], 0.01), ([0.45, -0.72], -0.03), ([-0.4, 0.75], 0.48), ([0.55, 0.95], 0.57)];
    for ([x, z], turns) in seats {
        b.place(dvec3(x, 0.0, z), turns, |b| chair(b, [0.4, 0.22, 0.1], [0.16, 0.34, 0.22], 6, 2, 3));
    }
}

/// A door leaf with its frame in the wall x = 3; 48 triangles.
fn door(b: &mut Builder) {
    b.paint("door", [0.5, 0.52, 0.5]);
    b.cuboid(dvec3(2.96, 0.0, -0.4), dvec3(3.0, 2.0, 0.5));
    b.paint("door frame", [0.8, 0.78, 0.72]);
    for z in [-0.5, 0.5] {
        b.cuboid(dvec3(2.92, 0.0, z), dvec3(3.0, 2.1, z + 0.1));
    }
    b.cuboid(dvec3(2.92, 2.0, -0.4), dvec3(3.0, 2.1, 0.5));
}

/// Five wall lamps: a plate at the wall and a shining panel off it; 5 * 24 triangles.
fn lamps(b: &mut Builder) {
    let walls =
        [([-1.7, -2.5], 0.0), ([1.7, -2.5], 0.0), ([3.0, 1.4], 0.75), ([0.3, 2.5], 0.5), ([-3.0, 1.5], 0.25)];
    for (i, ([x, z], turns)) in walls.into_iter().enumerate() {
        b.place(dvec3(x, 2.0, z), turns, |b| {
            b.paint("brass", [0.6, 0.45, 0.2]);
            b.cuboid(dvec3(-0.06, -0.12, 0.0), dvec3(0.06, 0.12, 0.05));
            b.light(&format!("lamp {}", i + 1), [55.0, 45.0, 32.0]);
            b.cuboid(dvec3(-0.16, -0.1, 0.07), dvec3(0.16, 0.1, 0.1));
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_exact() {
        let model = room();
        assert_eq!(model.triangles.len(), 3_368);
        assert_eq!(model.lights().len(), 5);
        assert!(model.lights().iter().all(|light| light.len() == 12));
    }

    #[test]
    fn cameras_are_inside() {
        for camera in CAMERAS {
            let eye = glam::Vec3::from_array(camera.eye);
            assert!(eye.x.abs() < 3.0 && (0.0..2.8).contains(&eye.y) && eye.z.abs() < 2.5);
        }
    }
}
