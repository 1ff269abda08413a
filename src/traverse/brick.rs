//! The 4 x 4 x 4 voxels of a brick that a path meets, as a 64-bit mask found without stepping.
//!
//! Along each axis a voxel is a time interval. Three intervals overlap iff they do so pairwise, so three
//! times 16 comparisons (x and y, x and z, y and z) say it for all 64 voxels. In the mirrored order of
//! [`Path`](crate::dda::Path), bit x + 4 y + 16 z, the lowest set bit is the next voxel on the path.

use glam::Vec4;

use crate::arena::Brick;
use crate::lanes::{Lanes, WIDTH};

/// The times at which a path passes planes, by axis; the fourth lane repeats the third.
///
/// As vectors, as is all that is put on the stack of bricks and taken from it: a vector is not loaded before single
/// values stored to it have left the processor.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Line {
    /// Time a cell, with the sign of the direction.
    slope: Vec4,
    /// Minus the time at which the path passes the grid's lower corner.
    delay: Vec4,
    /// The sides of a brick's voxel from its lower to its mirrored corner: 0, or 4 where the direction is negative.
    mirrored: Vec4,
}

impl Line {
    #[inline(always)]
    pub(crate) fn new([x, y, z]: [f32; 3], [u, v, w]: [f32; 3], octant: u32) -> Self {
        let side = |axis: u32| (octant >> axis << 2 & 4) as f32;
        Self {
            slope: Vec4::new(x, y, z, z),
            delay: Vec4::new(u, v, w, w),
            mirrored: Vec4::new(side(0), side(1), side(2), side(2)),
        }
    }
}

/// When a path enters a brick's lower planes (upper where it is mirrored), and how long it takes to cross one voxel,
/// likewise.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BrickPath {
    enter: Vec4,
    width: Vec4,
}

impl BrickPath {
    #[inline(always)]
    pub(crate) fn new(line: &Line, brick: &Brick) -> Self {
        let corner = brick.lo + line.mirrored * brick.side;
        Self { enter: corner * line.slope + line.delay, width: brick.side * line.slope.abs() }
    }

    /// When the path enters the voxel with this index (x + 4 y + 16 z, mirrored), at the earliest.
    #[inline(always)]
    pub(crate) fn start(&self, index: u32) -> f32 {
        (PLACES[index as usize % PLACES.len()] * self.width + self.enter).max_element()
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
    ///
    /// Each ends when the next one begins, to the bit, and no sum is fused, as in [`BrickPath::start`].
    #[inline(always)]
    fn interval<L: Lanes>(&self, lanes: L, axis: usize, index: &[f32; WIDTH], limit: f32) -> Interval<L> {
        let (enter, width) = (lanes.splat(self.enter[axis]), lanes.splat(self.width[axis]));
        let index = lanes.load(index);
        let (start, end) = (index * width + enter, (index + lanes.splat(1.0)) * width + enter);
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

    fn path([x, y, z]: [f32; 3], [u, v, w]: [f32; 3]) -> BrickPath {
        BrickPath { enter: Vec4::new(x, y, z, z), width: Vec4::new(u, v, w, w) }
    }

    /// Voxel by voxel.
    fn slow_mask(path: &BrickPath, limit: f32) -> u64 {
        let met = |index: u32| {
            let (mut start, mut end) = (0f32, limit);
            for axis in 0..3 {
                let at = (index >> (2 * axis) & 3) as f32;
                start = start.max(at * path.width[axis] + path.enter[axis]);
                end = end.min((at + 1.0) * path.width[axis] + path.enter[axis]);
            }
            start <= end
        };
        (0..64).map(|i| u64::from(met(i)) << i).sum()
    }

    fn random(i: u32) -> (BrickPath, f32) {
        let value = |k: u32| (i.wrapping_mul(2_654_435_761).rotate_left(k * 5) >> 20) as f32 / 4096.0;
        let enter = [0, 1, 2].map(|k| 3.0 * value(k) - 2.0);
        let path = path(enter, [3, 4, 5].map(|k| 1.0 / (value(k) + 1e-3)));
        (path, if i.is_multiple_of(2) { f32::INFINITY } else { 2.0 * value(6) })
    }

    #[test]
    fn masks_are_those_of_single_voxels() {
        for (path, limit) in (0..2000).map(random) {
            let mask = path.mask(Portable, limit);
            assert_eq!(mask, slow_mask(&path, limit), "{path:?} {limit}");
            for index in (0..64).filter(|i| mask >> i & 1 != 0) {
                assert!(path.start(index) <= limit, "{path:?} {limit} {index}");
            }
        }
    }

    #[test]
    fn a_diagonal_meets_the_voxels_around_it() {
        let mask = path([0.0; 3], [1.0; 3]).mask(Portable, f32::INFINITY);
        for i in 0..4 {
            assert_ne!(mask & 1 << (21 * i), 0);
        }
    }

    /// A path enters a voxel where it passes its lower planes or, in the other direction, its upper ones.
    #[test]
    fn voxels_are_entered_at_their_planes() {
        let lo = [1.0, -2.0, 0.5f32];
        let side = [0.25, 0.5, 2.0f32];
        let four = |[x, y, z]: [f32; 3]| Vec4::new(x, y, z, z);
        let brick = Brick { lo: four(lo), side: four(side), occupied: 1, first: 0, padding: 0 };
        for octant in 0..8 {
            let falls = |axis: usize| octant >> axis & 1 != 0;
            let slope: [f32; 3] = std::array::from_fn(|axis| if falls(axis) { -3.0 } else { 2.0 });
            let path = BrickPath::new(&Line::new(slope, [1.0, 2.0, 4.0], octant), &brick);
            for index in 0..64 {
                let times = [0, 1, 2].map(|axis| {
                    let i = index >> (2 * axis) & 3;
                    let i = if falls(axis) { 4 - i } else { i };
                    (lo[axis] + i as f32 * side[axis]) * slope[axis] + [1.0, 2.0, 4.0][axis]
                });
                assert_eq!(path.start(index), times.into_iter().fold(f32::MIN, f32::max), "{octant} {index}");
            }
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

    /// A path that climbs through a brick while it crosses a plane at a small angle.
    #[test]
    fn no_height_is_left_out_at_a_plane() {
        let mut rng = crate::rng::Rng::new(1);
        for i in 0..10_000 {
            let (crossing, width) = (rng.range(0.0, 4.0), rng.range(4.0, 8.0) * 2f64.powi(i % 30));
            let path = path([(crossing - width) as f32, 0.0, -1.0], [width as f32, 1.0, 1e30]);
            let mask = path.mask(Portable, f32::INFINITY);
            for height in 0..4 {
                assert_ne!(mask & 0xf << (4 * height), 0, "{crossing} {width} {height}");
            }
        }
    }
}
