//! Work a pixel as colours.

use glam::Vec3;
use octogrid::{Closest, Counting, Ray, Scene};
use rayon::prelude::*;

use crate::tone::to_bytes;

/// The voxels entered and the clusters tested for each ray.
pub(crate) fn work(scene: &Scene, rays: &[Ray]) -> Vec<u64> {
    let count = |ray: &Ray| {
        let mut query = Counting::new(Closest::new(ray.t_max));
        scene.query(ray, &mut query);
        query.counts().voxels + query.counts().clusters
    };
    rays.par_iter().map(count).collect()
}

/// The least work, and the work that only one pixel in a thousand exceeds: the ends of the colours.
pub(crate) fn range(work: &[u64]) -> [u64; 2] {
    let mut sorted = work.to_vec();
    sorted.sort_unstable();
    let at = |part: f64| sorted.get(((sorted.len().max(1) - 1) as f64 * part) as usize).copied().unwrap_or(0);
    [at(0.0), at(0.999)]
}

/// The colour of a pixel.
pub(crate) fn colour(work: u64, [low, high]: [u64; 2]) -> [u8; 3] {
    turbo(work.saturating_sub(low) as f32 / (high - low).max(1) as f32)
}

/// The colour map Turbo at x in [0, 1], from dark blue over green to dark red.
///
/// A. Mikhailov's map in the polynomial approximation of R. Du (Google, 2019).
pub(crate) fn turbo(x: f32) -> [u8; 3] {
    const POWERS: [Vec3; 6] = [
        Vec3::new(0.135_721_38, 0.091_402_61, 0.106_673_3),
        Vec3::new(4.615_392_6, 2.194_188_4, 12.641_946),
        Vec3::new(-42.660_32, 4.842_966_6, -60.582_05),
        Vec3::new(132.131_08, -14.185_033, 110.362_77),
        Vec3::new(-152.942_4, 4.277_298_6, -89.903_11),
        Vec3::new(59.286_38, 2.829_566, 27.348_25),
    ];
    let x = x.clamp(0.0, 1.0);
    let colour = POWERS.iter().rev().fold(Vec3::ZERO, |sum, &power| sum * x + power);
    to_bytes(colour.clamp(Vec3::ZERO, Vec3::ONE))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turbo_goes_from_blue_over_green_to_red() {
        let strongest = |x| (0..3).max_by_key(|&channel| turbo(x)[channel]);
        assert_eq!([0.15, 0.5, 0.9].map(strongest), [Some(2), Some(1), Some(0)]);
    }

    #[test]
    fn range_leaves_outliers_out() {
        let mut work = vec![7; 5000];
        work[0] = 2;
        work[1] = 900;
        assert_eq!(range(&work), [2, 7]);
        assert_eq!(range(&[]), [0, 0]);
        assert_eq!(colour(900, [2, 7]), turbo(1.0));
    }
}
