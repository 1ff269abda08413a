//! What the phases of the build need to know of a mesh: bounds, zero areas, planes, crowds.

use glam::{DVec3, Vec3, Vec4};

use super::grid::{self, Places};
use crate::aabb::Aabb;
use crate::exact::{self, Difference};
use crate::mesh::TriMesh;
use crate::parallel;

/// The triangles that can be hit, and how they lie.
pub(crate) struct Analysis {
    /// The triangles whose area is not zero, where these aren't all.
    ids: Option<Vec<u32>>,
    /// The box of each of them.
    pub(crate) boxes: Vec<Aabb>,
    /// The box around all.
    pub(crate) bounds: Aabb,
    /// The box around the centres of their boxes.
    pub(crate) centers: Aabb,
}

impl Analysis {
    pub(crate) fn new(mesh: &TriMesh<'_>) -> Self {
        let mut boxes = parallel::map(mesh.triangles(), |&triangle| {
            let corners = mesh.corners_of(triangle);
            if is_degenerate(corners) { Aabb::EMPTY } else { Aabb::around(corners) }
        });
        let (mut around, mut ids) = (Around::all(&boxes), None);
        if around.any_empty {
            ids = Some((0..).zip(&boxes).filter(|(_, b)| **b != Aabb::EMPTY).map(|(i, _)| i).collect());
            boxes.retain(|&b| b != Aabb::EMPTY);
            around = Around::all(&boxes);
        }
        let Around { bounds, centers, .. } = around;
        Self { ids, boxes, bounds, centers }
    }

    /// How many triangles there are.
    pub(crate) fn len(&self) -> usize {
        self.boxes.len()
    }

    /// Which triangle of the mesh the one of a box is.
    #[inline(always)]
    pub(crate) fn id(&self, i: u32) -> u32 {
        self.ids.as_ref().map_or(i, |ids| ids[i as usize])
    }

    /// The triangles, as those of the mesh.
    pub(crate) fn ids(&self) -> impl Iterator<Item = u32> + '_ {
        (0..self.len() as u32).map(|i| self.id(i))
    }

    /// How many triangles have their centre in each voxel of a grid of about so many voxels.
    pub(crate) fn occupants(&self, voxels: f64) -> Vec<u32> {
        let grid = grid::cubic(&self.bounds, voxels);
        let places = Places::new(&grid);
        let mut occupants = vec![0; grid.len()];
        self.boxes.iter().for_each(|b| occupants[places.of(b) as usize] += 1);
        occupants
    }
}

/// The boxes around boxes and around their centres.
#[derive(Clone, Copy)]
pub(super) struct Around {
    pub(super) bounds: Aabb,
    pub(super) centers: Aabb,
    any_empty: bool,
}

impl Around {
    /// Around many boxes. The centres mean nothing where a box is empty.
    fn all(boxes: &[Aabb]) -> Self {
        let portions: Vec<&[Aabb]> = boxes.chunks(1 << 12).collect();
        let none = Self { bounds: Aabb::EMPTY, centers: Aabb::EMPTY, any_empty: false };
        parallel::map(&portions, |boxes| Self::new(boxes.iter())).into_iter().fold(none, |a, b| Self {
            bounds: a.bounds.union(b.bounds),
            centers: a.centers.union(b.centers),
            any_empty: a.any_empty || b.any_empty,
        })
    }

    pub(super) fn new<'a>(boxes: impl Iterator<Item = &'a Aabb>) -> Self {
        // On four lanes, as minima and maxima of single floats are several instructions each, for NaN.
        let (mut lo, mut hi, mut any_empty) = (Vec4::INFINITY, Vec4::NEG_INFINITY, false);
        let (mut first, mut last) = (lo, hi);
        for b in boxes {
            let (l, h) = (b.lo.extend(0.0), b.hi.extend(0.0));
            let center = b.center4();
            (lo, hi) = (lo.min(l), hi.max(h));
            (first, last) = (first.min(center), last.max(center));
            any_empty |= b.lo.x > b.hi.x;
        }
        let bounds = Aabb { lo: lo.truncate(), hi: hi.truncate() };
        Self { bounds, centers: Aabb { lo: first.truncate(), hi: last.truncate() }, any_empty }
    }
}

/// Whether the area is exactly zero, so that no ray can hit the triangle.
fn is_degenerate([v0, v1, v2]: [Vec3; 3]) -> bool {
    // Where a bound of the rounding errors leaves no doubt: in f32, then in f64.
    let (e1, e2) = (v1 - v0, v2 - v0);
    // Multiplied in this order it overflows before any product of theirs.
    let bound = e1.abs().max_element() * e2.abs().max_element() * (8.0 * f32::EPSILON) + f32::MIN_POSITIVE;
    if e1.cross(e2).abs().max_element() > bound {
        return false;
    }
    let (e1, e2) = (v1.as_dvec3() - v0.as_dvec3(), v2.as_dvec3() - v0.as_dvec3());
    let bound = 8.0 * f64::EPSILON * e1.abs().max_element() * e2.abs().max_element();
    if e1.cross(e2).abs().max_element() > bound {
        return false;
    }
    let edge = |to: Vec3| -> [Difference; 3] {
        std::array::from_fn(|axis| Difference::new(f64::from(to[axis]), f64::from(v0[axis])))
    };
    exact::cross(&edge(v1), &edge(v2)).iter().all(|e| e.sign() == 0.0)
}

/// For each triangle of the mesh a number that triangles in the same plane share.
///
/// Planes count as the same where their unit normals (of either sense) agree to 2^-16 and their
/// distances to 2^-20 of the scene's size; a heuristic for the octree's criterion, of no influence on
/// any answer.
pub(crate) fn planes(mesh: &TriMesh<'_>, analysis: &Analysis) -> Vec<u32> {
    let size = analysis.bounds.extent().as_dvec3().max_element();
    let middle = analysis.bounds.center().as_dvec3();
    let mut keys: Vec<([i64; 4], u32)> =
        analysis.ids().map(|i| (plane_key(mesh.corners(i), middle, size), i)).collect();
    keys.sort_unstable();
    let mut planes = vec![u32::MAX; mesh.len()];
    let mut plane = 0;
    for (i, (key, triangle)) in keys.iter().enumerate() {
        plane += u32::from(i > 0 && *key != keys[i - 1].0);
        planes[*triangle as usize] = plane;
    }
    planes
}

fn plane_key(corners: [Vec3; 3], middle: DVec3, size: f64) -> [i64; 4] {
    let [v0, v1, v2] = corners.map(|c| c.as_dvec3() - middle);
    let normal = (v1 - v0).cross(v2 - v0).normalize_or_zero();
    let rounded = (normal * 65536.0).round().to_array().map(|x| x as i64);
    let flip = if rounded.iter().find(|&&x| x != 0).is_some_and(|&x| x < 0) { -1 } else { 1 };
    let distance = (normal.dot(v0) / size * 1_048_576.0).round() as i64;
    let [x, y, z] = rounded;
    [x, y, z, distance].map(|k| k * flip)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zero_area_is_exact() {
        let corners = |v: [[f32; 3]; 3]| v.map(Vec3::from_array);
        assert!(is_degenerate(corners([[0.1; 3], [0.3; 3], [0.7; 3]])));
        assert!(is_degenerate(corners([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [1.0, 2.0, 3.0]])));
        let almost = [[0.1, 0.1, 0.1], [0.3, 0.3, 0.3], [0.7, 0.7, 0.7f32.next_up()]];
        assert!(!is_degenerate(corners(almost)));
        assert!(!is_degenerate(corners([[0.0; 3], [1e-45, 0.0, 0.0], [0.0, 1e-45, 0.0]])));
        assert!(!is_degenerate(corners([[0.0; 3], [3e38, 0.0, 0.0], [0.0, -3e38, 0.0]])));
    }

    #[test]
    fn coplanar_triangles_share_a_plane_of_either_sense() {
        let v = [[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 1.0, 1.0], [0.0, 1.0, 1.0], [0.0, 0.0, 0.0]];
        let mesh = TriMesh::new(&v, &[[0, 1, 2], [0, 3, 2], [4, 1, 2], [0, 0, 1]]).unwrap();
        let analysis = Analysis::new(&mesh);
        assert!(analysis.ids().eq([0, 1, 2]));
        let planes = planes(&mesh, &analysis);
        assert_eq!(planes[0], planes[1]);
        assert_ne!(planes[0], planes[2]);
    }
}
