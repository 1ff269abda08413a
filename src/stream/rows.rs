//! Finding rays that come in rows, as those of a camera do, and taking them tile by tile.
//!
//! Neighbours of a row make a frustum as long as they are many, which meets more than twice as much as that of a
//! square tile of as many rays.

use crate::ray::Ray;
use crate::traverse::GROUP;

/// Rays along a side of a tile.
pub(super) const TILE: usize = 8;

/// The longest row that is looked for.
const LONGEST: usize = 1 << 14;

/// Neighbours over which distances are averaged, as rays of a pixel may start anywhere in it.
const SAMPLE: usize = 16;

/// How many rays a row has, at least two tiles, where the first rays come in rows, and those in the middle too.
///
/// In a row rays get away from its first one; the first ray of the next row is about as near to it as its neighbour.
pub(super) fn width(rays: &[Ray]) -> Option<usize> {
    let width = next_row(rays)?;
    let near = |width: &usize| mean_distance(rays, *width);
    let width = (width - 2..=width + 2).min_by(|a, b| near(a).total_cmp(&near(b)))?;
    let step = near(&1);
    let bands = rays.len() / (TILE * width);
    let in_rows = |band: usize| {
        let rays = &rays[band * TILE * width..];
        (1..TILE).all(|row| distance(&rays[row * width], &rays[(row - 1) * width]) <= TILE as f32 * step)
    };
    let gets_away = distance(&rays[0], &rays[width / 2]) >= (width / 4) as f32 * step;
    let is_row = gets_away && near(&width) <= 4.0 * step;
    (is_row && bands > 0 && in_rows(0) && in_rows((bands - 1) / 2)).then_some(width)
}

/// The first ray that is near the first one after others that are not.
fn next_row(rays: &[Ray]) -> Option<usize> {
    let rays = &rays[..rays.len().min(LONGEST)];
    let (mut farthest, mut nearest) = (0f32, f32::INFINITY);
    let mut next = None;
    for (i, ray) in rays.iter().enumerate() {
        let d = distance(ray, &rays[0]);
        farthest = farthest.max(d);
        if d < farthest / TILE as f32 && d < nearest {
            (next, nearest) = (Some(i), d);
        } else if next.is_some() {
            break;
        }
    }
    next.filter(|&next| next >= 2 * TILE && next + 2 + SAMPLE < rays.len())
}

/// The distance of the first rays to those that many later.
fn mean_distance(rays: &[Ray], later: usize) -> f32 {
    let sum: f32 = rays.iter().zip(&rays[later..]).take(SAMPLE).map(|(a, b)| distance(a, b)).sum();
    sum / SAMPLE as f32
}

/// Of origins and of directions: one of them is zero for the rays of most cameras.
fn distance(a: &Ray, b: &Ray) -> f32 {
    a.origin.distance(b.origin) + a.dir.distance(b.dir)
}

/// Calls `tile` with the indices of the rays of each tile, those at the edges cut off, of so many rays in rows.
pub(super) fn tiles(len: usize, width: usize, mut tile: impl FnMut(&[u32])) {
    let mut members = [0; GROUP];
    for band in (0..len).step_by(TILE * width) {
        for left in (0..width).step_by(TILE) {
            let mut n = 0;
            for row in (band..len.min(band + TILE * width)).step_by(width) {
                for at in row + left..len.min(row + width.min(left + TILE)) {
                    members[n] = at as u32;
                    n += 1;
                }
            }
            tile(&members[..n]);
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::rng::Rng;

    /// One ray a pixel of a tilted camera, somewhere in it, row after row.
    fn camera(width: usize, height: usize, jitter: f64) -> Vec<Ray> {
        let rng = &mut Rng::new(7);
        let forward = Vec3::new(1.0, -0.7, 0.4).normalize();
        let right = forward.cross(Vec3::Y).normalize();
        let down = forward.cross(right);
        let mut at = |i: usize| (i as f64 + jitter * rng.unit()) as f32 / width as f32 - 0.5;
        let mut ray = |i: usize| {
            let dir = forward + at(i % width) * right + at(i / width) * down;
            Ray::new([3.0, 2.0, 1.0], dir.normalize())
        };
        (0..width * height).map(&mut ray).collect()
    }

    #[test]
    fn rows_are_as_wide_as_the_picture() {
        for size in [16, 24, 37, 100, 1921] {
            assert_eq!(width(&camera(size, 31, 0.0)), Some(size));
        }
        assert_eq!(width(&camera(100, 31, 1.0)), Some(100), "anywhere in pixels");
        assert_eq!(width(&camera(100, 31, 0.0)[30..]), Some(100), "from the middle of a row");
        let parallel = |i: usize| Ray::new([(i % 50) as f32, (i / 50) as f32, 0.0], [0.1, 0.2, 1.0]);
        assert_eq!(width(&(0..1000).map(parallel).collect::<Vec<_>>()), Some(50));
    }

    #[test]
    fn other_rays_have_no_rows() {
        assert_eq!(width(&[]), None);
        assert_eq!(width(&camera(100, 7, 0.0)), None, "fewer than a band");
        assert_eq!(width(&camera(5000, 1, 0.0)), None);
        assert_eq!(width(&[camera(1, 1, 0.0)[0]; 1000]), None);
        let rng = &mut Rng::new(1);
        let random: Vec<Ray> = (0..20_000).map(|_| Ray::new([0.0; 3], rng.on_sphere().as_vec3())).collect();
        assert_eq!(width(&random), None);
        let rays = camera(104, 104, 0.0);
        let mut tiled = Vec::new();
        tiles(rays.len(), 104, |tile| tiled.extend(tile.iter().map(|&i| rays[i as usize])));
        assert_eq!(width(&tiled), None, "tile after tile");
    }

    #[test]
    fn tiles_have_every_ray_once() {
        for (len, width) in [(0, 16), (1, 16), (64, 16), (1000, 37), (4097, 512)] {
            let mut all = Vec::new();
            tiles(len, width, |tile| {
                assert!(tile.len() <= GROUP);
                all.extend_from_slice(tile);
            });
            all.sort_unstable();
            assert!(all.iter().copied().eq(0..len as u32));
        }
    }
}
