//! What a group of rays may meet: between two lines along either of its minor axes.
//!
//! A line below all rays at two places is below them at every place between, as they are straight. So the
//! bounds of the rays at both ends of their common span give the lines.
//!
//! # Errors
//! Rays that pass the grid, of size S, reach no farther than 13 S from it between the ends, so that bounds are
//! clamped to 16 S. With M the larger of S and the farthest bound, f32 misplaces a line by less than 28 * 2^-24 M:
//! 7.1 M by evaluating the bounds, 7.1 M and 6.1 M by rounding a line's place and slope, 7.1 M by evaluating the
//! line. It is moved outwards by [`SLACK`].

use super::group::Group;
use crate::arena::{BoxGroup, Grid};
use crate::bundle::Bundle;
use crate::lanes::{Lanes, WIDTH, greater, lesser};

/// By how much the bounds are enlarged, in M.
const SLACK: f64 = 1.0 / (1u32 << 19) as f64;

/// How far beyond their span the rays are bounded, in sizes of the grid: that makes two different places of any
/// span. Little, as rays of a camera meet where they begin, and not before.
const BEYOND: f32 = 1.0 / (1u32 << 12) as f32;

/// The bounds of a group's rays.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frustum {
    pub(crate) main: usize,
    pub(crate) others: [usize; 2],
    /// The least and greatest x.
    pub(crate) span: [f32; 2],
    /// By minor axis: the lower and the upper line, at + slope * x.
    at: [[f32; 2]; 2],
    slope: [[f32; 2]; 2],
    /// The places that the rays were between at first.
    ends: [f32; 2],
}

impl Frustum {
    /// Around the rays; `None` where none of them meets the grid.
    #[inline(always)]
    pub(crate) fn around<L: Lanes>(lanes: L, group: &Group<'_>, longest: f32) -> Option<Self> {
        let span = span(lanes, group);
        if span[0] > span[1] {
            return None;
        }
        let beyond = BEYOND * longest;
        let ends = [span[0] - beyond, span[1] + beyond];
        let mut frustum = Self {
            main: group.main,
            others: group.others,
            span,
            at: [[0.0; 2]; 2],
            slope: [[0.0; 2]; 2],
            ends,
        };
        let inverse = 1.0 / (f64::from(ends[1]) - f64::from(ends[0]));
        // What a ray that passes the grid does not reach: others must not spoil the precision.
        let most = 16.0 * longest;
        for side in 0..2 {
            let (from, to) = (bounds(lanes, group, side, ends[0]), bounds(lanes, group, side, ends[1]));
            for k in 0..2 {
                let (from, to) = (from[k].clamp(-most, most), to[k].clamp(-most, most));
                let farthest = greater(longest, greater(from.abs(), to.abs()));
                let (from, to) = (f64::from(from), f64::from(to));
                let slope = (to - from) * inverse;
                let slack = SLACK * f64::from(farthest);
                let at = from - slope * f64::from(ends[0]) + if k == 0 { -slack } else { slack };
                (frustum.slope[side][k], frustum.at[side][k]) = (slope as f32, at as f32);
            }
        }
        Some(frustum)
    }

    /// Its greatest extent along a minor axis.
    #[inline(always)]
    pub(crate) fn width(&self) -> f32 {
        let width = |side: usize, x: f32| {
            let [low, high] = self.range(side, x, x);
            high - low
        };
        let [a, b] = self.span;
        greater(greater(width(0, a), width(0, b)), greater(width(1, a), width(1, b)))
    }

    /// The least and greatest place along a minor axis from `a` to `b`.
    #[inline(always)]
    pub(crate) fn range(&self, side: usize, a: f32, b: f32) -> [f32; 2] {
        let line = |k: usize, x: f32| self.at[side][k] + self.slope[side][k] * x;
        [lesser(line(0, a), line(0, b)), greater(line(1, a), line(1, b))]
    }

    /// The same lines in the coordinates of the scene.
    #[inline(always)]
    pub(crate) fn bundle(&self, grid: &Grid) -> Bundle {
        let mut bundle = Bundle { middle: [[0.0; 3]; 2], half: [[0.0; 3]; 2] };
        for end in 0..2 {
            let x = self.ends[end];
            let mut set = |axis: usize, [low, high]: [f32; 2]| {
                let (low, high) = (f64::from(low), f64::from(high));
                let middle = grid.lo[axis] + 0.5 * (low + high) * grid.cell;
                // Rounding the middle moves it by half of this.
                let slack = middle.abs() * f64::from(f32::EPSILON);
                bundle.middle[end][axis] = middle as f32;
                bundle.half[end][axis] = ((0.5 * (high - low) * grid.cell + slack) as f32).next_up();
            };
            set(self.main, [x, x]);
            for side in 0..2 {
                set(self.others[side], self.range(side, x, x));
            }
        }
        bundle
    }

    /// The boxes that it meets, as bits.
    #[inline(always)]
    pub(crate) fn boxes<L: Lanes>(&self, lanes: L, group: &BoxGroup) -> u32 {
        let plane = |side: usize, axis: usize| lanes.load16(&group.planes[side][axis]);
        let a = lanes.max16(plane(0, self.main), lanes.splat16(self.span[0]));
        let b = lanes.min16(plane(1, self.main), lanes.splat16(self.span[1]));
        let mut apart = lanes.less16(b, a);
        for side in 0..2 {
            let line = |k: usize, x: L::F32x16| {
                lanes.mul_add16(x, lanes.splat16(self.slope[side][k]), lanes.splat16(self.at[side][k]))
            };
            let low = lanes.min16(line(0, a), line(0, b));
            let high = lanes.max16(line(1, a), line(1, b));
            let axis = self.others[side];
            apart = apart | lanes.less16(plane(1, axis), low) | lanes.less16(high, plane(0, axis));
        }
        !lanes.bits16(apart) & 0xffff
    }
}

/// The span of all rays.
#[inline(always)]
pub(crate) fn span<L: Lanes>(lanes: L, group: &Group<'_>) -> [f32; 2] {
    let (mut low, mut high) = (lanes.splat(f32::INFINITY), lanes.splat(f32::NEG_INFINITY));
    for packet in &group.packets[..group.packets()] {
        low = lanes.min(low, lanes.load(&packet.span[0]));
        high = lanes.max(high, lanes.load(&packet.span[1]));
    }
    [least(&lanes.store(low)), greatest(&lanes.store(high))]
}

/// The least and greatest place along a minor axis of the rays at `x`.
#[inline(always)]
fn bounds<L: Lanes>(lanes: L, group: &Group<'_>, side: usize, x: f32) -> [f32; 2] {
    let x = lanes.splat(x);
    let (mut low, mut high) = (lanes.splat(f32::INFINITY), lanes.splat(f32::NEG_INFINITY));
    for packet in &group.packets[..group.packets()] {
        let u = lanes.mul_add(x, lanes.load(&packet.slope[side]), lanes.load(&packet.at[side]));
        let none = lanes.less(lanes.load(&packet.span[1]), lanes.load(&packet.span[0]));
        low = lanes.min(low, lanes.select(none, low, u));
        high = lanes.max(high, lanes.select(none, high, u));
    }
    [least(&lanes.store(low)), greatest(&lanes.store(high))]
}

#[inline(always)]
fn least(x: &[f32; WIDTH]) -> f32 {
    let [a, b, c, d, e, f, g, h] = *x;
    lesser(lesser(lesser(a, b), lesser(c, d)), lesser(lesser(e, f), lesser(g, h)))
}

#[inline(always)]
fn greatest(x: &[f32; WIDTH]) -> f32 {
    let [a, b, c, d, e, f, g, h] = *x;
    greater(greater(greater(a, b), greater(c, d)), greater(greater(e, f), greater(g, h)))
}
