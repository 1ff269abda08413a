//! Clustering: triangles into groups of up to eight neighbours.
//!
//! Recursive binary splits of the triangles at the cheapest of 16 planes an axis (binned surface area
//! heuristic: I. Wald, "On fast Construction of SAH-based Bounding Volume Hierarchies", 2007), where
//! the cost of a side is its area times the number of clusters that it fills. Coplanar neighbours come
//! together, as a flat box has the least area. O(n log n), in parallel, in place.

use glam::{Vec3, Vec4};

use super::analysis::Analysis;
use crate::aabb::Aabb;
use crate::cluster::Cluster;
use crate::lanes::WIDTH;
use crate::mesh::TriMesh;
use crate::parallel;

const BINS: usize = 16;

/// Gathers the triangles of the analysis into clusters, neighbours near each other.
///
/// The same for any number of threads.
pub(crate) fn clusters(mesh: &TriMesh<'_>, analysis: &Analysis) -> Vec<Cluster> {
    let mut members: Vec<Member> = (0..).zip(&analysis.boxes).map(|(i, b)| Member::new(i, b)).collect();
    let mut ends = vec![false; members.len()];
    split(&mut members, &mut ends, 0);
    let mut start = 0;
    let runs: Vec<&[Member]> = (1..=members.len())
        .filter(|&end| ends[end - 1])
        .map(|end| &members[std::mem::replace(&mut start, end)..end])
        .collect();
    parallel::map(&runs, |run| gather(mesh, analysis, run))
}

fn gather(mesh: &TriMesh<'_>, analysis: &Analysis, members: &[Member]) -> Cluster {
    let mut triangles = [(u32::MAX, [Vec3::ZERO; 3]); WIDTH];
    for (slot, member) in triangles.iter_mut().zip(members) {
        let id = analysis.triangles[member.index() as usize];
        *slot = (id, mesh.corners(id));
    }
    let triangles = &mut triangles[..members.len()];
    triangles.sort_unstable_by_key(|(id, _)| *id);
    Cluster::new(triangles)
}

/// A triangle's box and index.
///
/// The fourth lanes hold the halves of the index as whole numbers: arithmetic on all four lanes is one
/// instruction, and slow where one is subnormal.
#[derive(Clone, Copy)]
struct Member {
    lo: Vec4,
    hi: Vec4,
}

impl Member {
    fn new(index: u32, b: &Aabb) -> Self {
        Self { lo: b.lo.extend((index & 0xffff) as f32), hi: b.hi.extend((index >> 16) as f32) }
    }

    fn index(&self) -> u32 {
        self.lo.w as u32 | (self.hi.w as u32) << 16
    }

    #[inline(always)]
    fn center(&self) -> Vec4 {
        self.lo * 0.5 + self.hi * 0.5
    }
}

/// Splits until eight are left, and marks the last of them in `ends`; halves where no plane helps or
/// planes have peeled off little by little.
fn split(members: &mut [Member], ends: &mut [bool], depth: u32) {
    const MAX_UNEVEN_DEPTH: u32 = 64;
    const PARALLEL: usize = 4096;
    if members.len() <= WIDTH {
        ends.last_mut().into_iter().for_each(|end| *end = true);
        return;
    }
    let plane =
        if members.len() < 4 * BINS { cheapest_plane::<8>(members) } else { cheapest_plane::<BINS>(members) };
    let middle = match plane {
        Some(plane) if depth < MAX_UNEVEN_DEPTH => partition(members, plane.is_below()),
        _ => (members.len() / 2).next_multiple_of(WIDTH).min(members.len() - 1),
    };
    let (below, above) = members.split_at_mut(middle);
    let (ends_below, ends_above) = ends.split_at_mut(middle);
    if below.len().min(above.len()) < PARALLEL {
        split(below, ends_below, depth + 1);
        split(above, ends_above, depth + 1);
    } else {
        parallel::join(|| split(below, ends_below, depth + 1), || split(above, ends_above, depth + 1));
    }
}

/// Bins of the centres along each axis.
struct Binning {
    start: Vec4,
    scale: Vec4,
}

impl Binning {
    /// From here on f32 are whole numbers: adding it rounds to the last bits.
    const WHOLE: f32 = (1u32 << 23) as f32;

    fn new(members: &[Member], bins: usize) -> Self {
        let (mut lo, mut hi) = (Vec4::MAX, Vec4::MIN);
        for member in members {
            let center = member.center();
            (lo, hi) = (lo.min(center), hi.max(center));
        }
        // The outer bins are half as wide.
        let scale = ((bins - 1) as f32 / (hi - lo)).to_array().map(|x| if x.is_finite() { x } else { 0.0 });
        Self { start: lo, scale: Vec4::from_array(scale) }
    }

    /// The bin of a member along each axis, of `N`; the fourth means nothing.
    #[inline(always)]
    fn of<const N: usize>(&self, member: &Member) -> [usize; 4] {
        let place = (member.center() - self.start) * self.scale + Vec4::splat(Self::WHOLE);
        place.to_array().map(|x| x.to_bits() as usize % N)
    }
}

/// A plane between two bins.
struct Plane {
    binning: Binning,
    axis: usize,
    bin: usize,
}

impl Plane {
    /// As a comparison that takes as little as it needs of a member.
    fn is_below(&self) -> impl Fn(&Member) -> bool + use<> {
        let (axis, last) = (self.axis, self.bin as f32 + Binning::WHOLE);
        let (start, scale) = (self.binning.start[axis], self.binning.scale[axis]);
        move |member| {
            let center = member.lo[axis] * 0.5 + member.hi[axis] * 0.5;
            (center - start) * scale + Binning::WHOLE <= last
        }
    }
}

#[derive(Clone, Copy)]
struct Bin {
    lo: Vec4,
    hi: Vec4,
    count: usize,
}

impl Bin {
    const EMPTY: Self = Self { lo: Vec4::MAX, hi: Vec4::MIN, count: 0 };

    #[inline(always)]
    fn merge(self, other: Self) -> Self {
        Self { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi), count: self.count + other.count }
    }

    #[inline(always)]
    fn cost(&self) -> f32 {
        let [x, y, z, _] = (self.hi - self.lo).to_array();
        if self.count == 0 { 0.0 } else { (x * y + y * z + z * x) * self.count.div_ceil(WIDTH) as f32 }
    }
}

/// The cheapest plane that has members on both sides.
fn cheapest_plane<const N: usize>(members: &[Member]) -> Option<Plane> {
    let binning = Binning::new(members, N);
    let mut bins = [[Bin::EMPTY; N]; 3];
    for member in members {
        let of = binning.of::<N>(member);
        for axis in 0..3 {
            let bin = &mut bins[axis][of[axis]];
            *bin = bin.merge(Bin { lo: member.lo, hi: member.hi, count: 1 });
        }
    }
    let mut best = (f32::INFINITY, 0, 0);
    for (axis, bins) in bins.iter().enumerate() {
        let mut above = [Bin::EMPTY; N];
        for i in (0..N - 1).rev() {
            above[i] = above[i + 1].merge(bins[i + 1]);
        }
        let mut below = Bin::EMPTY;
        for i in 0..N - 1 {
            below = below.merge(bins[i]);
            let cost = below.cost() + above[i].cost();
            if cost < best.0 && below.count > 0 && above[i].count > 0 {
                best = (cost, axis, i);
            }
        }
    }
    let (cost, axis, bin) = best;
    cost.is_finite().then_some(Plane { binning, axis, bin })
}

/// Moves what is below to the front and returns how many these are.
fn partition(members: &mut [Member], is_below: impl Fn(&Member) -> bool) -> usize {
    let mut count = 0;
    for i in 0..members.len() {
        let below = is_below(&members[i]);
        members.swap(i, count);
        count += usize::from(below);
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
