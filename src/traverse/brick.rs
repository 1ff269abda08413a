//! The 4 x 4 x 4 voxels of a brick that a path meets, as a 64-bit mask found without stepping.
//!
//! Along each axis a voxel is a time interval. Three intervals overlap iff they do so pairwise, so three
//! times 16 comparisons (x and y, x and z, y and z) say it for all 64 voxels. In the mirrored order of
//! [`Path`](crate::dda::Path), bit x + 4 y + 16 z, the lowest set bit is the next voxel on the path.

use glam::Vec4;

use crate::lanes::{Lanes, WIDTH};

/// When a path enters a brick's lower planes, and how long it takes to cross one voxel, by axis; the fourth lane
/// repeats the third.
///
/// As vectors, in which they are put on the stack of bricks and taken from it: a vector is not loaded before single
/// values stored to it have left the processor.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BrickPath {
    enter: Vec4,
    width: Vec4,
    /// More than the rounding errors of all times in the cell of the top grid, so that every voxel is
    /// met at the times at which the path is in it. Smaller voxels inherit the errors, hence the slack.
    slack: Vec4,
}

impl BrickPath {
    /// For the brick that fills a cell of the top grid.
    #[inline(always)]
    pub(crate) fn new([x, y, z]: [f32; 3], [u, v, w]: [f32; 3]) -> Self {
        let (enter, width) = (Vec4::new(x, y, z, z), Vec4::new(u, v, w, w));
        Self { enter, width, slack: (enter.abs() + 4.0 * width) * 2f32.powi(-20) }
    }

    /// The same for the brick that fills the voxel with this index (x + 4 y + 16 z, mirrored).
    #[inline(always)]
    pub(crate) fn child(&self, index: u32) -> Self {
        let enter = self.enter + PLACES[index as usize % PLACES.len()] * self.width;
        Self { enter, width: 0.25 * self.width, slack: self.slack }
    }

    /// When the path enters the brick at the earliest, given the slack.
    #[inline(always)]
    pub(crate) fn earliest(&self) -> f32 {
        (self.enter - self.slack).max_element()
    }

    /// The voxels that the path meets from time 0 to `limit`.
    #[inline(always)]
    pub(crate) fn mask<L: Lanes>(&self, lanes: L, limit: f32) -> u64 {
        // The index along an axis that runs with the lane, and of one that runs with half the lanes.
        const FAST: [f32; WIDTH] = [0.0, 1.0, 2.0, 3.0, 0.0, 1.0, 2.0, 3.0];
        const LOW: [f32; WIDTH] = [0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0];
        const HIGH: [f32; WIDTH] = [2.0, 2.0, 2.0, 2.0, 3.0, 3.0, 3.0, 3.0];
        let (x, y) = (self.interval(lanes, 0, &FAST, limit), self.interval(lanes, 1, &FAST, limit));
        let slow_y = [self.interval(lanes, 1, &LOW, limit), self.interval(lanes, 1, &HIGH, limit)];
        let slow_z = [self.interval(lanes, 2, &LOW, limit), self.interval(lanes, 2, &HIGH, limit)];
        let (xy, xz, yz) = (pair(lanes, x, slow_y), pair(lanes, x, slow_z), pair(lanes, y, slow_z));
        let (xz, yz) = (spread_nibbles(xz), spread_bits(spread_nibbles(yz)));
        xy.wrapping_mul(0x0001_0001_0001_0001) & xz.wrapping_mul(0x1111) & yz.wrapping_mul(0xf)
    }

    /// When the path is between the planes of the voxels with these indices along an axis.
    #[inline(always)]
    fn interval<L: Lanes>(&self, lanes: L, axis: usize, index: &[f32; WIDTH], limit: f32) -> Interval<L> {
        let (first, last) = (self.enter - self.slack, self.enter + self.width + self.slack);
        let (index, width) = (lanes.load(index), lanes.splat(self.width[axis]));
        let start = lanes.mul_add(index, width, lanes.splat(first[axis]));
        let end = lanes.mul_add(index, width, lanes.splat(last[axis]));
        (lanes.max(start, lanes.splat(0.0)), lanes.min(end, lanes.splat(limit)))
    }
}

/// The indices along the axes of each voxel.
const PLACES: [Vec4; 64] = {
    let mut places = [Vec4::ZERO; 64];
    let mut i = 0;
    while i < 64 {
        let z = (i >> 4) as f32;
        places[i] = Vec4::new((i & 3) as f32, (i >> 2 & 3) as f32, z, z);
        i += 1;
    }
    places
};

/// Start and end.
type Interval<L> = (<L as Lanes>::F32, <L as Lanes>::F32);

/// Bit f + 4 s: the intervals f of one axis and s of the other overlap.
#[inline(always)]
fn pair<L: Lanes>(lanes: L, fast: Interval<L>, [low, high]: [Interval<L>; 2]) -> u64 {
    u64::from(!(apart(lanes, fast, low) | apart(lanes, fast, high) << 8) & 0xffff)
}

/// The lanes in which two intervals do not overlap, as bits.
#[inline(always)]
fn apart<L: Lanes>(lanes: L, a: Interval<L>, b: Interval<L>) -> u32 {
    lanes.bits(lanes.less(a.1, b.0) | lanes.less(b.1, a.0))
}

/// The four low nibbles to bits 0, 16, 32, 48.
#[inline(always)]
fn spread_nibbles(x: u64) -> u64 {
    let x = (x | x << 24) & 0x0000_00ff_0000_00ff;
    (x | x << 12) & 0x000f_000f_000f_000f
}

/// The bits of the low nibble of each 16 bits to its bits 0, 4, 8, 12.
#[inline(always)]
fn spread_bits(x: u64) -> u64 {
    let x = (x | x << 6) & 0x0303_0303_0303_0303;
    (x | x << 3) & 0x1111_1111_1111_1111
}

/// The mask with the axes of `octant` mirrored.
#[inline(always)]
pub(crate) fn mirror(mut mask: u64, octant: u32) -> u64 {
    let swap = |mask: u64, low: u64, shift: u32| (mask & low) << shift | (mask >> shift) & low;
    if octant & 1 != 0 {
        mask = swap(swap(mask, 0x5555_5555_5555_5555, 1), 0x3333_3333_3333_3333, 2);
    }
    if octant & 2 != 0 {
        mask = swap(swap(mask, 0x0f0f_0f0f_0f0f_0f0f, 4), 0x00ff_00ff_00ff_00ff, 8);
    }
    if octant & 4 != 0 {
        mask = swap(mask, 0x0000_ffff_0000_ffff, 16).rotate_left(32);
    }
    mask
}

/// What to XOR a mirrored index with.
#[inline(always)]
pub(crate) fn mirror_index(octant: u32) -> u32 {
    const BITS: [u32; 8] = [0o00, 0o03, 0o14, 0o17, 0o60, 0o63, 0o74, 0o77];
    BITS[octant as usize & 7]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::Portable;

    /// Voxel by voxel, in f64, without slack.
    fn slow_mask(path: &BrickPath, limit: f32) -> u64 {
        let met = |index: u32| {
            let (mut start, mut end) = (0f64, f64::from(limit));
            for axis in 0..3 {
                let at = f64::from(index >> (2 * axis) & 3);
                let (enter, width) = (f64::from(path.enter[axis]), f64::from(path.width[axis]));
                start = start.max(enter + at * width);
                end = end.min(enter + (at + 1.0) * width);
            }
            start <= end
        };
        (0..64).map(|i| u64::from(met(i)) << i).sum()
    }

    #[test]
    fn masks_are_those_of_single_voxels() {
        for i in 0..2000u32 {
            let value = |k: u32| (i.wrapping_mul(2_654_435_761).rotate_left(k * 5) >> 20) as f32 / 4096.0;
            let enter = [0, 1, 2].map(|k| 3.0 * value(k) - 2.0);
            let path = BrickPath::new(enter, [3, 4, 5].map(|k| 1.0 / (value(k) + 1e-3)));
            let limit = if i % 2 == 0 { f32::INFINITY } else { 2.0 * value(6) };
            assert_eq!(path.mask(Portable, limit), slow_mask(&path, limit), "{path:?} {limit}");
        }
    }

    #[test]
    fn a_diagonal_meets_the_voxels_around_it() {
        let path = BrickPath::new([0.0; 3], [1.0; 3]);
        let mask = path.mask(Portable, f32::INFINITY);
        for i in 0..4 {
            assert_ne!(mask & 1 << (21 * i), 0);
        }
    }

    #[test]
    fn mirroring_agrees_with_the_index() {
        for octant in 0..8 {
            for bit in 0..64 {
                assert_eq!(mirror(1 << bit, octant), 1 << (bit ^ mirror_index(octant)));
            }
        }
    }
    /// Notes the heights (y) of the voxels that a path meets three levels down, where all are occupied.
    fn heights(path: &BrickPath, levels: u32, below: usize, met: &mut [bool; 64]) {
        let mut mask = path.mask(Portable, f32::INFINITY);
        while mask != 0 {
            let index = mask.trailing_zeros();
            mask &= mask - 1;
            let height = 4 * below + (index as usize >> 2 & 3);
            match levels {
                1 => met[height] = true,
                _ => heights(&path.child(index), levels - 1, height, met),
            }
        }
    }

    /// A path that climbs one cell while it crosses the plane between two bricks at a small angle.
    #[test]
    fn no_height_is_left_out_between_bricks() {
        let mut rng = crate::rng::Rng::new(1);
        for i in 0..10_000 {
            let (crossing, width) = (rng.unit(), rng.range(1.0, 2.0) * 2f64.powi(i % 30));
            let mut met = [false; 64];
            for enter in [crossing - width, crossing] {
                let path = |enter: f64| {
                    let width = [width as f32, 1.0, 1e30].map(|w| 0.25 * w);
                    BrickPath::new([enter as f32, 0.0, -1.0], width)
                };
                heights(&path(enter), 3, 0, &mut met);
            }
            assert_eq!(met, [true; 64], "{crossing} {width}");
        }
    }
}
