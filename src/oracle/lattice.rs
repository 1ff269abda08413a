//! Positions, boxes, triangles and lines in integers of any length, for the tests of coverage.

use glam::Vec3;
use num_bigint::{BigInt, Sign};

use super::exact::{Vector, cross, decompose, dot, sub};
use super::subject::Place;
use crate::arena::Grid;
use crate::ray::Ray;

/// Positions relative to a grid's lower corner as integers.
pub(super) struct Lattice {
    corner: [f64; 3],
    /// A part of a cell.
    part: BigInt,
    exponent: i64,
    parts: u64,
}

impl Lattice {
    /// In which `values` are integers, and the planes between the `parts` of each cell.
    pub(super) fn new(grid: &Grid, parts: u64, values: impl IntoIterator<Item = f64>) -> Self {
        let values = values.into_iter().chain(grid.lo).chain([grid.cell]);
        let exponent = values.map(decompose).filter(|x| x.0 != 0).map(|x| x.1).min().unwrap_or(0);
        let mut lattice = Self { corner: grid.lo, part: BigInt::ZERO, exponent, parts: 1 };
        lattice.part = lattice.length(grid.cell);
        Self { parts, ..lattice }
    }

    pub(super) fn length(&self, x: f64) -> BigInt {
        match decompose(x) {
            (0, _) => BigInt::ZERO,
            (mantissa, exponent) => (BigInt::from(mantissa) << (exponent - self.exponent)) * self.parts,
        }
    }

    pub(super) fn point(&self, p: Vec3) -> Vector {
        std::array::from_fn(|axis| self.length(p[axis].into()) - self.length(self.corner[axis]))
    }

    /// A multiple of a cell, from the corner.
    pub(super) fn cells(&self, x: f64) -> BigInt {
        let (mantissa, exponent) = decompose(x);
        let whole = &self.part * mantissa * self.parts;
        // Planes are compared with what is some 2^-40 cells away.
        if exponent >= 0 { whole << exponent } else { whole >> -exponent }
    }

    /// A place enlarged by a margin.
    pub(super) fn place(&self, place: &Place, margin: &BigInt) -> [Vector; 2] {
        let [lo, hi] = match *place {
            Place::Cube(lo, side) => [lo, lo.map(|i| i + side)].map(|at| at.map(|i| &self.part * i)),
            Place::Box(corners) => corners.map(|at| at.map(|x| self.cells(x))),
        };
        [lo.map(|x| x - margin), hi.map(|x| x + margin)]
    }

    pub(super) fn line(&self, ray: &Ray) -> Line {
        let parts = ray.dir.as_dvec3().to_array().map(decompose);
        let least = parts.iter().filter(|x| x.0 != 0).map(|x| x.1).min().unwrap_or(0);
        let dir = parts.map(|(m, e)| if m == 0 { BigInt::ZERO } else { BigInt::from(m) << (e - least) });
        Line { origin: self.point(ray.origin), dir }
    }
}

/// Whether a closed triangle meets a closed box: no axis of the 13 separates them (Akenine-Moeller 2001).
pub(super) fn overlap(corners: &[Vector; 3], [lo, hi]: &[Vector; 2]) -> bool {
    let edges: [Vector; 3] = std::array::from_fn(|i| sub(&corners[(i + 1) % 3], &corners[i]));
    let unit = |axis: usize| -> Vector { std::array::from_fn(|i| BigInt::from(u8::from(i == axis))) };
    let separates = |axis: &Vector| {
        let at = corners.each_ref().map(|corner| dot(axis, corner));
        let end = |up: bool| -> BigInt {
            let side = |i: usize| if (axis[i].sign() == Sign::Minus) == up { &lo[i] } else { &hi[i] };
            (0..3).map(|i| &axis[i] * side(i)).sum()
        };
        at.iter().all(|x| *x < end(false)) || at.iter().all(|x| *x > end(true))
    };
    let units = [0, 1, 2].map(unit);
    if units.iter().any(&separates) || separates(&cross(&edges[0], &edges[1])) {
        return false;
    }
    !units.iter().any(|unit| edges.iter().any(|edge| separates(&cross(unit, edge))))
}

/// The line of a ray. Its times are integers, multiples of the same unit.
pub(super) struct Line {
    origin: Vector,
    dir: Vector,
}

impl Line {
    /// When it enters and leaves a closed box; `None` where it misses it.
    pub(super) fn times(&self, [lo, hi]: &[Vector; 2]) -> Option<[BigInt; 2]> {
        let mut interval: Option<[BigInt; 2]> = None;
        for axis in 0..3 {
            if self.dir[axis].sign() == Sign::NoSign {
                if self.origin[axis] < lo[axis] || self.origin[axis] > hi[axis] {
                    return None;
                }
                continue;
            }
            let others = (0..3).filter(|&i| i != axis && self.dir[i].sign() != Sign::NoSign);
            let unit: BigInt = others.map(|i| BigInt::from(self.dir[i].magnitude().clone())).product();
            let mut ends = [lo, hi].map(|side| (&side[axis] - &self.origin[axis]) * &unit);
            if self.dir[axis].sign() == Sign::Minus {
                let [a, b] = ends;
                ends = [-b, -a];
            }
            let [a, b] = ends;
            interval = Some(match interval {
                None => [a, b],
                Some([start, end]) => [start.max(a), end.min(b)],
            });
        }
        interval.filter(|[start, end]| start <= end)
    }
}
