//! The sets of rays, from easy to hard.

use octogrid::oracle::rays::RaySet;
use octogrid::{Ray, Scene};

use crate::failure::Failure;
use crate::frame;
use crate::load::Loaded;
use crate::viewpoint;

/// Rays with a name.
pub(super) struct Set {
    pub(super) name: &'static str,
    pub(super) rays: Vec<Ray>,
}

/// The sets of a scene, each of about `n` rays.
///
/// # Errors
/// Where the scene's triangles are no mesh.
pub(super) fn sets(loaded: &Loaded, scene: &Scene, n: usize, seed: u64) -> Result<Vec<Set>, Failure> {
    let mesh = loaded.model.mesh()?;
    // An image of the shape of 4 to 3.
    let height = (n as f64 * 0.75).sqrt().round().max(1.0) as u32;
    let camera = viewpoint::camera(loaded, scene, [(n as u32).div_ceil(height), height]);
    let easy = frame::primary_rays(&camera, 0..camera.pixels());
    let of = |(name, set): (&'static str, RaySet)| Set { name, rays: set.rays(&mesh, seed, n) };
    let hard = [
        ("edge", RaySet::Aimed),
        ("far", RaySet::Far),
        ("sliver", RaySet::Sliver),
        ("grazing", RaySet::Grazing),
    ];
    Ok([Set { name: "easy", rays: easy }].into_iter().chain(hard.map(of)).collect())
}
