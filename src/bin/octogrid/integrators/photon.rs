//! Particle tracing with a histogram for the density (Arvo 1986; Heckbert 1990).
//!
//! ```text
//! each particle leaves a light with an equal part of its power, by the cosine law
//!     at each surface: add its flux to the patch;  go on by chance
//! a surface's light is the flux of its patch over the patch's area
//! ```
//!
//! Energy is conserved: what lands is seen. Patches shrink as particles grow in number, so that both
//! blur and noise vanish. One thread adds, in the order of the particles, so that sums have the same
//! bits for any number of threads.

use std::f64::consts::{FRAC_1_PI, PI};

use glam::{DVec3, Vec3};
use octogrid::{Ray, Rng, Scene};
use rayon::prelude::*;

use super::emitters::Emitters;
use super::patches::Patches;
use super::walk::{self, Flight, Vertex};
use super::{BAND, Settings};
use crate::frame::{self, Rate};
use crate::shade::{Shading, Surface};
use crate::streams::generator;

/// Patches over the square root of particles. Blur goes with the width of a patch, 1 / sqrt(patches),
/// and noise with 1 / sqrt(particles / patches): the square root lets both fall alike.
const PATCHES: f64 = 64.0;

/// The flux that landed on each patch.
pub(super) struct PhotonMap {
    patches: Patches,
    flux: Vec<DVec3>,
}

impl PhotonMap {
    /// Sends out `particles`.
    pub(super) fn trace(
        settings: &Settings,
        shading: &Shading,
        scene: &Scene,
        emitters: &Emitters,
        particles: usize,
        rate: &mut Rate,
    ) -> Self {
        let patches = Patches::new(shading, PATCHES * (particles as f64).sqrt());
        let mut flux = vec![DVec3::ZERO; patches.len()];
        frame::each_band(particles, BAND, |band| {
            let emit = |particle| {
                let rng = generator(settings.seed, particle as u64);
                emit(shading, emitters, particles, rng)
            };
            let mut flights: Vec<Flight> = band.into_par_iter().map(emit).collect();
            for _ in 0..settings.bounces {
                let find = |flight: &Flight, surface: &Surface| (patches.at(surface).0, flight.weight);
                let keep = |_, (patch, weight): (usize, Vec3)| flux[patch] += weight.as_dvec3();
                let landed = walk::follow(shading, scene, flights, rate, find, keep);
                flights = landed.into_par_iter().map(Vertex::depart).collect();
            }
        });
        Self { patches, flux }
    }

    /// The light that each surface receives, over pi.
    pub(super) fn light(&self, surfaces: &[Surface]) -> Vec<Vec3> {
        let light = |surface| {
            let (patch, area) = self.patches.at(surface);
            (self.flux[patch] * FRAC_1_PI / area).as_vec3()
        };
        surfaces.iter().map(light).collect()
    }
}

/// A particle that leaves a light to either side.
fn emit(shading: &Shading, emitters: &Emitters, particles: usize, mut rng: Rng) -> Flight {
    let source = emitters.sample(&mut rng);
    let normal = if rng.unit() < 0.5 { source.normal } else { -source.normal };
    let dir = walk::cosine(normal, &mut rng);
    let origin = source.point + normal * shading.offset();
    // A unit of area sends pi times its radiance to each of two sides.
    let flux = 2.0 * PI / (emitters.density(source.emission) * particles as f64);
    Flight {
        owner: 0,
        ray: Ray::new(origin.as_vec3(), dir.as_vec3()),
        weight: source.emission * flux as f32,
        density: normal.dot(dir) * FRAC_1_PI,
        rng,
    }
}
