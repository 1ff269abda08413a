//! Images by the integrators, and how far they are from a reference.

use glam::DVec3;
use octogrid::Scene;

use crate::camera::Pinhole;
use crate::failure::Failure;
use crate::frame::Rates;
use crate::integrators::{self, BOUNCES, Integrator, Settings};
use crate::load::Loaded;
use crate::shade::Shading;
use crate::streams::generator;
use crate::{tone, viewpoint};

/// The luminance of each pixel.
pub(super) type Image = Vec<f64>;

/// A scene in one structure, and where it is seen from.
pub(super) struct View<'a> {
    camera: Pinhole,
    shading: Shading<'a>,
    scene: &'a Scene,
}

impl<'a> View<'a> {
    pub(super) fn new(loaded: &'a Loaded, scene: &'a Scene, size: [u32; 2]) -> Self {
        let camera = viewpoint::camera(loaded, scene, size);
        Self { camera, shading: Shading::new(&loaded.model, scene, DVec3::Y), scene }
    }

    /// An image of so many samples a pixel.
    ///
    /// `path` and `photon` find the radiance in the centre of each pixel. `direct` leaves nothing to
    /// chance there, so its samples are random points of the pixel, whose mean the image is.
    ///
    /// # Errors
    /// Where `path` or `photon` finds no lights.
    pub(super) fn image(&self, integrator: Integrator, samples: u32, seed: u64) -> Result<Image, Failure> {
        let settings = Settings { integrator, samples, seed, bounces: BOUNCES };
        if integrator != Integrator::Direct {
            return self.luminance(&settings, &self.camera);
        }
        let mut sum = vec![0.0; self.camera.pixels()];
        for sample in 0..samples {
            let jittered = self.camera.jittered(generator(seed, sample.into()).bits());
            let image = self.luminance(&settings, &jittered)?;
            sum.iter_mut().zip(image).for_each(|(sum, luminance)| *sum += luminance);
        }
        Ok(sum.iter().map(|sum| sum / f64::from(samples)).collect())
    }

    fn luminance(&self, settings: &Settings, camera: &Pinhole) -> Result<Image, Failure> {
        let samples =
            integrators::samples(settings, &self.shading, self.scene, camera, &mut Rates::default())?;
        Ok(samples.iter().map(|sample| f64::from(sample.radiance.dot(tone::LUMINANCE))).collect())
    }
}

/// What images are compared with.
pub(super) struct Reference {
    pub(super) samples: u32,
    image: Image,
    /// The luminance that a picture shows as white.
    white: f64,
}

impl Reference {
    pub(super) fn new(samples: u32, image: Image) -> Self {
        Self { samples, white: f64::from(tone::white(image.iter().map(|&l| l as f32))), image }
    }

    /// The root of the mean square of an image's error, over the mean luminance.
    ///
    /// Pixels that are white in the reference don't count: lamps are a hundred times brighter than the
    /// rest, and a few pixels would be all that counts.
    pub(super) fn rmse(&self, image: &[f64]) -> f64 {
        let pixels = || image.iter().zip(&self.image).filter(|(_, reference)| **reference < self.white);
        let squares: f64 = pixels().map(|(a, b)| (a - b).powi(2)).sum();
        let (sum, count) = pixels().fold((0.0, 0.0), |(sum, count), (_, b)| (sum + b, count + 1.0));
        (squares * count).sqrt() / sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_relative_to_the_mean_and_white_pixels_left_out() {
        let reference = Reference { samples: 1, image: vec![2.0, 9.0, 4.0], white: 6.0 };
        assert_eq!(reference.rmse(&[2.0, 0.0, 4.0]), 0.0);
        assert_eq!(reference.rmse(&[5.0, 9.0, 1.0]), 1.0);
    }
}
