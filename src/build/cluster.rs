//! Clustering: triangles into groups of up to eight neighbours.
//!
//! Recursive binary splits of the triangles at the cheapest of 16 planes an axis (binned surface area
//! heuristic: I. Wald, "On fast Construction of SAH-based Bounding Volume Hierarchies", 2007), where
//! the cost of a side is its area times the number of clusters that it fills. Coplanar neighbours come
//! together, as a flat box has the least area. O(n log n).

use glam::Vec3;

use super::analysis::Analysis;
use crate::aabb::Aabb;
use crate::cluster::Cluster;
use crate::lanes::WIDTH;
use crate::mesh::TriMesh;

const BINS: usize = 16;

/// Gathers the triangles of the analysis into clusters, neighbours near each other.
pub(crate) fn clusters(mesh: &TriMesh<'_>, analysis: &Analysis) -> Vec<Cluster> {
    let mut order: Vec<u32> = (0..analysis.triangles.len() as u32).collect();
    let mut clusters = Vec::with_capacity(order.len() / 5);
    split(&analysis.boxes, &mut order, 0, &mut |members| {
        members.sort_unstable();
        let mut triangles = [(0, [Vec3::ZERO; 3]); WIDTH];
        for (slot, &member) in triangles.iter_mut().zip(&*members) {
            let id = analysis.triangles[member as usize];
            *slot = (id, mesh.corners(id));
        }
        clusters.push(Cluster::new(&triangles[..members.len()]));
    });
    clusters
}

/// Splits until eight are left; halves where no plane helps or planes have peeled off little by little.
fn split(boxes: &[Aabb], members: &mut [u32], depth: u32, emit: &mut impl FnMut(&mut [u32])) {
    const MAX_UNEVEN_DEPTH: u32 = 64;
    if members.len() <= WIDTH {
        if !members.is_empty() {
            emit(members);
        }
        return;
    }
    let middle = match cheapest_plane(boxes, members) {
        Some(plane) if depth < MAX_UNEVEN_DEPTH => {
            partition(members, |&m| plane.is_below(&boxes[m as usize]))
        }
        _ => (members.len() / 2).next_multiple_of(WIDTH).min(members.len() - 1),
    };
    let (below, above) = members.split_at_mut(middle);
    split(boxes, below, depth + 1, emit);
    split(boxes, above, depth + 1, emit);
}

/// A plane between two bins of centres.
struct Plane {
    axis: usize,
    start: f32,
    scale: f32,
    bin: usize,
}

impl Plane {
    fn bin_of(&self, b: &Aabb) -> usize {
        (((b.center()[self.axis] - self.start) * self.scale) as usize).min(BINS - 1)
    }

    fn is_below(&self, b: &Aabb) -> bool {
        self.bin_of(b) <= self.bin
    }
}

#[derive(Clone, Copy)]
struct Bin {
    count: usize,
    bounds: Aabb,
}

impl Bin {
    const EMPTY: Self = Self { count: 0, bounds: Aabb::EMPTY };

    fn merge(self, other: Self) -> Self {
        Self { count: self.count + other.count, bounds: self.bounds.union(other.bounds) }
    }

    fn cost(&self) -> f32 {
        if self.count == 0 { 0.0 } else { self.bounds.half_area() * self.count.div_ceil(WIDTH) as f32 }
    }
}

fn cheapest_plane(boxes: &[Aabb], members: &[u32]) -> Option<Plane> {
    let centers = Aabb::around(members.iter().map(|&m| boxes[m as usize].center()));
    let mut best: Option<(f32, Plane)> = None;
    for axis in 0..3 {
        let scale = BINS as f32 / (centers.hi[axis] - centers.lo[axis]);
        if !scale.is_finite() {
            continue;
        }
        let mut plane = Plane { axis, start: centers.lo[axis], scale, bin: 0 };
        let mut bins = [Bin::EMPTY; BINS];
        for &m in members {
            let b = boxes[m as usize];
            let bin = &mut bins[plane.bin_of(&b)];
            *bin = bin.merge(Bin { count: 1, bounds: b });
        }
        let mut above = [Bin::EMPTY; BINS];
        for i in (0..BINS - 1).rev() {
            above[i] = above[i + 1].merge(bins[i + 1]);
        }
        let mut below = Bin::EMPTY;
        for i in 0..BINS - 1 {
            below = below.merge(bins[i]);
            let cost = below.cost() + above[i].cost();
            let both = below.count > 0 && above[i].count > 0;
            if both && cost.is_finite() && best.as_ref().is_none_or(|(least, _)| cost < *least) {
                plane.bin = i;
                best = Some((cost, Plane { ..plane }));
            }
        }
    }
    best.map(|(_, plane)| plane)
}

/// Moves what is below to the front and returns how many these are.
fn partition(members: &mut [u32], is_below: impl Fn(&u32) -> bool) -> usize {
    let mut count = 0;
    for i in 0..members.len() {
        if is_below(&members[i]) {
            members.swap(i, count);
            count += 1;
        }
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_triangle_is_in_one_cluster() {
        let vertices: Vec<[f32; 3]> =
            (0..300u32).map(|i| [(i * 7 % 31) as f32, (i * 5 % 17) as f32, (i * i % 13) as f32]).collect();
        let triangles: Vec<[u32; 3]> = (0..100).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let mesh = TriMesh::new(&vertices, &triangles).unwrap();
        let analysis = Analysis::new(&mesh);
        let clusters = clusters(&mesh, &analysis);
        let mut ids: Vec<u32> = clusters.iter().flat_map(|c| *c.ids()).filter(|&i| i != u32::MAX).collect();
        ids.sort_unstable();
        assert_eq!(ids, analysis.triangles);
    }

    #[test]
    fn identical_triangles_fill_clusters() {
        let vertices = [[0.0f32; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let triangles = [[0, 1, 2]; 100];
        let mesh = TriMesh::new(&vertices, &triangles).unwrap();
        assert_eq!(clusters(&mesh, &Analysis::new(&mesh)).len(), 13);
    }
}
