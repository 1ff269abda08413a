//! A great hall with aisles, stairs to a gallery, and a library behind glass below it.
//!
//! x runs along the hall (0 to 36), z across it (0 to 24); the gallery begins at x = 28.

use glam::{DVec3, dvec3};

use super::Camera;
use super::builder::Builder;
use super::furniture::{baluster, chair, column, legs, picture, plant, shelves, sofa, table, vase};
use super::lamps;
use super::trig::sin_cos;
use crate::model::Model;
use crate::rng::Rng;

pub(super) const CAMERAS: [Camera; 3] = [
    Camera::new([1.2, 2.4, 16.2], [17.0, 2.2, 9.0], 60.0),
    Camera::new([14.5, 1.7, 15.6], [28.0, 2.6, 9.0], 60.0),
    Camera::new([28.9, 6.8, 15.0], [9.0, 0.6, 10.0], 65.0),
];

const SIZE: DVec3 = dvec3(36.0, 9.0, 24.0);
const GALLERY: f64 = 28.0;
const WOOD: [f32; 3] = [0.34, 0.19, 0.09];
const COLUMN_RADIUS: f64 = 0.4;
const SPRING: f64 = 6.0;

/// A hall of 36 x 9 x 24 metres: 97,036 triangles, 39 lights.
pub fn interior() -> Model {
    let (mut b, mut rng) = (Builder::default(), Rng::new(39));
    b.shell(DVec3::ZERO, SIZE, [[0.5, 0.47, 0.42], [0.74, 0.69, 0.6], [0.8, 0.78, 0.74]]);
    arcades(&mut b);
    windows(&mut b);
    stairs(&mut b);
    gallery(&mut b, &mut rng);
    library(&mut b, &mut rng);
    dining(&mut b);
    lounge(&mut b, &mut rng);
    aisle(&mut b);
    b.finish()
}

/// Two rows of five columns that carry arches.
fn arcades(b: &mut Builder) {
    b.paint("limestone", [0.66, 0.6, 0.5]);
    for z in [6.0, 18.0] {
        for i in 0..5 {
            let at = dvec3(3.0 + 5.0 * f64::from(i), 0.0, z);
            column(b, at, COLUMN_RADIUS, SPRING, 12, 4);
            let half = dvec3(0.3, 0.0, 0.3);
            b.cuboid(at - half + DVec3::Y * SPRING, at + half + DVec3::Y * SIZE.y);
            if i < 4 {
                let [low, high] = [0.3, 4.7].map(|x| at + dvec3(x, SPRING, 0.0));
                b.arch(low, high, 0.5, SIZE.y, 24);
            }
        }
    }
}

/// Six windows: daylight behind panes, and curtains.
fn windows(b: &mut Builder) {
    for i in 0..5 {
        b.place(dvec3(5.5 + 5.0 * f64::from(i), 1.0, SIZE.z), 0.5, window);
    }
    b.place(dvec3(0.0, 1.0, 12.0), 0.25, window);
}

/// A window in z = 0 that looks along +z.
fn window(b: &mut Builder) {
    b.light("daylight", [10.0, 11.5, 13.5]);
    b.cuboid(dvec3(-1.1, 0.1, 0.01), dvec3(1.1, 3.9, 0.03));
    b.paint("window frame", [0.8, 0.79, 0.75]);
    for i in 0..4 {
        let (x, y) = (0.8 * f64::from(i) - 1.2, f64::from(i) * 1.3);
        b.cuboid(dvec3(x - 0.04, 0.0, 0.0), dvec3(x + 0.04, 4.0, 0.12));
        b.cuboid(dvec3(-1.16, y, 0.02), dvec3(1.16, y + 0.08, 0.1));
    }
    b.glass("window glass", [0.75, 0.85, 0.85], 0.25);
    b.cuboid(dvec3(-1.2, 0.04, 0.14), dvec3(1.2, 3.96, 0.15));
    b.paint("curtain", [0.45, 0.12, 0.14]);
    for [from, to] in [[-1.9, -1.0], [1.0, 1.9]] {
        b.patch(CURTAIN[0], CURTAIN[1], |u, v| {
            let gather = 0.5 + 0.5 * v;
            let fold = sin_cos(5.0 * u).0 * 0.08 * (1.2 - 0.5 * v);
            let middle = f64::midpoint(from, to);
            dvec3(middle + (to - from) * (u - 0.5) * (1.3 - 0.3 * gather), 4.3 * v - 0.95, 0.3 + fold)
        });
    }
}

/// Columns and rows of the cells of a curtain.
const CURTAIN: [u32; 2] = [24, 6];

/// 25 steps up to the gallery with balustrades at both sides.
fn stairs(b: &mut Builder) {
    let rise = 4.25 / 25.0;
    for i in 0..25 {
        let (x, y) = (20.5 + 0.3 * f64::from(i), rise * f64::from(i + 1));
        b.paint("marble", [0.72, 0.7, 0.68]);
        b.cuboid(dvec3(x, 0.0, 1.0), dvec3(x + 0.3, y, 3.4));
        b.paint("baluster", [0.8, 0.77, 0.7]);
        for z in [1.12, 3.28] {
            baluster(b, dvec3(x + 0.15, y, z), 0.85, 8, 1);
        }
    }
    b.paint("rail", WOOD);
    for z in [1.12, 3.28] {
        b.beam(dvec3(20.4, rise + 0.8, z), dvec3(28.0, 5.17, z), 0.12, 0.08);
    }
}

/// The gallery: its slab, balustrade, lamps and seats.
fn gallery(b: &mut Builder, rng: &mut Rng) {
    b.paint("slab", [0.6, 0.55, 0.48]);
    b.cuboid(dvec3(GALLERY, 4.0, 0.0), dvec3(SIZE.x, 4.25, SIZE.z));
    b.paint("baluster", [0.8, 0.77, 0.7]);
    for i in 0..68 {
        baluster(b, dvec3(GALLERY + 0.15, 4.25, 3.6 + 0.3 * f64::from(i)), 0.9, 8, 1);
    }
    b.paint("rail", WOOD);
    b.beam(dvec3(GALLERY + 0.15, 5.15, 3.45), dvec3(GALLERY + 0.15, 5.15, SIZE.z), 0.14, 0.08);
    for z in [6.0, 12.0, 18.0] {
        lamps::pendant(b, dvec3(32.0, SIZE.y, z), 2.2);
        b.paint("sofa leather", [0.4, 0.2, 0.1]);
        b.place(dvec3(35.0, 4.25, z), 0.75, |b| sofa(b, 2, 4));
        b.place(dvec3(35.3, 4.25, z + 2.6), 0.0, |b| plant(b, 1.3, 40, rng));
    }
}

/// The library below the gallery, behind a wall of glass with one way in.
fn library(b: &mut Builder, rng: &mut Rng) {
    for i in 0..=10 {
        let z = 4.0 + 2.0 * f64::from(i);
        b.paint("mullion", [0.15, 0.15, 0.16]);
        b.cuboid(dvec3(28.25, 0.0, z - 0.06), dvec3(28.35, 4.0, z.min(23.94) + 0.06));
        if i < 10 && i != 4 {
            b.glass("partition glass", [0.7, 0.85, 0.8], 0.2);
            b.cuboid(dvec3(28.29, 0.02, z + 0.08), dvec3(28.31, 3.98, z + 1.92));
        }
    }
    for i in 0..8 {
        let z = 4.4 + 2.5 * f64::from(i);
        b.place(dvec3(SIZE.x, 0.0, z), 0.75, |b| shelves(b, 2.2, 7, 14, rng));
    }
    for (i, z) in [6.5, 11.0, 16.0, 20.5].into_iter().enumerate() {
        lamps::panel(b, dvec3(32.5, 4.0, z));
        if i % 2 == 0 {
            b.place(dvec3(32.0, 0.0, z + 1.0), 0.25, desk);
        }
    }
}

/// A reading desk with a lamp and four chairs.
fn desk(b: &mut Builder) {
    b.paint("desk wood", WOOD);
    table(b, dvec3(2.4, 0.76, 1.1), 16);
    lamps::table_lamp(b, dvec3(0.0, 0.76, 0.0));
    for (x, z, turns) in [(-0.6, -0.75, 0.0), (0.6, -0.75, 0.0), (-0.6, 0.75, 0.5), (0.6, 0.8, 0.47)] {
        b.place(dvec3(x, 0.0, z), turns, |b| chair(b, WOOD, [0.16, 0.26, 0.2], 6, 2, 5));
    }
}

/// The long table under a chandelier.
fn dining(b: &mut Builder) {
    b.place(dvec3(8.5, 0.0, 12.0), 0.0, |b| {
        b.paint("table wood", WOOD);
        table(b, dvec3(6.4, 0.78, 1.4), 24);
        for i in 0..7 {
            let x = 0.85 * f64::from(i) - 2.55;
            for (z, turns) in [(-0.85, 0.0), (0.85, 0.5)] {
                b.place(dvec3(x, 0.0, z), turns + 0.01 * x, |b| {
                    chair(b, WOOD, [0.42, 0.1, 0.12], 6, 2, 5);
                });
                b.paint("porcelain", [0.85, 0.84, 0.8]);
                let plate =
                    [[0.0, 0.0], [0.08, 0.0], [0.14, 0.02], [0.14, 0.026], [0.08, 0.008], [0.0, 0.008]];
                b.lathe(dvec3(x, 0.781, z * 0.55), &plate, 16);
            }
        }
        for (x, height) in [(-1.7, 0.3), (0.0, 0.42), (1.7, 0.3)] {
            b.paint("blue glaze", [0.12, 0.25, 0.5]);
            vase(b, dvec3(x, 0.781, 0.0), height, 24, 2);
        }
    });
    lamps::chandelier(b, dvec3(8.5, SIZE.y, 12.0), 4.6);
}

/// Sofas about a table of glass on a carpet.
fn lounge(b: &mut Builder, rng: &mut Rng) {
    b.place(dvec3(20.0, 0.0, 12.0), 0.0, |b| {
        carpet(b);
        for (x, z, turns, seats) in [(0.0, -1.9, 0.0, 4), (0.0, 1.9, 0.5, 4), (-2.7, 0.0, 0.25, 2)] {
            b.paint("sofa cloth", [0.22, 0.3, 0.42]);
            b.place(dvec3(x, 0.02, z), turns, |b| sofa(b, seats, 4));
        }
        b.paint("brass", [0.62, 0.46, 0.2]);
        legs(b, [0.8, 0.4], 0.03, 0.42, 12);
        b.glass("table glass", [0.6, 0.8, 0.75], 0.35);
        b.cuboid(dvec3(-0.95, 0.42, -0.55), dvec3(0.95, 0.44, 0.55));
        b.paint("red glaze", [0.55, 0.12, 0.08]);
        vase(b, dvec3(0.3, 0.44, 0.1), 0.3, 24, 2);
        for (x, z) in [(2.6, -1.8), (-2.9, 2.0)] {
            lamps::floor_lamp(b, dvec3(x, 0.0, z));
            b.place(dvec3(-x, 0.0, z), 0.0, |b| plant(b, 1.5, 50, rng));
        }
    });
    lamps::chandelier(b, dvec3(20.0, SIZE.y, 12.0), 4.6);
}

/// The carpet of the lounge with its waves, and a runner of 1 x 30 cells beside it.
fn carpet(b: &mut Builder) {
    b.paint("carpet", [0.5, 0.36, 0.22]);
    let wave = |u: f64, v: f64| 0.006 * sin_cos(7.0 * u + v).0 * sin_cos(5.0 * v).0;
    b.patch(CARPET[0], CARPET[1], |u, v| dvec3(7.0 * u - 3.5, 0.012 + wave(u, v), 2.6 - 5.2 * v));
    b.paint("runner", [0.3, 0.1, 0.12]);
    b.patch(1, RUNNER, |u, v| dvec3(2.0 * u + 4.6, 0.012 + wave(v, v), 6.0 - 12.0 * v));
}

const CARPET: [u32; 2] = [50, 40];
const RUNNER: u32 = 30;

/// The aisle along z = 0: lamps, pictures, and vases in cases of glass.
fn aisle(b: &mut Builder) {
    for i in 0..4 {
        lamps::sconce(b, dvec3(3.0 + 5.0 * f64::from(i), 2.6, 0.0), 0.0);
    }
    for z in [6.0, 18.0] {
        lamps::sconce(b, dvec3(0.0, 2.6, z), 0.25);
    }
    let canvases =
        [("landscape", [0.2, 0.36, 0.2]), ("sunset", [0.7, 0.34, 0.12]), ("sea", [0.1, 0.28, 0.45])];
    for (i, (name, colour)) in (0..3).zip(canvases) {
        let x = 5.5 + 5.0 * f64::from(i);
        b.place(dvec3(x, 2.4, 0.0), 0.0, |b| picture(b, [1.3, 0.8], name, colour));
        b.paint("plinth", [0.25, 0.24, 0.24]);
        b.cuboid(dvec3(x - 0.4, 0.0, 2.6), dvec3(x + 0.4, 0.9, 3.4));
        b.paint("green glaze", [0.15, 0.42, 0.32]);
        vase(b, dvec3(x, 0.9, 3.0), 0.7, 36, 2);
        b.glass("case glass", [0.8, 0.88, 0.86], 0.2);
        b.cuboid(dvec3(x - 0.38, 0.901, 2.62), dvec3(x + 0.38, 1.8, 3.38));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_exact() {
        let model = interior();
        assert_eq!(model.lights().len(), 39);
        assert_eq!(model.triangles.len(), 97_036);
    }
}
