//! Lamps; each has one connected group of shining triangles, except the chandelier with eight.

use glam::{DVec3, dvec3};

use super::builder::Builder;
use super::trig::sin_cos;

const WARM: [f32; 3] = [120.0, 92.0, 58.0];

fn brass(b: &mut Builder) {
    b.paint("brass", [0.62, 0.46, 0.2]);
}

/// A ring of eight bulbs that hangs `drop` below `at`.
pub(crate) fn chandelier(b: &mut Builder, at: DVec3, drop: f64) {
    let hub = at - DVec3::Y * drop;
    brass(b);
    b.lathe(hub, &[[0.0, -0.2], [0.12, -0.1], [0.14, 0.0], [0.02, 0.15], [0.02, drop], [0.0, drop]], 12);
    b.torus(hub, 1.1, 0.035, 48, 6);
    for i in 0..8 {
        let (sin, cos) = sin_cos(f64::from(i) / 8.0);
        let rim = hub + dvec3(1.1 * cos, 0.0, 1.1 * sin);
        brass(b);
        b.beam(hub, rim, 0.03, 0.03);
        b.lathe(rim, &[[0.0, 0.02], [0.05, 0.03], [0.07, 0.1], [0.0, 0.1]], 12);
        b.light("bulb", WARM);
        b.sphere(rim + DVec3::Y * 0.2, 0.08, 10, 6);
    }
}

/// A globe that hangs `drop` below `at`.
pub(crate) fn pendant(b: &mut Builder, at: DVec3, drop: f64) {
    brass(b);
    b.lathe(at - DVec3::Y * drop, &[[0.0, 0.21], [0.06, 0.21], [0.015, 0.3], [0.015, drop], [0.0, drop]], 10);
    b.light("globe", [40.0, 34.0, 26.0]);
    b.sphere(at - DVec3::Y * drop, 0.2, 20, 12);
}

/// A shining panel just below a ceiling at `at`.
pub(crate) fn panel(b: &mut Builder, at: DVec3) {
    b.paint("mullion", [0.15, 0.15, 0.16]);
    b.cuboid(at - dvec3(0.65, 0.03, 0.35), at + dvec3(0.65, 0.0, 0.35));
    b.light("panel", [20.0, 19.0, 17.0]);
    b.cuboid(at - dvec3(0.6, 0.05, 0.3), at + dvec3(0.6, -0.035, 0.3));
}

/// A wall lamp: a bulb in a cup, off the wall.
pub(crate) fn sconce(b: &mut Builder, at: DVec3, turns: f64) {
    b.place(at, turns, |b| {
        brass(b);
        b.cuboid(dvec3(-0.08, -0.2, 0.0), dvec3(0.08, 0.2, 0.03));
        b.beam(dvec3(0.0, -0.1, 0.03), dvec3(0.0, -0.1, 0.2), 0.03, 0.03);
        b.lathe(dvec3(0.0, -0.08, 0.2), &[[0.0, 0.0], [0.06, 0.02], [0.11, 0.09], [0.0, 0.07]], 16);
        b.light("sconce", WARM);
        b.sphere(dvec3(0.0, 0.1, 0.2), 0.09, 12, 8);
    });
}

/// A lamp on a desk; its bulb is under an open shade.
pub(crate) fn table_lamp(b: &mut Builder, at: DVec3) {
    shaded(b, at, 0.45);
}

/// A lamp of 1.5 metres.
pub(crate) fn floor_lamp(b: &mut Builder, at: DVec3) {
    shaded(b, at, 1.5);
}

fn shaded(b: &mut Builder, at: DVec3, height: f64) {
    brass(b);
    b.lathe(at, &[[0.0, 0.0], [0.14, 0.0], [0.13, 0.02], [0.015, 0.04], [0.015, height], [0.0, height]], 16);
    b.light("shaded bulb", WARM);
    b.sphere(at + DVec3::Y * (height + 0.07), 0.06, 12, 8);
    b.glass("shade", [0.85, 0.75, 0.55], 0.5);
    let shade = [[0.22, -0.06], [0.12, 0.24], [0.117, 0.24], [0.217, -0.06], [0.22, -0.06]];
    b.lathe(at + DVec3::Y * height, &shade, 24);
}
