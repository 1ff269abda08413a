//! A colour bar with numbers at the bottom of a picture.

use image::{Rgb, RgbImage};
use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};

use crate::heat::turbo;

const HEIGHT: u32 = 24;
const MARGIN: u32 = 8;
const WEIGHT: FontWeight = FontWeight::Regular;
const SIZE: RasterHeight = RasterHeight::Size16;

/// Draws the bar over the lowest rows; a picture that is too small for it stays as it is.
pub(crate) fn draw(picture: &mut RgbImage, [low, high]: [u64; 2]) {
    let (low, high) = (low.to_string(), format!("{high} voxels + clusters"));
    let (width, height) = picture.dimensions();
    let start = 2 * MARGIN + text_width(&low);
    let taken = start + 2 * MARGIN + text_width(&high);
    if width < taken + 32 || height < 4 * HEIGHT {
        return;
    }
    let (top, bar) = (height - HEIGHT, width - taken);
    for y in top..height {
        for x in 0..width {
            picture.put_pixel(x, y, Rgb([16; 3]));
        }
    }
    for y in top + 6..height - 6 {
        for x in 0..bar {
            picture.put_pixel(start + x, y, Rgb(turbo(x as f32 / (bar - 1) as f32)));
        }
    }
    write(picture, &low, MARGIN, top + 4);
    write(picture, &high, start + bar + MARGIN, top + 4);
}

fn text_width(text: &str) -> u32 {
    (text.len() * get_raster_width(WEIGHT, SIZE)) as u32
}

/// Writes in white on dark.
fn write(picture: &mut RgbImage, text: &str, left: u32, top: u32) {
    for (at, glyph) in text.chars().filter_map(|c| get_raster(c, WEIGHT, SIZE)).enumerate() {
        let left = left + (at * glyph.width()) as u32;
        for (y, row) in glyph.rows().enumerate() {
            for (x, &ink) in row.iter().enumerate() {
                picture.put_pixel(left + x as u32, top + y as u32, Rgb([ink.max(16); 3]));
            }
        }
    }
}
