//! Tracing an image in phases, each timed on its own.

use std::ops::Range;
use std::time::Instant;

use indicatif::{ProgressBar, ProgressStyle};
use octogrid::{Hit, Ray, Scene};
use rayon::prelude::*;

use crate::camera::Pinhole;

/// Rays of one kind and the time that their queries took.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Rate {
    rays: usize,
    seconds: f64,
}

impl Rate {
    /// Runs the queries of `rays` rays.
    pub(crate) fn time<T>(&mut self, rays: usize, queries: impl FnOnce() -> T) -> T {
        let start = Instant::now();
        let answer = queries();
        self.seconds += start.elapsed().as_secs_f64();
        self.rays += rays;
        answer
    }

    /// The number of rays.
    pub(crate) fn rays(&self) -> usize {
        self.rays
    }

    /// Millions of rays a second; 0 where there were none.
    pub(crate) fn mrays_per_s(&self) -> f64 {
        if self.seconds > 0.0 { self.rays as f64 / self.seconds / 1e6 } else { 0.0 }
    }
}

/// The rates of the kinds of rays of an image.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Rates {
    /// Rays from the eye.
    pub(crate) primary: Rate,
    /// Rays to lights.
    pub(crate) shadow: Rate,
    /// Rays from lights and on from surfaces.
    pub(crate) scattered: Rate,
}

/// The closest hits.
pub(crate) fn closest(scene: &Scene, rays: &[Ray], rate: &mut Rate) -> Vec<Hit> {
    let mut hits = vec![Hit::MISS; rays.len()];
    rate.time(rays.len(), || scene.closest_stream(rays, &mut hits));
    hits
}

/// The rays through a range of pixels.
pub(crate) fn primary_rays(camera: &Pinhole, pixels: Range<usize>) -> Vec<Ray> {
    pixels.into_par_iter().map(|pixel| camera.ray(pixel)).collect()
}

/// Makes the pixels of an image band by band, with a progress bar on a terminal.
pub(crate) fn in_bands<T>(
    pixels: usize,
    band: usize,
    mut work: impl FnMut(Range<usize>) -> Vec<T>,
) -> Vec<T> {
    let mut image = Vec::with_capacity(pixels);
    each_band(pixels, band, |band| image.extend(work(band)));
    image
}

/// Goes through the numbers below `end` band by band, with a progress bar on a terminal.
pub(crate) fn each_band(end: usize, band: usize, mut work: impl FnMut(Range<usize>)) {
    let bar = ProgressBar::new(end as u64);
    if let Ok(style) = ProgressStyle::with_template("{wide_bar} {percent}% {eta}") {
        bar.set_style(style);
    }
    let mut done = 0;
    while done < end {
        let next = end.min(done + band.max(1));
        work(done..next);
        done = next;
        bar.set_position(done as u64);
    }
    bar.finish_and_clear();
}
