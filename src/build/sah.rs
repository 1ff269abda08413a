//! Splits of boxes by the surface area heuristic.
//!
//! Recursive binary splits at the cheapest of 16 planes an axis (I. Wald, "On fast Construction of
//! SAH-based Bounding Volume Hierarchies", 2007), where the cost of a side is its area times the number
//! of clusters that it fills, and all axes are taken at once. O(n log n), in parallel, in place.

use glam::{Mat4, Vec4};

use super::grid::WHOLE;
use crate::aabb::Aabb;
use crate::lanes::{Isa, Lanes, WIDTH, axes, dispatch};
use crate::parallel;

const BINS: usize = 16;
/// Axes along which the centres spread less than this, in parts of the widest spread, are not tried.
const THIN: f32 = 0.1;

/// How many triangles a member stands for.
pub(super) trait Weight: Fn(&Member) -> usize + Sync {}

impl<F: Fn(&Member) -> usize + Sync> Weight for F {}

/// The box and index of a triangle or of a group of them.
///
/// The lower corner and the negated upper one: the lesser values of two boxes are the box around both. The lanes
/// behind them hold the halves of the index as whole numbers: arithmetic on all lanes is one instruction, and
/// slow where one is subnormal.
#[derive(Clone, Copy)]
// No more, as allocators take longer for what they do not align anyhow.
#[repr(align(16))]
pub(super) struct Member([f32; WIDTH]);

impl Member {
    pub(super) fn new(index: u32, b: &Aabb) -> Self {
        let [x, y, z] = b.lo.to_array();
        let [u, v, w] = (-b.hi).to_array();
        Self([x, y, z, (index & 0xffff) as f32, u, v, w, (index >> 16) as f32])
    }

    pub(super) fn index(&self) -> u32 {
        self.0[3] as u32 | (self.0[7] as u32) << 16
    }

    #[inline(always)]
    fn center(&self) -> Vec4 {
        Vec4::from_slice(&self.0[..4]) * 0.5 - Vec4::from_slice(&self.0[4..]) * 0.5
    }
}

/// Splits until what is left weighs at most `most`, and marks the last of it in `ends`; halves where no
/// plane helps or planes have peeled off little by little.
pub(super) fn split<W: Weight>(isa: Isa, members: &mut [Member], ends: &mut [bool], weight: &W, most: usize) {
    dispatch!(isa, lanes => split_at(lanes, members, ends, weight, most, 0));
}

fn split_at<L: Lanes + Sync, W: Weight>(
    lanes: L,
    members: &mut [Member],
    ends: &mut [bool],
    weight: &W,
    most: usize,
    depth: u32,
) {
    const PARALLEL: usize = 512;
    if members.len() <= 1 || members.iter().map(weight).sum::<usize>() <= most {
        ends.last_mut().into_iter().for_each(|end| *end = true);
        return;
    }
    let middle = lanes.vectorize(
        #[inline(always)]
        || divided(lanes, members, weight, depth),
    );
    let serial = middle.min(members.len() - middle) < PARALLEL;
    let (below, above) = members.split_at_mut(middle);
    let (ends_below, ends_above) = ends.split_at_mut(middle);
    let mut first = || split_at(lanes, below, ends_below, weight, most, depth + 1);
    let mut second = || split_at(lanes, above, ends_above, weight, most, depth + 1);
    if serial {
        first();
        second();
    } else {
        parallel::join(first, second);
    }
}

/// Moves the members of one side to the front and returns how many these are.
#[inline(always)]
fn divided<L: Lanes, W: Weight>(lanes: L, members: &mut [Member], weight: &W, depth: u32) -> usize {
    const MAX_UNEVEN_DEPTH: u32 = 64;
    let plane = if members.len() < 4 * BINS {
        cheapest_plane::<8, L, W>(lanes, members, weight)
    } else {
        cheapest_plane::<BINS, L, W>(lanes, members, weight)
    };
    match plane {
        Some(plane) if depth < MAX_UNEVEN_DEPTH => partition(
            members,
            #[inline(always)]
            |member| plane.is_below(member),
        ),
        _ => half(members.len()),
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
    #[inline(always)]
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

/// The boxes around the members in each bin of each axis, and what these weigh by bin and axis.
struct Bins<const N: usize> {
    boxes: [[Member; N]; 3],
    weights: [[f32; 4]; N],
}

impl<const N: usize> Bins<N> {
    #[inline(always)]
    fn new<L: Lanes, W: Weight>(lanes: L, binning: &Binning, members: &[Member], weight: &W) -> Self {
        let mut bins = Self { boxes: [[Member([f32::MAX; WIDTH]); N]; 3], weights: [[0.0; 4]; N] };
        for member in members {
            let of = binning.of(member).to_array();
            let weight = weight(member) as f32;
            let member = lanes.load(&member.0);
            for axis in 0..3 {
                let bin = of[axis].to_bits() as usize % N;
                let Member(all) = &mut bins.boxes[axis][bin];
                *all = lanes.store(lanes.min(lanes.load(all), member));
                bins.weights[bin][axis] += weight;
            }
        }
        bins
    }
}

/// Bins that follow one another as one, by axis.
struct Side<L: Lanes> {
    boxes: [L::F32; 3],
    /// The fourth means nothing.
    weight: Vec4,
}

impl<L: Lanes> Side<L> {
    #[inline(always)]
    fn empty(lanes: L) -> Self {
        Self { boxes: [lanes.splat(f32::MAX); 3], weight: Vec4::ZERO }
    }

    #[inline(always)]
    fn add<const N: usize>(&mut self, lanes: L, bins: &Bins<N>, bin: usize) {
        for axis in 0..3 {
            self.boxes[axis] = lanes.min(self.boxes[axis], lanes.load(&bins.boxes[axis][bin].0));
        }
        self.weight += Vec4::from_array(bins.weights[bin]);
    }

    /// Half of the area times the number of clusters that the weight fills.
    #[inline(always)]
    fn costs(&self, lanes: L) -> Vec4 {
        // Negative all three, which their products are not.
        let [a, b, c] = axes(
            #[inline(always)]
            |axis| {
                let corners = lanes.store(self.boxes[axis]);
                Vec4::from_slice(&corners[..4]) + Vec4::from_slice(&corners[4..])
            },
        );
        let [x, y, z] = {
            let sides = Mat4::from_cols(a, b, c, c).transpose();
            [sides.x_axis, sides.y_axis, sides.z_axis]
        };
        const PART: f32 = 1.0 / WIDTH as f32;
        // Rounded up: what is added takes any part of a cluster beyond one half, and a full one not so far. Weights
        // from 2^24 on are rounded, which moves planes a little and changes no answer.
        let clusters = self.weight * PART + (0.5 - 0.5 * PART) + WHOLE - WHOLE;
        (x * y + y * z + z * x) * clusters
    }
}

/// The cheapest plane that has members on both sides.
#[inline(always)]
fn cheapest_plane<const N: usize, L: Lanes, W: Weight>(
    lanes: L,
    members: &[Member],
    weight: &W,
) -> Option<Plane> {
    let binning = Binning::new(members, N);
    let bins = Bins::<N>::new(lanes, &binning, members, weight);
    let mut above = Side::empty(lanes);
    let mut costs = [Vec4::ZERO; N];
    for bin in (1..N).rev() {
        above.add(lanes, &bins, bin);
        costs[bin - 1] = above.costs(lanes);
    }
    let mut below = Side::empty(lanes);
    let (mut least, mut last) = (Vec4::INFINITY, Vec4::ZERO);
    for bin in 0..N - 1 {
        below.add(lanes, &bins, bin);
        let cost = below.costs(lanes) + costs[bin];
        let is_less = cost.cmplt(least);
        least = Vec4::select(is_less, cost, least);
        last = Vec4::select(is_less, Vec4::splat(bin as f32), last);
    }
    let (mut best, mut plane) = (f32::INFINITY, None);
    for axis in 0..3 {
        // The outer bins of an axis that is tried are occupied, so no side is empty.
        if binning.scale[axis] > 0.0 && least[axis] < best {
            (best, plane) = (least[axis], Some((axis, last[axis] as usize)));
        }
    }
    let (axis, bin) = plane?;
    Some(Plane { binning, axis, bin })
}

/// Moves what is below to the front and returns how many these are.
#[inline(always)]
fn partition(members: &mut [Member], is_below: impl Fn(&Member) -> bool) -> usize {
    let mut count = 0;
    for i in 0..members.len() {
        let below = is_below(&members[i]);
        members.swap(i, count);
        count += usize::from(below);
    }
    count
}
