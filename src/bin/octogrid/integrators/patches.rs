//! Patches: both sides of every triangle, cut into parts of equal area.
//!
//! n - 1 lines parallel to each edge cut a triangle into n^2 congruent ones, so a patch's area is
//! exact. Patches lie in rows of constant u, from the first edge on, alternating upright and turned.

use octogrid::Hit;

use crate::shade::{Shading, Surface};

/// The most patches that are asked for, to bound memory.
const MOST: f64 = (1 << 24) as f64;

/// The patches of one triangle.
#[derive(Clone, Copy, Debug)]
struct Cut {
    /// The number of the first patch; those of the back follow those of the front.
    first: usize,
    /// Parts of each edge.
    divisions: u32,
    /// Of each patch.
    area: f64,
}

/// The patches of a scene.
pub(super) struct Patches {
    cuts: Vec<Cut>,
    len: usize,
}

impl Patches {
    /// Cuts the triangles of a scene into about `count` parts of similar area, or leaves them whole
    /// where there are more triangles than that.
    pub(super) fn new(shading: &Shading, count: f64) -> Self {
        let area = |triangle| {
            let [a, b, c] = shading.corners(triangle);
            (b - a).cross(c - a).length() / 2.0
        };
        let part = shading.triangles().map(area).sum::<f64>() / count.min(MOST);
        let mut patches = Self { cuts: Vec::new(), len: 0 };
        for area in shading.triangles().map(area) {
            let divisions = (area / part).sqrt().ceil().max(1.0);
            let cut = Cut { first: patches.len, divisions: divisions as u32, area: area / divisions.powi(2) };
            patches.cuts.push(cut);
            patches.len += 2 * (cut.divisions as usize).pow(2);
        }
        patches
    }

    /// The number of patches.
    pub(super) fn len(&self) -> usize {
        self.len
    }

    /// The number of the patch that a point lies in, and its area.
    pub(super) fn at(&self, surface: &Surface) -> (usize, f64) {
        let cut = self.cuts[surface.hit.prim as usize];
        let side = if surface.front { 0 } else { (cut.divisions as usize).pow(2) };
        (cut.first + side + part(&surface.hit, cut.divisions) as usize, cut.area)
    }
}

/// The part of a triangle cut into `n`^2 that a hit lies in.
fn part(hit: &Hit, n: u32) -> u32 {
    let [u, v] = [hit.u, hit.v].map(|x| f64::from(x) * f64::from(n));
    // Rounding may put a point on the far edge beyond it.
    let row = (u as u32).min(n - 1);
    let column = (v as u32).min(n - 1 - row);
    let turned = column < n - 1 - row && u.fract() + v.fract() > 1.0;
    // Before row r there are n^2 - (n - r)^2 patches.
    n * n - (n - row).pow(2) + 2 * column + u32::from(turned)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_numbered_without_gaps_and_equal() {
        let (n, fine) = (5, 50);
        let mut points = [0; 25];
        // The centres of the upright parts of a finer cut.
        for i in 0..fine {
            for j in 0..fine - i {
                let [u, v] = [i, j].map(|x| (x as f32 + 1.0 / 3.0) / fine as f32);
                points[part(&Hit { t: 1.0, u, v, prim: 0 }, n) as usize] += 1;
            }
        }
        // Upright parts have the fine ones of their edges, turned ones don't.
        assert!(points.iter().all(|&p| p == 55 || p == 45), "{points:?}");
    }

    #[test]
    fn far_corners_lie_in_a_part() {
        for (u, v) in [(1.0, 0.0), (0.0, 1.0), (1.0, 1.0), (0.5, 0.5), (0.0, 0.0)] {
            for n in [1, 2, 3, 1000] {
                assert!(part(&Hit { t: 1.0, u, v, prim: 0 }, n) < n * n);
            }
        }
    }
}
