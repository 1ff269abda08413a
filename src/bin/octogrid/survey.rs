//! Measures of a model's triangles.

use std::collections::{HashMap, HashSet};

use glam::DVec3;
use octogrid::Model;

/// The corners of a triangle in f64, in which their differences don't overflow.
pub(crate) fn corners(model: &Model, triangle: u32) -> [DVec3; 3] {
    model.triangles[triangle as usize].map(|i| DVec3::from_array(model.vertices[i as usize].map(f64::from)))
}

fn all_corners(model: &Model) -> impl Iterator<Item = [DVec3; 3]> {
    (0..model.triangles.len() as u32).map(|triangle| corners(model, triangle))
}

/// The least and the greatest corner of the box around the triangles; none without triangles.
pub(crate) fn bounds(model: &Model) -> Option<(DVec3, DVec3)> {
    let points = all_corners(model).flatten().map(|p| (p, p));
    points.reduce(|(low, high), (p, _)| (low.min(p), high.max(p)))
}

/// Triangles without an area.
pub(crate) fn degenerate(model: &Model) -> usize {
    all_corners(model).filter(|[a, b, c]| (b - a).cross(c - a) == DVec3::ZERO).count()
}

/// Triangles with the same three corners as an earlier one, in any order.
pub(crate) fn repeated(model: &Model) -> usize {
    let mut seen = HashSet::new();
    let key = |corners: [DVec3; 3]| {
        // Adding 0 makes one zero of the two.
        let mut bits = corners.map(|p| p.to_array().map(|x| (x + 0.0).to_bits()));
        bits.sort_unstable();
        bits
    };
    all_corners(model).filter(|&corners| !seen.insert(key(corners))).count()
}

/// The number of planes that hold at least two triangles, and the triangles in them.
///
/// Planes are equal where normal and offset are, to five digits.
pub(crate) fn coplanar(model: &Model) -> (usize, usize) {
    let Some((low, high)) = bounds(model) else { return (0, 0) };
    let middle = (low + high) / 2.0;
    let extent = (high - low).max_element();
    let mut planes: HashMap<[i64; 4], usize> = HashMap::new();
    for [a, b, c] in all_corners(model) {
        let Some(normal) = (b - a).cross(c - a).try_normalize() else { continue };
        let offset = normal.dot((a + b + c) / 3.0 - middle) / extent;
        let plane = [normal.x, normal.y, normal.z, offset].map(|x| (x * 1e5).round() as i64);
        // Of the two normals of a plane the one whose first component that is not zero is positive.
        let flip = plane[..3].iter().find(|&&x| x != 0).is_some_and(|&x| x < 0);
        *planes.entry(if flip { plane.map(|x| -x) } else { plane }).or_default() += 1;
    }
    let groups = planes.values().filter(|&&n| n > 1);
    (groups.clone().count(), groups.sum())
}

/// Triangles on which one coordinate is constant.
pub(crate) fn axis_aligned(model: &Model) -> usize {
    all_corners(model).filter(|[a, b, c]| (0..3).any(|axis| a[axis] == b[axis] && b[axis] == c[axis])).count()
}

/// The edges of one triangle, of two, and of more: only the second kind where a mesh is closed. Corners in the
/// same place are one.
pub(crate) fn edges(model: &Model) -> [usize; 3] {
    let mut triangles: HashMap<[[u64; 3]; 2], usize> = HashMap::new();
    // Adding 0 makes one zero of the two.
    let bits = |p: DVec3| p.to_array().map(|x| (x + 0.0).to_bits());
    for [a, b, c] in all_corners(model) {
        for [from, to] in [[a, b], [b, c], [c, a]] {
            let mut edge = [bits(from), bits(to)];
            edge.sort_unstable();
            *triangles.entry(edge).or_default() += 1;
        }
    }
    let mut edges = [0; 3];
    triangles.values().for_each(|&n| edges[n.min(3) - 1] += 1);
    edges
}

/// The longest edge of each triangle, sorted.
pub(crate) fn longest_edges(model: &Model) -> Vec<f64> {
    let longest = |[a, b, c]: [DVec3; 3]| a.distance(b).max(b.distance(c)).max(c.distance(a));
    let mut edges: Vec<f64> = all_corners(model).map(longest).collect();
    edges.sort_by(f64::total_cmp);
    edges
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_small_model_is_measured() {
        let vertices = vec![[0.0; 3], [3.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, -0.0, 1.0], [3.0, 4.0, 0.0]];
        let triangles = vec![[0, 1, 2], [2, 0, 1], [1, 4, 2], [0, 1, 3], [0, 0, 1]];
        let model = Model { vertices, triangles, ..Model::default() };
        assert_eq!(bounds(&model), Some((DVec3::ZERO, DVec3::new(3.0, 4.0, 1.0))));
        assert_eq!((degenerate(&model), repeated(&model)), (1, 1));
        assert_eq!(coplanar(&model), (1, 3));
        assert_eq!(axis_aligned(&model), 5);
        // The last triangle has an edge from a corner to itself, and twice one that three others have.
        assert_eq!(edges(&model), [5, 1, 2]);
        assert_eq!(longest_edges(&model), [3.0, 10f64.sqrt(), 5.0, 5.0, 5.0]);
    }
}
