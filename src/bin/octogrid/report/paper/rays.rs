//! The rays that all structures trace: fixed, however long they take.

use std::ops::Range;

use glam::DVec3;
use octogrid::{All, BuildOptions, Closest, Counting, Counts, Hit, Query, Ray, Scene};
use rayon::prelude::*;

use crate::failure::Failure;
use crate::load::{self, Loaded};
use crate::shade::{MOST_GLASS, Shading};
use crate::viewpoint;

/// Rays a task.
const CHUNK: usize = 512;
/// Rays of each kind whose work is counted, at most.
const COUNTED: usize = 10_000;

/// Rays of one kind: a sample of those of an image.
pub(super) struct Sample {
    pub(super) rays: Vec<Ray>,
    /// How many the image has.
    pub(super) total: usize,
}

impl Sample {
    /// Rays of the image for each one of the sample.
    pub(super) fn factor(&self) -> f64 {
        self.total as f64 / self.rays.len().max(1) as f64
    }

    /// The piece `i` of `n` equal ones.
    fn piece(&self, i: usize, n: usize) -> &[Ray] {
        let at = |i: usize| self.rays.len() * i / n;
        &self.rays[at(i)..at(i + 1)]
    }
}

/// The rays of an image with direct light, one a pixel and one from what it meets to each light that
/// shines there.
pub(super) struct Rays {
    pub(super) primary: Sample,
    pub(super) shadow: Sample,
}

/// What queries answered, to be the same from all structures.
pub(super) type Answer = u64;

impl Rays {
    /// The rays through every k-th row of an image, and those that follow from every k'-th; the
    /// least k and k' that lead to at most `most` rays of each kind.
    ///
    /// # Errors
    /// Where the scene can't be built.
    pub(super) fn new(loaded: &Loaded, size: [u32; 2], most: usize) -> Result<Self, Failure> {
        let (scene, _) = load::build(&loaded.model, &BuildOptions::default())?;
        let camera = viewpoint::camera(loaded, &scene, size);
        let shading = Shading::new(&loaded.model, &scene, DVec3::Y);
        let row = |y: usize| {
            let pixels = y * size[0] as usize..(y + 1) * size[0] as usize;
            pixels.map(|pixel| camera.ray(pixel))
        };
        let shadow = |y: usize| {
            let met = row(y).map(|ray| (ray, scene.closest(&ray))).filter(|(_, hit)| hit.is_hit());
            met.flat_map(|(ray, hit)| shading.shadow_rays(&shading.surface(&ray, &hit))).collect()
        };
        let rows = 0..size[1] as usize;
        Ok(Self {
            primary: sample(rows.clone(), most, |y| row(y).collect()),
            shadow: sample(rows, most, shadow),
        })
    }

    /// The rays of both kinds that an image has.
    pub(super) fn total(&self) -> usize {
        self.primary.total + self.shadow.total
    }

    /// Asks for the closest hits of the piece `i` of `n` of the primary rays.
    pub(super) fn trace_primary(&self, scene: &Scene, i: usize, n: usize) -> Answer {
        sum(self.primary.piece(i, n), |ray| {
            let hit = scene.closest(ray);
            u64::from(hit.prim) + u64::from(hit.t.to_bits())
        })
    }

    /// Asks for all hits between surfaces and lights, as the paper does for the sake of glass.
    pub(super) fn trace_shadow(&self, scene: &Scene, i: usize, n: usize) -> Answer {
        sum(self.shadow.piece(i, n), |ray| {
            let mut hits = [Hit::MISS; MOST_GLASS];
            scene.all(ray, &mut hits).len as u64
        })
    }

    /// Voxels, clusters and cache lines a ray of the image.
    pub(super) fn work(&self, scene: &Scene) -> [f64; 3] {
        let primary = work(&self.primary, |ray| counts(scene, ray, Closest::new(ray.t_max)));
        let shadow = work(&self.shadow, |ray| {
            let mut hits = [Hit::MISS; MOST_GLASS];
            counts(scene, ray, All::new(ray.t_max, &mut hits))
        });
        std::array::from_fn(|i| (primary[i] + shadow[i]) / self.total().max(1) as f64)
    }
}

/// The rays of evenly spaced rows. Every row is counted, but only those of the sample are kept.
fn sample(rows: Range<usize>, most: usize, row: impl Fn(usize) -> Vec<Ray> + Sync) -> Sample {
    let counts: Vec<usize> = rows.clone().into_par_iter().map(|y| row(y).len()).collect();
    let total: usize = counts.iter().sum();
    let step = total.div_ceil(most.max(1)).clamp(1, rows.len().max(1));
    let kept: Vec<usize> = rows.skip(step / 2).step_by(step).collect();
    Sample { rays: kept.into_par_iter().flat_map_iter(&row).collect(), total }
}

fn sum(rays: &[Ray], answer: impl Fn(&Ray) -> u64 + Sync) -> Answer {
    let chunk = |rays: &[Ray]| rays.iter().map(&answer).fold(0, u64::wrapping_add);
    rays.par_chunks(CHUNK).map(chunk).reduce(|| 0, u64::wrapping_add)
}

/// The work of all rays of the image, extrapolated from some.
fn work(sample: &Sample, count: impl Fn(&Ray) -> Counts + Sync) -> [f64; 3] {
    let step = sample.rays.len().div_ceil(COUNTED).max(1);
    let some: Vec<Counts> = sample.rays.par_iter().step_by(step).map(&count).collect();
    let factor = sample.total as f64 / some.len().max(1) as f64;
    let of = |what: fn(&Counts) -> u64| some.iter().map(what).sum::<u64>() as f64 * factor;
    [of(|c| c.voxels), of(|c| c.clusters), of(|c| c.cache_lines)]
}

fn counts(scene: &Scene, ray: &Ray, query: impl Query) -> Counts {
    let mut query = Counting::new(query);
    scene.query(ray, &mut query);
    query.counts()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_are_rows_spread_evenly() {
        let ray = |y: usize| vec![Ray::new([y as f32, 0.0, 0.0], [1.0, 0.0, 0.0]); 10];
        let sample = sample(0..60, 100, ray);
        assert_eq!((sample.total, sample.rays.len(), sample.factor()), (600, 100, 6.0));
        assert_eq!((sample.rays[0].origin.x, sample.rays[99].origin.x), (3.0, 57.0));
        assert_eq!((0..7).map(|i| sample.piece(i, 7).len()).sum::<usize>(), 100);
    }
}
