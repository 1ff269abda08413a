//! The paper's two ways down and across: general, and for N = 2 (section 3.3).
//!
//! A ray goes through a voxel that is divided into N x N x N. Both types hold the part in which it is:
//! for each axis when it leaves that part (`exit`) and how long it takes to cross one (`width`), in any
//! unit of time in which the ray moves evenly. The paper counts `remain = exit - time` down instead;
//! absolute times need no update of the axes that are not crossed.
//!
//! `rises` says by a bit an axis where the ray's coordinate grows. A component of the direction of zero
//! must have been replaced by a tiny one, so that all times are finite.
//!
//! ```
//! use octogrid::descent::{General, Halves};
//! // Along the diagonal of a cube that takes 4 to cross, shifted a little: at time 0.1.
//! let (exit, width) = ([4.0, 3.9, 3.8], [4.0; 3]);
//! let general = General::<2>::whole(exit, width).descend(0.1, 0b111);
//! let halves = Halves::whole(exit, width).descend(0.1, 0b111);
//! assert_eq!((general.voxel, halves.voxel), (0, 0));
//! assert_eq!(&general.exit, halves.exit());
//! ```

use crate::lanes::{Isa, Lanes, dispatch_here};

/// A part of a voxel that is divided into N x N x N, for any N.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct General<const N: u32> {
    /// When the ray leaves the part along each axis.
    pub exit: [f64; 3],
    /// How long it takes to cross a part along each axis.
    pub width: [f64; 3],
    /// How many parts follow along each axis, 0 to N - 1.
    pub left: [u32; 3],
    /// The index of the part: x + N y + N^2 z.
    pub voxel: u32,
}

impl<const N: u32> General<N> {
    /// An undivided voxel.
    #[inline(always)]
    pub fn whole(exit: [f64; 3], width: [f64; 3]) -> Self {
        Self { exit, width, left: [0; 3], voxel: 0 }
    }

    /// The part of this part in which the ray is at `time`: divide, truncate, clamp, multiply by the
    /// stride.
    #[inline(always)]
    pub fn descend(&self, time: f64, rises: u32) -> Self {
        let increments = [1, N, N * N];
        let mut part = Self { voxel: 0, ..*self };
        for axis in 0..3 {
            part.width[axis] = self.width[axis] / f64::from(N);
            let remain = self.exit[axis] - time;
            let left = ((remain / part.width[axis]) as u32).min(N - 1);
            part.exit[axis] -= f64::from(left) * part.width[axis];
            part.left[axis] = left;
            let index = if rises >> axis & 1 != 0 { N - 1 - left } else { left };
            part.voxel += index * increments[axis];
        }
        part
    }

    /// Steps along `axis`. False where that leads out of the voxel; the state then is that of the first
    /// part of a neighbour that is divided in the same way.
    #[inline(always)]
    pub fn step(&mut self, axis: usize, rises: u32) -> bool {
        let stride = [1, N as i32, (N * N) as i32][axis];
        let stride = if rises >> axis & 1 != 0 { stride } else { -stride };
        self.exit[axis] += self.width[axis];
        let inside = self.left[axis] != 0;
        if inside {
            self.left[axis] -= 1;
            self.voxel = self.voxel.wrapping_add_signed(stride);
        } else {
            self.left[axis] = N - 1;
            self.voxel = self.voxel.wrapping_add_signed(-stride * (N as i32 - 1));
        }
        inside
    }
}

/// A part of a voxel that is halved along each axis.
///
/// The times of the three axes share a SIMD register, with nothing in its fourth lane: a descent is a
/// multiplication, a subtraction, a comparison and a selection, and the comparison's mask is what the
/// index is XORed with.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(32))]
pub struct Halves {
    exit: [f64; 4],
    width: [f64; 4],
    /// The index of the part: a bit an axis, set for the upper half.
    pub voxel: u32,
}

impl Halves {
    /// An undivided voxel.
    #[inline(always)]
    pub fn whole(exit: [f64; 3], width: [f64; 3]) -> Self {
        let four = |[x, y, z]: [f64; 3]| [x, y, z, f64::NEG_INFINITY];
        Self { exit: four(exit), width: [width[0], width[1], width[2], 0.0], voxel: 0 }
    }

    /// When the ray leaves the part along each axis.
    #[inline(always)]
    pub fn exit(&self) -> &[f64; 3] {
        self.exit.first_chunk().expect("four are more than three")
    }

    /// The part of this part in which the ray is at `time`: it starts from the far corner; where the
    /// ray has not passed the middle plane, it leaves there, and the axis' bit is flipped.
    #[inline(always)]
    pub fn descend(&self, time: f64, rises: u32) -> Self {
        dispatch_here!(Isa::baseline(), lanes => self.descend_in(lanes, time, rises))
    }

    /// [`Halves::descend`] with an instruction set that was found at run time.
    #[inline(always)]
    pub(crate) fn descend_in<L: Lanes>(&self, lanes: L, time: f64, rises: u32) -> Self {
        let exit = lanes.load4(&self.exit);
        let width = lanes.splat4(0.5) * lanes.load4(&self.width);
        let middle = exit - width;
        let before = lanes.less4(lanes.splat4(time), middle);
        let exit = lanes.select4(before, middle, exit);
        Self { exit: lanes.store4(exit), width: lanes.store4(width), voxel: rises ^ lanes.bits4(before) }
    }

    /// Steps along `axis`. False where that leads out of the voxel; the state then is that of the first
    /// part of a neighbour that is divided too.
    #[inline(always)]
    pub fn step(&mut self, axis: usize, rises: u32) -> bool {
        self.voxel ^= 1 << axis;
        self.exit[axis] += self.width[axis];
        (self.voxel ^ rises) >> axis & 1 == 0
    }
}

/// Whether a walk is one for this structure or for all of its kind. Both give the same answers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Walk {
    /// Octrees by [`Halves`]; hybrids without the code for bricks where there are none.
    #[default]
    Special,
    /// Octrees by [`General`], hybrids with the code for bricks: for comparison.
    General,
}

/// The axis of the least of three times: the one along which the ray leaves first.
#[inline(always)]
pub fn first_exit([x, y, z]: &[f64; 3]) -> usize {
    if x <= y {
        if x <= z { 0 } else { 2 }
    } else if y <= z {
        1
    } else {
        2
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Entry states of all octants, none on a middle plane, where the two may take either side.
    fn states() -> impl Iterator<Item = ([f64; 3], [f64; 3], f64, u32)> {
        (0..8u32).flat_map(|rises| {
            (0..200u32).map(move |i| {
                let value = |k: u32| f64::from(i.wrapping_mul(2_654_435_761).rotate_left(7 * k) >> 24);
                let width = [1.0 + value(0), 1.0 + value(1), 1.0 + value(2)];
                let time = value(3) / 4.0;
                let exit = [0, 1, 2].map(|k| time + width[k] * value(4 + k as u32) / 256.7);
                (exit, width, time, rises)
            })
        })
    }

    #[test]
    fn both_descents_and_steps_agree() {
        for (exit, width, time, rises) in states() {
            let mut general = General::<2>::whole(exit, width).descend(time, rises);
            let mut halves = Halves::whole(exit, width).descend(time, rises);
            for _ in 0..8 {
                assert_eq!((general.voxel, general.exit), (halves.voxel, *halves.exit()));
                let axis = first_exit(&general.exit);
                assert_eq!(general.step(axis, rises), halves.step(axis, rises));
            }
        }
    }

    #[test]
    fn a_step_out_enters_the_neighbour() {
        for (exit, width, time, rises) in states() {
            let mut part = General::<4>::whole(exit, width).descend(time, rises);
            let axis = first_exit(&part.exit);
            let last = (0..4).find(|_| !part.step(axis, rises)).is_some();
            let index = part.voxel >> (2 * axis) & 3;
            assert!(last && index == if rises >> axis & 1 != 0 { 0 } else { 3 });
        }
    }
}
