//! Furniture and turned parts, each standing on y = 0 about the origin.

use glam::{DVec3, dvec3};

use super::builder::Builder;
use super::shapes::smooth;
use crate::rng::Rng;

/// The profile of a turned table leg of height 1 and unit width, to be scaled.
const LEG: [[f64; 2]; 9] = [
    [0.0, 0.0],
    [0.55, 0.0],
    [0.7, 0.06],
    [0.4, 0.14],
    [0.75, 0.5],
    [0.5, 0.75],
    [1.0, 0.8],
    [1.0, 1.0],
    [0.0, 1.0],
];

/// A turned leg; 14 * segments triangles.
pub(crate) fn leg(b: &mut Builder, at: DVec3, radius: f64, height: f64, segments: u32) {
    b.lathe(at, &LEG.map(|[r, y]| [r * radius, y * height]), segments);
}

/// Four turned legs at the corners of a rectangle; 56 * segments triangles.
pub(crate) fn legs(b: &mut Builder, half: [f64; 2], radius: f64, height: f64, segments: u32) {
    for [x, z] in [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]] {
        leg(b, dvec3(x * half[0], 0.0, z * half[1]), radius, height, segments);
    }
}

/// A table: a top with four aprons on turned legs; 60 + 56 * segments triangles.
pub(crate) fn table(b: &mut Builder, size: DVec3, segments: u32) {
    let (x, z) = (size.x / 2.0, size.z / 2.0);
    let under = size.y - 0.04;
    b.cuboid(dvec3(-x, under, -z), dvec3(x, size.y, z));
    legs(b, [x - 0.1, z - 0.1], 0.045, under, segments);
    for side in [-1.0, 1.0] {
        let (ax, az) = (side * (x - 0.1), side * (z - 0.1));
        b.cuboid(dvec3(0.15 - x, under - 0.1, az - 0.012), dvec3(x - 0.15, under, az + 0.012));
        b.cuboid(dvec3(ax - 0.012, under - 0.1, 0.15 - z), dvec3(ax + 0.012, under, z - 0.15));
    }
}

/// A chair that looks along +z: legs, seat, a cushion of n * n * 12, and a back with `slats`;
/// 48 + 56 * segments + 12 * (n * n + slats) triangles.
pub(crate) fn chair(b: &mut Builder, wood: [f32; 3], cloth: [f32; 3], segments: u32, n: u32, slats: u32) {
    b.paint("chair wood", wood);
    legs(b, [0.19, 0.19], 0.024, 0.43, segments);
    b.cuboid(dvec3(-0.22, 0.43, -0.22), dvec3(0.22, 0.46, 0.22));
    for x in [-0.2, 0.2] {
        b.cuboid(dvec3(x - 0.02, 0.46, -0.22), dvec3(x + 0.02, 0.98, -0.185));
    }
    b.cuboid(dvec3(-0.22, 0.98, -0.225), dvec3(0.22, 1.05, -0.18));
    for i in 0..slats {
        let x = 0.36 * (f64::from(i) + 0.5) / f64::from(slats) - 0.18;
        b.cuboid(dvec3(x - 0.013, 0.46, -0.21), dvec3(x + 0.013, 0.98, -0.195));
    }
    b.paint("chair cloth", cloth);
    b.cushion(dvec3(-0.2, 0.455, -0.17), dvec3(0.2, 0.53, 0.21), n);
}

/// A sofa of `seats` that looks along +z; 12 * (3 + (2 * seats + 2) * n * n) triangles.
pub(crate) fn sofa(b: &mut Builder, seats: u32, n: u32) {
    let half = 0.36 * f64::from(seats);
    b.cuboid(dvec3(-half - 0.18, 0.08, -0.4), dvec3(half + 0.18, 0.28, 0.42));
    for x in [-half - 0.1, half + 0.1] {
        b.cuboid(dvec3(x - 0.05, 0.0, -0.35), dvec3(x + 0.05, 0.08, 0.38));
        b.cushion(dvec3(x - 0.12, 0.22, -0.44), dvec3(x + 0.12, 0.66, 0.46), n);
    }
    for i in 0..seats {
        let x = 0.72 * (f64::from(i) + 0.5) - half;
        b.cushion(dvec3(x - 0.36, 0.27, -0.3), dvec3(x + 0.36, 0.47, 0.46), n);
        b.cushion(dvec3(x - 0.36, 0.4, -0.46), dvec3(x + 0.36, 0.92, -0.2), n);
    }
}

/// Bookshelves against z = 0 that look along +z, `rows` rows of `books` books;
/// 12 * (3 + rows + 1 + rows * books) triangles.
pub(crate) fn shelves(b: &mut Builder, width: f64, rows: u32, books: u32, rng: &mut Rng) {
    const SPINES: [[f32; 3]; 6] = [
        [0.45, 0.1, 0.08],
        [0.1, 0.2, 0.4],
        [0.12, 0.3, 0.16],
        [0.6, 0.5, 0.3],
        [0.3, 0.14, 0.3],
        [0.65, 0.35, 0.1],
    ];
    let (half, height) = (width / 2.0, 0.4 * f64::from(rows) + 0.03);
    b.paint("shelf wood", [0.28, 0.16, 0.08]);
    b.cuboid(dvec3(-half, 0.0, 0.0), dvec3(half, height, 0.02));
    for x in [-half - 0.03, half] {
        b.cuboid(dvec3(x, 0.0, 0.0), dvec3(x + 0.03, height, 0.3));
    }
    for row in 0..=rows {
        let y = 0.4 * f64::from(row);
        b.cuboid(dvec3(-half, y, 0.02), dvec3(half, y + 0.03, 0.3));
    }
    let pitch = width / f64::from(books);
    for (row, book) in (0..rows * books).map(|i| (i / books, i % books)) {
        let (x, y) = (pitch * f64::from(book) - half, 0.4 * f64::from(row) + 0.031);
        let spine = rng.below(SPINES.len());
        b.paint(["book 1", "book 2", "book 3", "book 4", "book 5", "book 6"][spine], SPINES[spine]);
        let high = dvec3(x + pitch * rng.range(0.7, 0.97), y + rng.range(0.22, 0.34), rng.range(0.2, 0.28));
        b.cuboid(dvec3(x + pitch * 0.02, y, 0.03), high);
    }
}

/// A vase with a wall, closed; 2 * (12 * steps - 1) * segments triangles.
pub(crate) fn vase(b: &mut Builder, at: DVec3, height: f64, segments: u32, steps: u32) {
    const WALL: [[f64; 2]; 13] = [
        [0.0, 0.0],
        [0.16, 0.0],
        [0.2, 0.03],
        [0.32, 0.3],
        [0.34, 0.5],
        [0.16, 0.8],
        [0.22, 1.0],
        [0.2, 1.0],
        [0.14, 0.8],
        [0.3, 0.5],
        [0.28, 0.3],
        [0.1, 0.06],
        [0.0, 0.05],
    ];
    b.lathe(at, &smooth(&WALL.map(|[r, y]| [r * height, y * height]), steps), segments);
}

/// A plant in a pot: 160 triangles, and 16 a leaf.
pub(crate) fn plant(b: &mut Builder, height: f64, leaves: u32, rng: &mut Rng) {
    b.paint("terracotta", [0.6, 0.28, 0.16]);
    let pot = [[0.0, 0.0], [0.15, 0.0], [0.2, 0.3], [0.22, 0.3], [0.22, 0.36], [0.0, 0.35]];
    b.lathe(DVec3::ZERO, &pot, 20);
    b.paint("leaf", [0.14, 0.36, 0.1]);
    for _ in 0..leaves {
        let (lean, rise, width) = (rng.range(0.15, 0.6), rng.range(0.3, 1.0) * height, rng.range(0.05, 0.1));
        b.place(dvec3(0.0, 0.34, 0.0), rng.unit(), |b| {
            b.patch(2, 4, |u, v| {
                let fold = (2.0 * u - 1.0) * (2.0 * u - 1.0);
                let half = width * (1.0 - v) * (0.3 + 2.8 * v);
                dvec3((2.0 * u - 1.0) * half, rise * v * (1.7 - v) + 0.03 * fold, lean * v * v + 0.04 * v)
            });
        });
    }
}

/// A turned baluster of a given height; 2 * (9 * steps - 1) * segments triangles.
pub(crate) fn baluster(b: &mut Builder, at: DVec3, height: f64, segments: u32, steps: u32) {
    const TURNED: [[f64; 2]; 10] = [
        [0.0, 0.0],
        [0.05, 0.0],
        [0.05, 0.1],
        [0.025, 0.14],
        [0.06, 0.32],
        [0.03, 0.62],
        [0.022, 0.78],
        [0.04, 0.86],
        [0.045, 1.0],
        [0.0, 1.0],
    ];
    b.lathe(at, &smooth(&TURNED.map(|[r, y]| [r, y * height]), steps), segments);
}

/// A fluted column with plinth, base, swelling shaft, capital and abacus;
/// 24 + 2 * 32 * 12 + 8 * flutes * (bands + 1) triangles.
pub(crate) fn column(b: &mut Builder, at: DVec3, radius: f64, height: f64, flutes: u32, bands: u32) {
    let corner = |y: f64| dvec3(1.35 * radius, y, 1.35 * radius);
    b.cuboid(at - corner(0.0), at + corner(0.15));
    b.cuboid(at - corner(0.15 - height), at + corner(height));
    let ring = |r: f64, y: f64| [r * radius, y];
    let base = [ring(0.0, 0.15), ring(1.3, 0.15), ring(1.35, 0.22), ring(1.25, 0.29)];
    let base = [&base[..], &[ring(1.1, 0.31), ring(1.12, 0.36), ring(1.02, 0.4), ring(0.0, 0.4)]].concat();
    b.lathe(at, &base, 32);
    let capital = [ring(0.0, -0.55), ring(0.95, -0.55), ring(0.95, -0.45), ring(1.05, -0.42)];
    let capital =
        [&capital[..], &[ring(1.0, -0.38), ring(1.15, -0.3), ring(1.3, -0.15), ring(0.0, -0.15)]].concat();
    b.lathe(at + DVec3::Y * height, &capital, 32);
    let shaft = |i: u32| {
        let t = f64::from(i) / f64::from(bands);
        ring(1.0 - 0.15 * t * t, 0.4 + (height - 0.95) * t)
    };
    let shaft: Vec<_> =
        [vec![ring(0.0, 0.4)], (0..=bands).map(shaft).collect(), vec![ring(0.0, height - 0.55)]].concat();
    b.revolve(at, &shaft, flutes * 4, |turn| {
        let phase = (turn * f64::from(flutes)).fract() * 2.0 - 1.0;
        1.0 - 0.07 * (1.0 - phase * phase)
    });
}

/// A picture in a frame against z = 0 that looks along +z; 60 triangles.
pub(crate) fn picture(b: &mut Builder, half: [f64; 2], name: &str, colour: [f32; 3]) {
    let [x, y] = half;
    b.paint("gilt", [0.65, 0.48, 0.18]);
    for side in [-1.0, 1.0] {
        b.cuboid(dvec3(side * x - 0.03, -y - 0.03, 0.0), dvec3(side * x + 0.03, y + 0.03, 0.04));
        b.cuboid(dvec3(0.03 - x, side * y - 0.03, 0.0), dvec3(x - 0.03, side * y + 0.03, 0.04));
    }
    b.paint(name, colour);
    b.cuboid(dvec3(0.03 - x, 0.03 - y, 0.0), dvec3(x - 0.03, y - 0.03, 0.015));
}
