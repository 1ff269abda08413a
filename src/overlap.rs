//! Which triangles of a cluster overlap a box: never missing one, now and then adding one.
//!
//! The separating axes of Akenine-Moeller, "Fast 3D Triangle-Box Overlap Testing" (2001): the box's
//! three, the triangle's normal, and their nine cross products, on eight triangles at once. Every
//! comparison is widened by the bound of its rounding error, so that "no overlap" is certain.

use crate::aabb::Aabb;
use crate::lanes::{Lanes, Twice, Vec3Lanes, axes, cross, dot, minus, splat};

/// The lanes whose triangle may overlap `bounds`, as bits.
///
/// With A the largest absolute coordinate relative to the middle of the box, E that of an edge and
/// e = 2^-24, the errors stay below e A (box axes), 7 e A E (cross products) and 99 e A E E (normal); the
/// bounds are 16, 16 and 256 times. That edges and normals are rounded only turns the axes, of which any
/// may separate. Where something overflows, so does its bound, and infinite and NaN bounds exclude nothing.
#[inline(always)]
pub(crate) fn overlapping<L: Lanes>(lanes: L, corners: [Vec3Lanes<L>; 3], bounds: &Aabb) -> u32 {
    let middle = bounds.center();
    // Covers the rounding of the middle and of what is multiplied with it.
    let half = (bounds.hi - middle).max(middle - bounds.lo) * (1.0 + 4.0 * f32::EPSILON);
    let (m, half) = (splat(lanes, middle), splat(lanes, half));
    let v = [minus::<L>(corners[0], m), minus::<L>(corners[1], m), minus::<L>(corners[2], m)];
    let [c0, c1, c2] = corners;
    let edges = [minus::<L>(c1, c0), minus::<L>(c2, c1), minus::<L>(c0, c2)];
    let a = largest(lanes, &v);
    let e = largest(lanes, &edges);
    // 4 A, 4 A E and 16 A E E are above every intermediate value, so that they overflow first.
    let bound = |most: L::F32| lanes.splat(2f32.powi(-22)) * most + lanes.splat(f32::MIN_POSITIVE);
    let a4 = lanes.splat(4.0) * a;
    let (eps_a, eps_ae) = (bound(a4), bound(a4 * e));
    let eps_aee = bound(lanes.splat(16.0) * (a4 * e * e));

    let mut apart = lanes.less(lanes.splat(1.0), lanes.splat(0.0));
    for axis in 0..3 {
        let coordinates = [v[0][axis], v[1][axis], v[2][axis]];
        apart = apart | separated(lanes, &coordinates, half[axis] + eps_a);
        let (j, k) = ((axis + 1) % 3, (axis + 2) % 3);
        for edge in &edges {
            // The axis' unit vector x edge has the components -edge[k] and edge[j].
            let coordinates = axes(
                #[inline(always)]
                |corner| v[corner][k] * edge[j] - v[corner][j] * edge[k],
            );
            let reach = half[j] * lanes.abs(edge[k]) + half[k] * lanes.abs(edge[j]);
            apart = apart | separated(lanes, &coordinates, reach + eps_ae);
        }
    }
    let normal = cross::<Twice, L>(lanes, edges[0], edges[1]);
    let size = axes(
        #[inline(always)]
        |axis| lanes.abs(normal[axis]),
    );
    let reach = dot::<Twice, L>(lanes, half, size);
    apart = apart | lanes.less(reach + eps_aee, lanes.abs(dot::<Twice, L>(lanes, normal, v[0])));
    !lanes.bits(apart) & 0xff
}

/// The largest absolute coordinate.
#[inline(always)]
fn largest<L: Lanes>(lanes: L, vectors: &[Vec3Lanes<L>; 3]) -> L::F32 {
    let mut most = lanes.splat(0.0);
    for x in vectors.as_flattened() {
        most = lanes.max(most, lanes.abs(*x));
    }
    most
}

/// Where all three coordinates lie beyond `reach` on the same side of zero.
#[inline(always)]
fn separated<L: Lanes>(lanes: L, [a, b, c]: &[L::F32; 3], reach: L::F32) -> L::Mask {
    let (low, high) = (lanes.min(lanes.min(*a, *b), *c), lanes.max(lanes.max(*a, *b), *c));
    lanes.less(reach, low) | lanes.less(high + reach, lanes.splat(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cluster::Cluster;
    use crate::lanes::{Isa, Portable, dispatch};
    use glam::Vec3;

    fn overlaps(triangle: [[f32; 3]; 3], lo: [f32; 3], hi: [f32; 3]) -> bool {
        let cluster = Cluster::new(&[(0, triangle.map(Vec3::from_array))]);
        let bounds = Aabb { lo: Vec3::from_array(lo), hi: Vec3::from_array(hi) };
        overlapping(Portable, cluster.lanes(Portable), &bounds) & 1 != 0
    }

    const SLANTED: [[f32; 3]; 3] = [[3.0, 0.0, 0.0], [0.0, 3.0, 0.0], [0.0, 0.0, 3.0]];

    #[test]
    fn each_kind_of_axis_separates() {
        assert!(overlaps(SLANTED, [0.9; 3], [1.1; 3]));
        assert!(!overlaps(SLANTED, [4.0, 0.0, 0.0], [5.0, 1.0, 1.0]), "box axis");
        assert!(!overlaps(SLANTED, [0.0; 3], [0.9; 3]), "normal");
        assert!(!overlaps(SLANTED, [2.0, 2.0, -1.0], [2.5, 2.5, 1.0]), "cross product");
        assert!(overlaps(SLANTED, [-9.0; 3], [9.0; 3]), "inside");
    }

    #[test]
    fn touching_counts() {
        assert!(overlaps(SLANTED, [3.0, 0.0, 0.0], [4.0, 1.0, 1.0]));
        assert!(overlaps([[0.0; 3]; 3], [0.0; 3], [1.0; 3]));
        assert!(!overlaps([[-1e-6, 0.0, 0.0]; 3], [0.0; 3], [0.1; 3]));
    }

    #[test]
    fn overflow_excludes_nothing() {
        let huge = [[3e38, 0.0, 0.0], [-3e38, 1e38, 0.0], [0.0, -3e38, 1.0]];
        assert!(overlaps(huge, [-1.0; 3], [1.0; 3]));
        assert!(overlaps(huge, [-3e38; 3], [3e38; 3]));
    }

    #[test]
    fn a_box_around_a_corner_overlaps_at_every_scale() {
        let mut rng = crate::rng::Rng::new(1);
        for i in 0..4000 {
            let scale = 10f32.powi(i % 76 - 38);
            let corners = [(); 3].map(|()| (rng.in_cube().as_vec3()) * scale);
            let cluster = Cluster::new(&[(0, corners)]);
            let half = Vec3::splat(0.01 * scale);
            let bounds = Aabb { lo: corners[1] - half, hi: corners[1] + half };
            for isa in Isa::available() {
                let mask = dispatch!(isa, lanes => overlapping(lanes, cluster.lanes(lanes), &bounds));
                assert_eq!(mask, 0xff, "{isa} {corners:?}");
            }
        }
    }
}
