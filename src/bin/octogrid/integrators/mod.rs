//! Integrators: three ways to find the light that a surface receives.
//!
//! The eye's part is common to them: [`layers`] finds the surfaces that a pixel's centre sees through
//! glass and asks for their light. So their images differ in nothing else, and `path` and `photon`
//! converge to the same.
//!
//! Physics of `path` and `photon`: surfaces are diffuse on both sides and let the part of light pass
//! that their opacity leaves; triangles that emit do so to both sides, with the same radiance in every
//! direction; light is followed over at most `bounces` reflections, the one towards the eye included.

mod emitters;
mod patches;
mod path;
mod photon;
mod walk;

use std::fmt;

use clap::ValueEnum;
use glam::Vec3;
use octogrid::Scene;

use crate::camera::Pinhole;
use crate::failure::Failure;
use crate::frame::{self, Rates};
use crate::layers::{self, Sample};
use crate::shade::{Shading, Surface};
use emitters::Emitters;
use path::PathTracer;
use photon::PhotonMap;

/// Rays in flight at once, to keep memory and progress steady.
const BAND: usize = 1 << 18;

/// The most reflections between light and eye unless another number is asked for.
pub(crate) const BOUNCES: u32 = 5;

/// Finds the light that surfaces receive, over pi.
type Light<'a> = &'a mut dyn FnMut(&[Surface], &mut Rates) -> Vec<Vec3>;

/// How light is found.
#[derive(Clone, Copy, Debug, clap::Args)]
pub(crate) struct Settings {
    /// How light is found
    #[arg(long, value_enum, default_value = "direct")]
    pub(crate) integrator: Integrator,
    /// Paths or particles a pixel
    #[arg(long, value_name = "N", default_value = "16", value_parser = clap::value_parser!(u32).range(1..=1 << 20))]
    pub(crate) samples: u32,
    /// Chooses the random numbers of path and photon
    #[arg(long, value_name = "S", default_value = "0")]
    pub(crate) seed: u64,
    /// The most reflections between light and eye in path and photon
    #[arg(long, value_name = "N", default_value_t = BOUNCES, value_parser = clap::value_parser!(u32).range(1..=64))]
    pub(crate) bounces: u32,
}

/// The values of `--integrator`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Integrator {
    /// One shadow ray to each light; the rest is guessed
    Direct,
    /// Random paths from the eye, joined to the lights
    Path,
    /// Random particles from the lights, counted where they land
    Photon,
}

impl fmt::Display for Integrator {
    /// As on the command line.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.to_possible_value().map_or(Ok(()), |value| f.write_str(value.get_name()))
    }
}

/// The samples of all pixels of an image.
///
/// They depend on the settings, not on the number of threads.
///
/// # Errors
/// Where `path` or `photon` finds no lights.
pub(crate) fn samples(
    settings: &Settings,
    shading: &Shading,
    scene: &Scene,
    camera: &Pinhole,
    rates: &mut Rates,
) -> Result<Vec<Sample>, Failure> {
    let emitters = || {
        let none =
            || Failure::Expected("the scene has no lights; only the integrator direct adds one".into());
        Emitters::new(shading).ok_or_else(none)
    };
    let image = |band, rates: &mut Rates, light: Light| {
        frame::in_bands(camera.pixels(), band, |band| {
            layers::samples(shading, scene, frame::primary_rays(camera, band), rates, &mut *light)
        })
    };
    Ok(match settings.integrator {
        Integrator::Direct => {
            // Bands of many rows, which streams take in tiles, but fewer surfaces at once with all their lights.
            let most = (BAND / shading.lights().max(1)).max(1);
            let mut light = |surfaces: &[Surface], rates: &mut Rates| {
                let parts = surfaces.chunks(most);
                parts.flat_map(|surfaces| shading.light(surfaces, &mut rates.shadow)).collect()
            };
            image(BAND / 4, rates, &mut light)
        }
        Integrator::Path => {
            let mut tracer = PathTracer::new(settings, shading, scene, emitters()?);
            image(BAND / settings.samples as usize, rates, &mut |surfaces, rates| {
                tracer.light(surfaces, rates)
            })
        }
        Integrator::Photon => {
            let particles = camera.pixels() * settings.samples as usize;
            let map =
                PhotonMap::trace(settings, shading, scene, &emitters()?, particles, &mut rates.scattered);
            image(BAND, rates, &mut |surfaces, _| map.light(surfaces))
        }
    })
}
