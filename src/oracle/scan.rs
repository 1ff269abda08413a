//! The three queries by going over all triangles.

use glam::Vec3;

use super::filter::Filter;
use crate::hit::Hit;
use crate::mesh::TriMesh;
use crate::query::EdgeRule;
use crate::ray::Ray;

/// What all three queries answer for one ray.
#[derive(Clone, Debug, PartialEq)]
pub struct Answer {
    /// The closest hit, or [`Hit::MISS`].
    pub closest: Hit,
    /// Whether there is any hit.
    pub occluded: bool,
    /// All hits, sorted by (t, triangle).
    pub all: Vec<Hit>,
}

impl Answer {
    /// The answers that follow from all hits under each edge rule.
    pub(super) fn of(closed: Vec<Hit>, crossings: Vec<Hit>) -> Self {
        let closest = first(closed.into_iter());
        Self { closest, occluded: closest.is_hit(), all: sorted(crossings.into_iter()) }
    }
}

/// (t, u, v) where the line of a ray meets a triangle.
pub(super) trait Kernel: Fn(&Ray, [Vec3; 3], EdgeRule) -> Option<(f32, f32, f32)> {}

impl<F: Fn(&Ray, [Vec3; 3], EdgeRule) -> Option<(f32, f32, f32)>> Kernel for F {}

pub(super) fn closest(mesh: &TriMesh<'_>, ray: &Ray, kernel: impl Kernel) -> Hit {
    first(hits(mesh, ray, EdgeRule::Closed, &candidates(mesh, ray), &kernel))
}

pub(super) fn any(mesh: &TriMesh<'_>, ray: &Ray, kernel: impl Kernel) -> bool {
    hits(mesh, ray, EdgeRule::Closed, &candidates(mesh, ray), &kernel).next().is_some()
}

pub(super) fn all(mesh: &TriMesh<'_>, ray: &Ray, kernel: impl Kernel) -> Vec<Hit> {
    sorted(hits(mesh, ray, EdgeRule::Crossing, &candidates(mesh, ray), &kernel))
}

pub(super) fn answer(mesh: &TriMesh<'_>, ray: &Ray, kernel: impl Kernel) -> Answer {
    let candidates = candidates(mesh, ray);
    let closest = first(hits(mesh, ray, EdgeRule::Closed, &candidates, &kernel));
    let all = sorted(hits(mesh, ray, EdgeRule::Crossing, &candidates, &kernel));
    Answer { closest, occluded: closest.is_hit(), all }
}

/// The triangles that the line of the ray does not certainly miss; none for an invalid ray.
fn candidates(mesh: &TriMesh<'_>, ray: &Ray) -> Vec<u32> {
    if !ray.is_valid() {
        return Vec::new();
    }
    let filter = Filter::new(ray);
    (0..mesh.len() as u32).filter(|&prim| filter.may_meet(mesh.corners(prim))).collect()
}

/// The hits on the candidates with t in (t_min, t_max].
fn hits(
    mesh: &TriMesh<'_>,
    ray: &Ray,
    rule: EdgeRule,
    candidates: &[u32],
    kernel: &impl Kernel,
) -> impl Iterator<Item = Hit> {
    candidates.iter().filter_map(move |&prim| {
        let (t, u, v) = kernel(ray, mesh.corners(prim), rule)?;
        (ray.t_min < t && t <= ray.t_max).then_some(Hit { t, u, v, prim })
    })
}

fn first(hits: impl Iterator<Item = Hit>) -> Hit {
    hits.fold(Hit::MISS, |best, hit| if hit.precedes(&best) { hit } else { best })
}

fn sorted(hits: impl Iterator<Item = Hit>) -> Vec<Hit> {
    let mut hits: Vec<Hit> = hits.collect();
    hits.sort_by(|a, b| (a.t, a.prim).partial_cmp(&(b.t, b.prim)).expect("no t is NaN"));
    hits
}
