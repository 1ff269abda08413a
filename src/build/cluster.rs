//! Clustering: triangles into groups of up to eight neighbours.
//!
//! ```text
//! arrange(triangles): sort them into the cells of a grid
//!                     split the cells into runs of few triangles
//!                     arrange(the triangles of a cell) where there are still many
//! then split each run into clusters
//! ```
//!
//! Both splits are by the surface area heuristic ([`super::sah`]). Coplanar neighbours come together, as a
//! flat box has the least area. That the first split is of cells, not of triangles, spares most of
//! O(n log n) and changes little: few triangles lie near a boundary between runs.
//!
//! [`Quality::Fast`] splits nothing: cells follow one another along a [`Curve`], and so do the triangles of clusters.

use std::ops::Range;

use super::analysis::{Analysis, Around};
use super::curve::Curve;
use super::grid::{self, Places};
use super::options::Quality;
use super::sah::{self, Member};
use crate::aabb::Aabb;
use crate::cluster::Cluster;
use crate::lanes::{Isa, WIDTH};
use crate::mesh::TriMesh;
use crate::parallel;

/// Triangles in a run, where cells allow it.
const RUN: usize = 64;

/// Gathers the triangles of the analysis into clusters, neighbours near each other.
///
/// The same for any number of threads.
pub(crate) fn clusters(mesh: &TriMesh<'_>, analysis: &Analysis, isa: Isa, quality: Quality) -> Vec<Cluster> {
    let boxes = &analysis.boxes;
    let mut order: Vec<u32> = (0..boxes.len() as u32).collect();
    let mut ends = vec![false; order.len()];
    arrange(boxes, &analysis.centers, &mut order, &mut ends, isa, quality);
    if quality == Quality::Fast {
        return filled(mesh, analysis, &order);
    }
    let found = runs(&ends);
    parallel::for_each(parts(&mut order, &mut ends, &found), |(run, ends)| {
        let mut members: Vec<Member> = run.iter().map(|&i| Member::new(i, &boxes[i as usize])).collect();
        sah::split(isa, &mut members, ends, &|_: &Member| 1, WIDTH);
        run.iter_mut().zip(&members).for_each(|(i, member)| *i = member.index());
    });
    parallel::map(&runs(&ends), |run| gather(mesh, analysis, &order[run.clone()]))
}

/// Gathers the triangles of the analysis into as few clusters as there can be, in the order of the mesh.
pub(crate) fn in_order(mesh: &TriMesh<'_>, analysis: &Analysis) -> Vec<Cluster> {
    filled(mesh, analysis, &(0..analysis.len() as u32).collect::<Vec<_>>())
}

/// Clusters of triangles that follow one another, all but the last one full.
fn filled(mesh: &TriMesh<'_>, analysis: &Analysis, order: &[u32]) -> Vec<Cluster> {
    let chunks: Vec<&[u32]> = order.chunks(WIDTH).collect();
    parallel::map(&chunks, |chunk| gather(mesh, analysis, chunk))
}

/// From each of the `ends` to the next one.
fn runs(ends: &[bool]) -> Vec<Range<usize>> {
    let mut start = 0;
    let ends = (1..).zip(ends).filter(|(_, last)| **last);
    ends.map(|(end, _)| std::mem::replace(&mut start, end)..end).collect()
}

/// Some parts of `order`, from the first on, with their ends.
fn parts<'a>(
    mut order: &'a mut [u32],
    mut ends: &'a mut [bool],
    parts: &[Range<usize>],
) -> Vec<(&'a mut [u32], &'a mut [bool])> {
    let mut at = 0;
    let mut next = |part: &Range<usize>| {
        let (skipped, len) = (part.start - at, part.len());
        at = part.end;
        let (own, rest) = std::mem::take(&mut order)[skipped..].split_at_mut(len);
        let (own_ends, rest_ends) = std::mem::take(&mut ends)[skipped..].split_at_mut(len);
        (order, ends) = (rest, rest_ends);
        (own, own_ends)
    };
    parts.iter().map(&mut next).collect()
}

/// Orders triangles by runs of neighbours and marks the last of each run; those of [`Quality::Fast`] are cells.
fn arrange(boxes: &[Aabb], centers: &Aabb, order: &mut [u32], ends: &mut [bool], isa: Isa, quality: Quality) {
    const CROWDED: usize = 256;
    let grid = grid::cubic(centers, order.len() as f64 / 4.0);
    let (cells, sorted, groups, last) = match quality {
        Quality::Fast => {
            let curve = Curve::new(&grid);
            let (cells, sorted) = sort_by_cell(boxes, order, curve.len(), |b| curve.of(b));
            let groups = (0..cells.len() as u32).collect();
            let last = vec![true; cells.len()];
            (cells, sorted, groups, last)
        }
        Quality::Balanced => {
            let places = Places::new(&grid);
            let (cells, sorted) = sort_by_cell(boxes, order, grid.len(), |b| places.of(b));
            let (groups, last) = split_cells(boxes, &cells, &sorted, isa);
            (cells, sorted, groups, last)
        }
    };
    let (mut start, mut end, mut crowds) = (0, 0, Vec::new());
    for (group, last) in groups.into_iter().zip(last) {
        let cell = &sorted[cells[group as usize].clone()];
        order[end..end + cell.len()].copy_from_slice(cell);
        end += cell.len();
        if last {
            if end - start > CROWDED && end - start < order.len() {
                crowds.push(start..end);
            }
            ends[end - 1] = true;
            start = end;
        }
    }
    parallel::for_each(parts(order, ends, &crowds), |(crowd, ends)| {
        let centers = Around::new(crowd.iter().map(|&i| &boxes[i as usize])).centers;
        arrange(boxes, &centers, crowd, ends, isa, quality);
    });
}

/// The order of cells by runs of few triangles, and which of them end a run.
fn split_cells(boxes: &[Aabb], cells: &[Range<usize>], sorted: &[u32], isa: Isa) -> (Vec<u32>, Vec<bool>) {
    let bounds =
        |cell: &Range<usize>| Around::new(sorted[cell.clone()].iter().map(|&i| &boxes[i as usize])).bounds;
    let around = parallel::map(cells, bounds);
    let mut groups: Vec<Member> = (0..).zip(&around).map(|(i, b)| Member::new(i, b)).collect();
    let mut last = vec![false; groups.len()];
    let weight = |group: &Member| cells[group.index() as usize].len();
    sah::split(isa, &mut groups, &mut last, &weight, RUN);
    (groups.iter().map(Member::index).collect(), last)
}

/// The triangles sorted by the cells of a grid, of which each has a place below `len`, and the range of each cell that
/// has any. Counting sort.
fn sort_by_cell(
    boxes: &[Aabb],
    order: &[u32],
    len: usize,
    place: impl Fn(&Aabb) -> u32 + Sync + Send,
) -> (Vec<Range<usize>>, Vec<u32>) {
    let cells = parallel::map(order, |&i| place(&boxes[i as usize]));
    let mut next = vec![0u32; len];
    cells.iter().for_each(|&cell| next[cell as usize] += 1);
    let mut ranges = Vec::new();
    let mut start = 0;
    for count in &mut next {
        if *count > 0 {
            ranges.push(start as usize..(start + *count) as usize);
        }
        start += std::mem::replace(count, start);
    }
    let mut sorted = vec![0; order.len()];
    for (&i, &cell) in order.iter().zip(&cells) {
        sorted[next[cell as usize] as usize] = i;
        next[cell as usize] += 1;
    }
    (ranges, sorted)
}

fn gather(mesh: &TriMesh<'_>, analysis: &Analysis, run: &[u32]) -> Cluster {
    let mut ids = [u32::MAX; WIDTH];
    ids.iter_mut().zip(run).for_each(|(id, &i)| *id = analysis.id(i));
    ids[..run.len()].sort_unstable();
    // Found first, so that in large meshes the eight of them are waited for together, and not one after the other.
    let mut triangles = [[0; 3]; WIDTH];
    for lane in 0..run.len() {
        triangles[lane] = mesh.triangles()[ids[lane] as usize];
    }
    Cluster::gather(run.len(), |lane| (ids[lane], mesh.corners_of(triangles[lane])))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_triangle_is_in_one_cluster() {
        let vertices: Vec<[f32; 3]> =
            (0..9000u32).map(|i| [(i * 7 % 31) as f32, (i * 5 % 17) as f32, (i * i % 13) as f32]).collect();
        let triangles: Vec<[u32; 3]> = (0..3000).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let mesh = TriMesh::new(&vertices, &triangles).unwrap();
        let analysis = Analysis::new(&mesh);
        for quality in [Quality::Fast, Quality::Balanced] {
            let clusters = clusters(&mesh, &analysis, Isa::detect(), quality);
            let ids = clusters.iter().flat_map(|c| *c.ids()).filter(|&i| i != u32::MAX);
            let mut ids: Vec<u32> = ids.collect();
            ids.sort_unstable();
            assert!(ids.into_iter().eq(analysis.ids()), "{quality:?}");
        }
    }

    #[test]
    fn identical_triangles_fill_clusters() {
        let vertices = [[0.0f32; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let triangles = [[0, 1, 2]; 100];
        let mesh = TriMesh::new(&vertices, &triangles).unwrap();
        for quality in [Quality::Fast, Quality::Balanced] {
            assert_eq!(clusters(&mesh, &Analysis::new(&mesh), Isa::detect(), quality).len(), 13);
        }
    }
}
