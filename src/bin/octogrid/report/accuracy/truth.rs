//! The true answers.

use octogrid::oracle::exact::{self, ExactHit};
use octogrid::{EdgeRule, Ray, Scene, TriMesh};
use rayon::prelude::*;

use crate::failure::Failure;

/// Rays of a set whose triangle is looked for in exact arithmetic too.
pub(super) const SAMPLE: usize = 200;

/// What a ray meets first, if anything.
pub(super) type Truth = Option<(u32, ExactHit)>;

/// The truth about each ray.
///
/// Which triangle is hit says the exact kernel over a structure, which tests prove right: exact
/// arithmetic over all triangles would take hours. [`SAMPLE`] of the rays are checked in that way here
/// too. t, u and v come from exact arithmetic for every ray.
///
/// # Errors
/// Where the exact kernel is wrong.
pub(super) fn truth(scene: &Scene, mesh: &TriMesh<'_>, rays: &[Ray]) -> Result<Vec<Truth>, Failure> {
    let wrong = |ray: &Ray| Failure::Expected(format!("the exact kernel is wrong on {ray:?}"));
    let sample: Vec<&Ray> = rays.iter().step_by(rays.len().div_ceil(SAMPLE).max(1)).collect();
    let checked = sample.into_par_iter().find_any(|ray| {
        let (found, hit) = (scene.closest(ray), exact::closest(mesh, ray));
        (found.prim, found.t.to_bits()) != (hit.prim, hit.t.to_bits())
    });
    if let Some(ray) = checked {
        return Err(wrong(ray));
    }
    let truth = |ray: &Ray| {
        let hit = scene.closest(ray);
        if !hit.is_hit() {
            return Ok(None);
        }
        let exact = exact::intersect(ray, mesh.corners(hit.prim), EdgeRule::Closed);
        exact.map(|exact| Some((hit.prim, exact))).ok_or_else(|| wrong(ray))
    };
    rays.par_iter().map(truth).collect()
}
