//! Splits of boxes by the surface area heuristic.
//!
//! Recursive binary splits at the cheapest of 16 planes an axis (I. Wald, "On fast Construction of
//! SAH-based Bounding Volume Hierarchies", 2007), where the cost of a side is its area times the number
//! of clusters that it fills. O(n log n), in parallel, in place.

use glam::Vec4;

use super::grid::WHOLE;
use crate::aabb::Aabb;
use crate::lanes::WIDTH;
use crate::parallel;

const BINS: usize = 16;
/// Axes along which the centres spread less than this, in parts of the widest spread, are not tried.
const THIN: f32 = 0.1;

/// How many triangles a member stands for.
pub(super) trait Weight: Fn(&Member) -> usize + Sync {}

impl<F: Fn(&Member) -> usize + Sync> Weight for F {}

/// The box and index of a triangle or of a group of them.
///
/// The fourth lanes hold the halves of the index as whole numbers: arithmetic on all four lanes is one
/// instruction, and slow where one is subnormal.
#[derive(Clone, Copy)]
pub(super) struct Member {
    lo: Vec4,
    hi: Vec4,
}

impl Member {
    pub(super) fn new(index: u32, b: &Aabb) -> Self {
        Self { lo: b.lo.extend((index & 0xffff) as f32), hi: b.hi.extend((index >> 16) as f32) }
    }

    pub(super) fn index(&self) -> u32 {
        self.lo.w as u32 | (self.hi.w as u32) << 16
    }

    #[inline(always)]
    fn center(&self) -> Vec4 {
        self.lo * 0.5 + self.hi * 0.5
    }
}

/// Splits until what is left weighs at most `most`, and marks the last of it in `ends`; halves where no
/// plane helps or planes have peeled off little by little.
pub(super) fn split<W: Weight>(members: &mut [Member], ends: &mut [bool], weight: &W, most: usize) {
    split_at(members, ends, weight, most, 0);
}

fn split_at<W: Weight>(members: &mut [Member], ends: &mut [bool], weight: &W, most: usize, depth: u32) {
    const MAX_UNEVEN_DEPTH: u32 = 64;
    const PARALLEL: usize = 512;
    if members.len() <= 1 || members.iter().map(weight).sum::<usize>() <= most {
        ends.last_mut().into_iter().for_each(|end| *end = true);
        return;
    }
    let plane = if members.len() < 4 * BINS {
        cheapest_plane::<8, W>(members, weight)
    } else {
        cheapest_plane::<BINS, W>(members, weight)
    };
    let middle = match plane {
        Some(plane) if depth < MAX_UNEVEN_DEPTH => partition(members, |member| plane.is_below(member)),
        _ => half(members.len()),
    };
    let serial = middle.min(members.len() - middle) < PARALLEL;
    let (below, above) = members.split_at_mut(middle);
    let (ends_below, ends_above) = ends.split_at_mut(middle);
    let mut first = || split_at(below, ends_below, weight, most, depth + 1);
    let mut second = || split_at(above, ends_above, weight, most, depth + 1);
    if serial {
        first();
        second();
    } else {
        parallel::join(first, second);
    }
}

/// Half of the members, of more than one; as full clusters where these are triangles.
fn half(members: usize) -> usize {
    (members / 2).next_multiple_of(WIDTH).min(members - 1)
}

/// Bins of the centres along each axis; a scale of zero where it isn't tried.
struct Binning {
    start: Vec4,
    scale: Vec4,
}

impl Binning {
    fn new(members: &[Member], bins: usize) -> Self {
        let (mut lo, mut hi) = (Vec4::MAX, Vec4::MIN);
        for member in members {
            let center = member.center();
            (lo, hi) = (lo.min(center), hi.max(center));
        }
        let spread = hi - lo;
        let least = THIN * spread.truncate().max_element();
        // The outer bins are half as wide.
        let scale = (bins - 1) as f32 / spread;
        let is_tried = scale.is_finite_mask() & spread.cmpge(Vec4::splat(least));
        Self { start: lo, scale: Vec4::select(is_tried, scale, Vec4::ZERO) }
    }

    /// The bin of a member along each axis, with [`WHOLE`] added; the fourth means nothing.
    #[inline(always)]
    fn of(&self, member: &Member) -> Vec4 {
        (member.center() - self.start) * self.scale + Vec4::splat(WHOLE)
    }
}

/// A plane between two bins.
struct Plane {
    binning: Binning,
    axis: usize,
    bin: usize,
}

impl Plane {
    /// On all axes, as one that is chosen at run time would be a jump.
    #[inline(always)]
    fn is_below(&self, member: &Member) -> bool {
        let last = Vec4::splat(self.bin as f32 + WHOLE);
        self.binning.of(member).cmple(last).bitmask() >> self.axis & 1 != 0
    }
}

#[derive(Clone, Copy)]
struct Bin {
    lo: Vec4,
    hi: Vec4,
    count: usize,
}

impl Bin {
    const EMPTY: Self = Self { lo: Vec4::MAX, hi: Vec4::MIN, count: 0 };

    #[inline(always)]
    fn merge(self, other: Self) -> Self {
        Self { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi), count: self.count + other.count }
    }

    #[inline(always)]
    fn cost(&self) -> f32 {
        let [x, y, z, _] = (self.hi - self.lo).to_array();
        (x * y + y * z + z * x) * self.count.div_ceil(WIDTH) as f32
    }
}

/// The cheapest plane that has members on both sides.
fn cheapest_plane<const N: usize, W: Weight>(members: &[Member], weight: &W) -> Option<Plane> {
    let binning = Binning::new(members, N);
    let mut bins = [[Bin::EMPTY; N]; 3];
    for member in members {
        let of = binning.of(member).to_array().map(|x| x.to_bits() as usize % N);
        let count = weight(member);
        for axis in 0..3 {
            if binning.scale[axis] > 0.0 {
                let bin = &mut bins[axis][of[axis]];
                *bin = bin.merge(Bin { lo: member.lo, hi: member.hi, count });
            }
        }
    }
    let mut best = (f32::INFINITY, 0, 0);
    for axis in 0..3 {
        // The outer bins are occupied, so no side is empty.
        if binning.scale[axis] > 0.0 {
            let mut above = Bin::EMPTY;
            let mut costs = [0.0; N];
            for i in (1..N).rev() {
                above = above.merge(bins[axis][i]);
                costs[i - 1] = above.cost();
            }
            let mut below = Bin::EMPTY;
            for i in 0..N - 1 {
                below = below.merge(bins[axis][i]);
                let cost = below.cost() + costs[i];
                if cost < best.0 {
                    best = (cost, axis, i);
                }
            }
        }
    }
    let (cost, axis, bin) = best;
    cost.is_finite().then_some(Plane { binning, axis, bin })
}

/// Moves what is below to the front and returns how many these are.
fn partition(members: &mut [Member], is_below: impl Fn(&Member) -> bool) -> usize {
    let mut count = 0;
    for i in 0..members.len() {
        let below = is_below(&members[i]);
        members.swap(i, count);
        count += usize::from(below);
    }
    count
}
