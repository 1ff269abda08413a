//! From radiance to the bytes of a picture.

use glam::Vec3;

use crate::layers::Sample;

/// What is seen behind the scene, in sRGB.
const BACKGROUND: f32 = 0.86;
/// Light from everywhere relative to the mean direct light, in place of further reflections.
const AMBIENT: f32 = 0.12;
/// Where the log-average luminance goes, on the scale on which 1 is white.
const MIDDLE: f32 = 0.4;
/// The luminance, on that scale, that becomes pure white.
const WHITE: f32 = 4.0;

/// Weights of red, green and blue in luminance.
pub(crate) const LUMINANCE: Vec3 = Vec3::new(0.2126, 0.7152, 0.0722);

/// Exposes for the image's log-average luminance.
pub(crate) fn expose(samples: &[Sample], ambient: bool) -> Vec<[u8; 3]> {
    let ambient = if ambient {
        AMBIENT * mean(samples, |s| s.radiance) / mean(samples, |s| s.albedo).max(1e-6)
    } else {
        0.0
    };
    let radiance = |s: &Sample| s.radiance + ambient * s.albedo;
    let exposure = MIDDLE / log_average(samples.iter().map(|s| radiance(s).dot(LUMINANCE)));
    samples
        .iter()
        .map(|s| {
            let colour = (radiance(s) * exposure).map(compress).map(srgb);
            to_bytes(colour.lerp(Vec3::splat(BACKGROUND), s.background.clamp(0.0, 1.0)))
        })
        .collect()
}

/// The luminance that becomes pure white in an image of such luminances.
pub(crate) fn white(luminances: impl Iterator<Item = f32>) -> f32 {
    WHITE * log_average(luminances) / MIDDLE
}

/// Bytes of a colour in [0, 1].
pub(crate) fn to_bytes(colour: Vec3) -> [u8; 3] {
    colour.to_array().map(|x| (x * 255.0).round() as u8)
}

/// Mean luminance.
fn mean(samples: &[Sample], of: impl Fn(&Sample) -> Vec3) -> f32 {
    let sum: f64 = samples.iter().map(|s| f64::from(of(s).dot(LUMINANCE).min(1e30))).sum();
    (sum / samples.len().max(1) as f64) as f32
}

/// The geometric mean of what is not dark; 1 where all is.
fn log_average(luminances: impl Iterator<Item = f32>) -> f32 {
    let (mut sum, mut count) = (0.0, 0.0);
    for luminance in luminances.filter(|&l| l.is_normal() && l > 0.0) {
        sum += f64::from(luminance).ln();
        count += 1.0;
    }
    if count > 0.0 { (sum / count).exp() as f32 } else { 1.0 }
}

/// Reinhard's curve: nearly linear in the dark, 1 at [`WHITE`].
fn compress(x: f32) -> f32 {
    (x * (1.0 + x / (WHITE * WHITE)) / (1.0 + x)).clamp(0.0, 1.0)
}

fn srgb(x: f32) -> f32 {
    if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 }
}
