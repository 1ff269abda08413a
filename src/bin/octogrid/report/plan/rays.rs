//! The rays of an image: through its pixels, from what they meet to the lights, and from there any way.

use glam::DVec3;
use octogrid::{Hit, HitLists, Ray, Rng, Scene};

use crate::answer::Answer;
use crate::load::Loaded;
use crate::shade::Shading;
use crate::{survey, viewpoint};

/// The kinds of rays.
pub(super) const KINDS: [&str; 3] = ["primary", "shadow", "diffuse"];

/// The kind of which it is asked whether there is any hit.
pub(super) const SHADOW: usize = 1;

/// Rays of each kind.
pub(super) struct Rays([Vec<Ray>; 3]);

impl Rays {
    /// About `n` rays through a square of pixels, and up to as many of the other kinds.
    pub(super) fn new(loaded: &Loaded, scene: &Scene, n: usize) -> Self {
        let side = (n as f64).sqrt().ceil() as u32;
        let camera = viewpoint::camera(loaded, scene, [side, side]);
        let primary: Vec<Ray> = (0..camera.pixels()).map(|pixel| camera.ray(pixel)).collect();
        let shading = Shading::new(&loaded.model, scene, DVec3::Y);
        let (low, high) = survey::bounds(&loaded.model).unwrap_or_default();
        // In no plane that a scene is likely to have.
        let light = (low + high) / 2.0 + (high - low).max_element() * DVec3::new(0.37, 1.1, 0.23);
        let (mut shadow, mut diffuse) = (Vec::new(), Vec::new());
        let mut rng = Rng::new(1);
        for ray in &primary {
            let hit = scene.closest(ray);
            if !hit.is_hit() {
                continue;
            }
            let surface = shading.surface(ray, &hit);
            if shading.lights() == 0 {
                shadow.push(Ray::segment(surface.point.as_vec3(), light.as_vec3()));
            } else {
                let rays = shading.shadow_rays(&surface);
                shadow.extend(rays.get(rng.below(rays.len().max(1))));
            }
            let way = surface.normal + rng.on_sphere();
            diffuse.push(Ray::new(surface.point.as_vec3(), way.as_vec3()));
        }
        Self([primary, shadow, diffuse])
    }

    /// By kind.
    pub(super) fn kinds(&self) -> impl Iterator<Item = &[Ray]> {
        self.0.iter().map(Vec::as_slice)
    }

    /// Room for the answers to each kind.
    pub(super) fn answers(&self) -> Vec<Answer> {
        let room = |(kind, rays): (usize, &[Ray])| match kind {
            SHADOW => Answer::any(rays.len()),
            _ => Answer::closest(rays.len()),
        };
        self.kinds().enumerate().map(room).collect()
    }

    /// All of them.
    pub(super) fn len(&self) -> usize {
        self.kinds().map(<[Ray]>::len).sum()
    }
}

/// Asks for the closest hits of rays of one kind, or whether there is any if these go to lights, one after the other;
/// a number that depends on all answers.
pub(super) fn trace(scene: &Scene, kind: usize, rays: &[Ray]) -> u64 {
    let answer = |ray: &Ray| match kind {
        SHADOW => u64::from(scene.occluded(ray)),
        _ => bits(&scene.closest(ray)),
    };
    rays.iter().map(answer).fold(0, u64::wrapping_add)
}

/// The same as a stream, the way an image is rendered.
pub(super) fn trace_stream(scene: &Scene, rays: &[Ray], answer: &mut Answer) -> u64 {
    answer.ask(scene, rays);
    match answer {
        Answer::Any(occluded) => occluded.iter().copied().map(u64::from).fold(0, u64::wrapping_add),
        Answer::Closest(hits) | Answer::All(HitLists { hits, .. }) => {
            hits.iter().map(bits).fold(0, u64::wrapping_add)
        }
    }
}

fn bits(hit: &Hit) -> u64 {
    u64::from(hit.t.to_bits())
}
