//! Brute force with the library's own kernel: the same bits as every structure must give.

use glam::Vec3;

use super::scan::{self, Answer};
use crate::hit::Hit;
use crate::mesh::TriMesh;
use crate::query::EdgeRule;
use crate::ray::Ray;

/// The closest hit of each ray, or [`Hit::MISS`].
pub fn closest(mesh: &TriMesh<'_>, rays: &[Ray]) -> Vec<Hit> {
    map(rays, |ray| scan::closest(mesh, ray, kernel))
}

/// Whether there is any hit, for each ray.
pub fn any(mesh: &TriMesh<'_>, rays: &[Ray]) -> Vec<bool> {
    map(rays, |ray| scan::any(mesh, ray, kernel))
}

/// All hits of each ray, sorted by (t, triangle).
pub fn all(mesh: &TriMesh<'_>, rays: &[Ray]) -> Vec<Vec<Hit>> {
    map(rays, |ray| scan::all(mesh, ray, kernel))
}

/// The answers to all three queries, in one scan for each ray.
pub fn answers(mesh: &TriMesh<'_>, rays: &[Ray]) -> Vec<Answer> {
    map(rays, |ray| scan::answer(mesh, ray, kernel))
}

fn kernel(ray: &Ray, corners: [Vec3; 3], rule: EdgeRule) -> Option<(f32, f32, f32)> {
    super::exact::kernel(ray, corners, rule)
}

#[cfg(feature = "parallel")]
fn map<T: Send>(rays: &[Ray], f: impl Fn(&Ray) -> T + Sync + Send) -> Vec<T> {
    use rayon::prelude::*;
    rays.par_iter().map(f).collect()
}

#[cfg(not(feature = "parallel"))]
fn map<T>(rays: &[Ray], f: impl Fn(&Ray) -> T) -> Vec<T> {
    rays.iter().map(f).collect()
}
