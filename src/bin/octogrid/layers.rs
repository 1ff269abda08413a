//! What a pixel sees: a surface, through the glass before it.

use glam::Vec3;
use octogrid::{Hit, Ray, Scene};

use crate::frame::{self, Rates};
use crate::shade::{Shading, Surface, transmittance};

/// Layers of glass that the eye looks through at most.
const MOST_LAYERS: usize = 16;

/// What reaches the eye through one pixel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample {
    /// Radiance of lights and lit surfaces.
    pub(crate) radiance: Vec3,
    /// Diffuse reflectance of what is seen, for light that comes from everywhere.
    pub(crate) albedo: Vec3,
    /// The part of what is seen that lies behind the scene.
    pub(crate) background: f32,
}

/// A ray from the eye and the part of its light that reaches the eye.
struct Sight {
    pixel: usize,
    ray: Ray,
    weight: Vec3,
}

/// The samples of primary rays, layer by layer from front to back.
///
/// `light` tells what surfaces receive, over pi.
pub(crate) fn samples(
    shading: &Shading,
    scene: &Scene,
    rays: Vec<Ray>,
    rates: &mut Rates,
    mut light: impl FnMut(&[Surface], &mut Rates) -> Vec<Vec3>,
) -> Vec<Sample> {
    let nothing = Sample { radiance: Vec3::ZERO, albedo: Vec3::ZERO, background: 0.0 };
    let mut samples = vec![nothing; rays.len()];
    let sight = |(pixel, ray)| Sight { pixel, ray, weight: Vec3::ONE };
    let mut sights: Vec<Sight> = rays.into_iter().enumerate().map(sight).collect();
    for _ in 0..MOST_LAYERS {
        if sights.is_empty() {
            break;
        }
        let rays: Vec<Ray> = sights.iter().map(|s| s.ray).collect();
        let hits = frame::closest(scene, &rays, &mut rates.primary);
        let met = sights.iter().zip(&hits).filter(|(_, hit)| hit.is_hit());
        let surfaces: Vec<_> = met.map(|(sight, hit)| shading.surface(&sight.ray, hit)).collect();
        let light = light(&surfaces, rates);
        add_layer(shading, &sights, &hits, &light, &mut samples);
        sights = sights.iter().zip(&hits).filter_map(|(sight, hit)| beyond(shading, sight, hit)).collect();
    }
    samples
}

/// Adds what the sights meet first; `light` has an element for each that meets something.
fn add_layer(shading: &Shading, sights: &[Sight], hits: &[Hit], light: &[Vec3], samples: &mut [Sample]) {
    let met = sights.iter().zip(hits).filter(|(_, hit)| hit.is_hit());
    for ((sight, hit), light) in met.zip(light) {
        let material = shading.material(hit.prim);
        let weight = sight.weight * material.opacity.clamp(0.0, 1.0);
        let albedo = weight * Vec3::from_array(material.diffuse);
        let sample = &mut samples[sight.pixel];
        sample.radiance += albedo * light + sight.weight * Vec3::from_array(material.emission);
        sample.albedo += albedo;
    }
    for (sight, _) in sights.iter().zip(hits).filter(|(_, hit)| !hit.is_hit()) {
        samples[sight.pixel].background += sight.weight.element_sum() / 3.0;
    }
}

/// The sight through the glass that it meets.
fn beyond(shading: &Shading, sight: &Sight, hit: &Hit) -> Option<Sight> {
    let through = hit.is_hit().then(|| transmittance(shading.material(hit.prim)))?;
    let ray = sight.ray.with_interval(hit.t, sight.ray.t_max);
    (through != Vec3::ZERO).then_some(Sight { ray, weight: sight.weight * through, ..*sight })
}
