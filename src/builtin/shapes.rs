//! Shapes with shared vertices: what closes in the mathematics closes in the indices.
//!
//! Outsides are counterclockwise. Each shape states its number of triangles.

use std::collections::HashMap;

use glam::{DVec3, dvec3};

use super::builder::Builder;
use super::trig::sin_cos;

impl Builder {
    /// An open parametric surface over [0, 1]^2; 2 * nu * nv triangles, facing du x dv.
    pub(crate) fn patch(&mut self, nu: u32, nv: u32, surface: impl Fn(f64, f64) -> DVec3) {
        let mut below = Vec::new();
        for j in 0..=nv {
            let row: Vec<u32> = (0..=nu)
                .map(|i| self.vertex(surface(f64::from(i) / f64::from(nu), f64::from(j) / f64::from(nv))))
                .collect();
            for (low, high) in std::iter::zip(below.windows(2), row.windows(2)) {
                self.quad([low[0], low[1], high[1], high[0]]);
            }
            below = row;
        }
    }

    /// A box that is closed; 12 triangles.
    pub(crate) fn cuboid(&mut self, low: DVec3, high: DVec3) {
        let loop_at = |y| {
            vec![
                dvec3(low.x, y, high.z),
                dvec3(high.x, y, high.z),
                dvec3(high.x, y, low.z),
                dvec3(low.x, y, low.z),
            ]
        };
        self.loft(&[loop_at(low.y), loop_at(high.y)]);
    }

    /// The box seen from inside, the shell of a room, with colours of floor, walls and ceiling;
    /// 12 triangles.
    pub(crate) fn shell(&mut self, low: DVec3, high: DVec3, [floor, walls, ceiling]: [[f32; 3]; 3]) {
        let [below, above] = [low.y, high.y].map(|y| {
            [[low.x, low.z], [high.x, low.z], [high.x, high.z], [low.x, high.z]]
                .map(|[x, z]| self.vertex(dvec3(x, y, z)))
        });
        self.paint("walls", walls);
        self.band(&below, &above);
        self.paint("ceiling", ceiling);
        self.quad(above);
        self.paint("floor", floor);
        let [a, b, c, d] = below;
        self.quad([d, c, b, a]);
    }

    /// A wall above an arch from `low` to `high`, which are the springing points, along x;
    /// 8 * steps + 4 triangles.
    pub(crate) fn arch(&mut self, low: DVec3, high: DVec3, depth: f64, top: f64, steps: u32) {
        let (centre, radius) = ((low + high) / 2.0, (high.x - low.x) / 2.0);
        let loops: Vec<Vec<DVec3>> = (0..=steps)
            .map(|i| {
                let (sin, cos) = sin_cos(f64::from(i) / f64::from(2 * steps));
                let (x, y) = (centre.x - radius * cos, centre.y + radius * sin);
                let (front, back) = (centre.z + depth / 2.0, centre.z - depth / 2.0);
                vec![dvec3(x, y, front), dvec3(x, y, back), dvec3(x, top, back), dvec3(x, top, front)]
            })
            .collect();
        self.loft(&loops);
    }

    /// A closed body through loops of k points, the ends closed with fans (convex loops);
    /// 2 * k * (loops - 1) + 2 * (k - 2) triangles.
    pub(crate) fn loft(&mut self, loops: &[Vec<DVec3>]) {
        let rings: Vec<Vec<u32>> =
            loops.iter().map(|points| points.iter().map(|&p| self.vertex(p)).collect()).collect();
        for pair in rings.windows(2) {
            self.band(&pair[0], &pair[1]);
        }
        let (first, last) = (&rings[0], &rings[rings.len() - 1]);
        for i in 2..first.len() {
            self.triangle([first[0], first[i], first[i - 1]]);
            self.triangle([last[0], last[i - 1], last[i]]);
        }
    }

    /// The band between two rings; a ring of one vertex is a pole.
    fn band(&mut self, low: &[u32], high: &[u32]) {
        let n = low.len().max(high.len());
        for i in 0..n {
            let k = (i + 1) % n;
            match (low.len(), high.len()) {
                (1, _) => self.triangle([low[0], high[k], high[i]]),
                (_, 1) => self.triangle([low[i], low[k], high[0]]),
                _ => self.quad([low[i], low[k], high[k], high[i]]),
            }
        }
    }

    /// Turns a profile of (radius, height), from bottom to top, about the y axis through `at`.
    /// Closed where it begins and ends with radius 0; 2 * segments triangles a step, half of that
    /// at a pole.
    pub(crate) fn lathe(&mut self, at: DVec3, profile: &[[f64; 2]], segments: u32) {
        self.revolve(at, profile, segments, |_| 1.0);
    }

    /// [`Builder::lathe`] with the radius scaled by a function of the angle in turns.
    pub(crate) fn revolve(
        &mut self,
        at: DVec3,
        profile: &[[f64; 2]],
        segments: u32,
        scale: impl Fn(f64) -> f64,
    ) {
        let mut below: Vec<u32> = Vec::new();
        for &[radius, height] in profile {
            let count = if radius == 0.0 { 1 } else { segments };
            let ring: Vec<u32> = (0..count)
                .map(|i| {
                    let turn = f64::from(i) / f64::from(segments);
                    let (sin, cos) = sin_cos(turn);
                    let r = radius * scale(turn);
                    self.vertex(at + dvec3(r * cos, height, -r * sin))
                })
                .collect();
            if !below.is_empty() {
                self.band(&below, &ring);
            }
            below = ring;
        }
    }

    /// A closed sphere with poles on the y axis; 2 * segments * (rings - 1) triangles.
    pub(crate) fn sphere(&mut self, centre: DVec3, radius: f64, segments: u32, rings: u32) {
        let profile: Vec<[f64; 2]> = (0..=rings)
            .map(|i| {
                let (sin, cos) = sin_cos(f64::from(i) / f64::from(2 * rings));
                [if i == 0 || i == rings { 0.0 } else { radius * sin }, -radius * cos]
            })
            .collect();
        self.lathe(centre, &profile, segments);
    }

    /// A closed torus about the y axis; 2 * segments * sides triangles.
    pub(crate) fn torus(&mut self, centre: DVec3, major: f64, minor: f64, segments: u32, sides: u32) {
        let rings: Vec<Vec<u32>> = (0..sides)
            .map(|j| {
                let (sin, cos) = sin_cos(f64::from(j) / f64::from(sides));
                let radius = major + minor * cos;
                (0..segments)
                    .map(|i| {
                        let (s, c) = sin_cos(f64::from(i) / f64::from(segments));
                        self.vertex(centre + dvec3(radius * c, minor * sin, -radius * s))
                    })
                    .collect()
            })
            .collect();
        for j in 0..rings.len() {
            self.band(&rings[j], &rings[(j + 1) % rings.len()]);
        }
    }

    /// A closed, rounded box, a superellipsoid of power 4; 12 * n * n triangles.
    pub(crate) fn cushion(&mut self, low: DVec3, high: DVec3, n: u32) {
        let (centre, half) = ((low + high) / 2.0, (high - low) / 2.0);
        let mut known = HashMap::new();
        for axis in 0..3 {
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            for (side, i, j) in (0..2 * n * n).map(|k| (k / (n * n), k / n % n, k % n)) {
                let corners = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[di, dj]| {
                    let mut lattice = [0; 3];
                    (lattice[axis], lattice[u], lattice[v]) = (side * n, i + di, j + dj);
                    *known.entry(lattice).or_insert_with(|| {
                        let c = DVec3::from_array(lattice.map(|x| f64::from(2 * x) / f64::from(n) - 1.0));
                        let squares = c * c;
                        self.vertex(centre + half * c / squares.length().sqrt())
                    })
                });
                let [a, b, c, d] = corners;
                self.quad(if side == 1 { [a, b, c, d] } else { [a, d, c, b] });
            }
        }
    }

    /// A closed beam with a rectangular cross-section from `a` to `b`, not vertical; 12 triangles.
    pub(crate) fn beam(&mut self, a: DVec3, b: DVec3, width: f64, height: f64) {
        let side = (b - a).cross(DVec3::Y).normalize() * (width / 2.0);
        let up = DVec3::Y * height;
        let section = |p: DVec3| vec![p - side, p + side, p + side + up, p - side + up];
        self.loft(&[section(b), section(a)]);
    }
}

/// A Catmull-Rom curve through all points of a profile, with `steps` steps between two of them.
pub(crate) fn smooth(profile: &[[f64; 2]], steps: u32) -> Vec<[f64; 2]> {
    let at = |i: isize| profile[i.clamp(0, profile.len() as isize - 1) as usize];
    let mut curve = Vec::new();
    for i in 0..profile.len() as isize - 1 {
        let [p0, p1, p2, p3] = [at(i - 1), at(i), at(i + 1), at(i + 2)];
        for step in 0..steps {
            let t = f64::from(step) / f64::from(steps);
            curve.push([0, 1].map(|k| catmull_rom([p0[k], p1[k], p2[k], p3[k]], t)));
        }
    }
    curve.push(at(profile.len() as isize));
    // A curve may overshoot below the axis; there only the ends lie on it.
    let last = curve.len() - 1;
    for point in &mut curve[1..last] {
        point[0] = point[0].max(0.002);
    }
    curve
}

fn catmull_rom([a, b, c, d]: [f64; 4], t: f64) -> f64 {
    b + 0.5 * t * (c - a + t * (2.0 * a - 5.0 * b + 4.0 * c - d + t * (3.0 * (b - c) + d - a)))
}
