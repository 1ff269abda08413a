//! A group: up to 64 rays that go alike, as eight packets of eight.
//!
//! All rays of a group advance along one axis, its main axis, in the same direction, and none of them by
//! less than a third of what it moves along another axis. So each is a line u = at + slope * x, where x is the
//! place along the main axis and u that along one of the two others, in cells of the top grid: numbers
//! that don't grow beyond the grid's size S, whatever the ray's direction, and that are compared with voxels
//! and boxes as they are. A ray's interval is a range of x, its span.
//!
//! # Errors
//! A line is computed in f64 and rounded to f32, which misplaces it by less than 2^-21.5 S where it is in the
//! grid; evaluating it adds less than 2^-22 S. Voxels and boxes are built larger by four times that, see
//! [`BRICK_MARGIN`](crate::dda::BRICK_MARGIN). Spans are enlarged by [`SLACK`]. They end where their ray leaves the
//! box around the scene, which is enlarged by twice that: for what misplaces the line, and as much for rounding its
//! distance from the box's sides. What dividing by the slope rounds is below 2^-22 S where it matters.

use super::nearest::{Nearest, line};
use crate::arena::Grid;
use crate::filter::RayLanes;
use crate::lanes::{Doubles, Lanes, WIDTH, transpose};
use crate::ray::Ray;

/// The most rays of a group.
pub(crate) const GROUP: usize = 64;
/// Fewer rays are not worth a group.
pub(crate) const FEWEST: usize = 8;

/// The most packets of a group.
pub(crate) const PACKETS: usize = GROUP / WIDTH;

/// Slopes above this make no group.
const STEEPEST: f64 = 3.0;

/// Between 2 to the power of minus this and its inverse t is scaled without rounding: other hits are decided at once,
/// and directions whose largest component is below make no group.
pub(crate) const EXPONENT: i32 = 100;

/// Directions whose largest component is beyond 2 to the power of this make no group, nor those that cross 2^100 cells
/// a unit of t: half the least f32, by which t is rounded at least, stays small in units of the scaled direction, and
/// in cells.
const FASTEST: i32 = 40;

/// More than the rounding errors of a place along the main axis, in sizes S of the grid.
pub(crate) const SLACK: f64 = 1.0 / (1u64 << 20) as f64;

/// Slopes below this count as this, which moves a line in the grid by less than its place is rounded.
const LEVEL: f32 = 1.0 / (1u32 << 30) as f32;

/// The bound of [`RayLanes`] for scaled directions, whose largest component lies in [0.5, 1).
pub(crate) const SCALED: f32 = 16.0;

/// Eight rays, a lane each.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub(crate) struct Packet {
    pub(crate) origin: [[f32; WIDTH]; 3],
    pub(crate) dir: [[f32; WIDTH]; 3],
    /// Scaled by a power of two, so that the largest component lies in [0.5, 1), and the interval with it.
    pub(crate) scaled: [[f32; WIDTH]; 3],
    pub(crate) t_min: [f32; WIDTH],
    pub(crate) t_max: [f32; WIDTH],
    /// The open lower end of the interval.
    pub(crate) after: [f32; WIDTH],
    pub(crate) nearest: Nearest,
    /// The lines along the two other axes.
    pub(crate) at: [[f32; WIDTH]; 2],
    pub(crate) slope: [[f32; WIDTH]; 2],
    /// The span: least and greatest x. Empty where the ray is finished or missing.
    pub(crate) span: [[f32; WIDTH]; 2],
    /// x at t = 0, and x a unit of t.
    start: [f64; WIDTH],
    speed: [f64; WIDTH],
    /// Scaled t a unit of t, and its inverse.
    scale: [f32; WIDTH],
    pub(crate) unit: [f32; WIDTH],
}

impl Packet {
    /// Not loaded. Zero, which memory is filled with fast.
    pub(crate) const ZERO: Self = Self {
        origin: [[0.0; WIDTH]; 3],
        dir: [[0.0; WIDTH]; 3],
        scaled: [[0.0; WIDTH]; 3],
        t_min: [0.0; WIDTH],
        t_max: [0.0; WIDTH],
        after: [0.0; WIDTH],
        nearest: Nearest::ZERO,
        start: [0.0; WIDTH],
        speed: [0.0; WIDTH],
        scale: [0.0; WIDTH],
        unit: [0.0; WIDTH],
        at: [[0.0; WIDTH]; 2],
        slope: [[0.0; WIDTH]; 2],
        span: [[0.0; WIDTH]; 2],
    };

    /// As the filter of triangles takes them.
    #[inline(always)]
    pub(crate) fn lanes<L: Lanes>(&self, lanes: L) -> RayLanes<L> {
        let three = |v: &[[f32; WIDTH]; 3]| [lanes.load(&v[0]), lanes.load(&v[1]), lanes.load(&v[2])];
        RayLanes {
            origin: three(&self.origin),
            dir: three(&self.scaled),
            bound: lanes.splat(SCALED),
            t_min: lanes.load(&self.t_min),
            t_max: lanes.load(&self.t_max),
        }
    }
}

/// The rays.
pub(crate) struct Group<'a> {
    /// Room for them.
    pub(crate) packets: &'a mut [Packet],
    pub(crate) len: usize,
    /// The main axis, and the two others.
    pub(crate) main: usize,
    pub(crate) others: [usize; 2],
    /// Whether x rises along the rays.
    pub(crate) rises: bool,
    pub(crate) slack: f32,
}

impl<'a> Group<'a> {
    /// With room for the rays of up to eight packets.
    pub(crate) fn new(packets: &'a mut [Packet]) -> Self {
        Self { packets, len: 0, main: 0, others: [1, 2], rises: true, slack: 0.0 }
    }

    /// The packets in use.
    #[inline(always)]
    pub(crate) fn packets(&self) -> usize {
        self.len.div_ceil(WIDTH)
    }

    /// One of the rays, but for its interval.
    #[inline(always)]
    pub(crate) fn line(&self, packet: usize, lane: usize) -> Ray {
        line(&self.packets[packet].origin, &self.packets[packet].dir, lane)
    }

    /// Takes one ray or more, and finds their lines and spans; false where they don't go alike, or one is not valid.
    #[inline(always)]
    pub(crate) fn load<L: Doubles>(&mut self, lanes: L, grid: &Grid, rays: &[Ray]) -> bool {
        self.len = rays.len();
        let first = rays[0].dir;
        let size = first.abs();
        self.main = if size.x >= size.y && size.x >= size.z {
            0
        } else if size.y >= size.z {
            1
        } else {
            2
        };
        self.others = [(self.main + 1) % 3, (self.main + 2) % 3];
        self.rises = first[self.main] > 0.0;
        self.slack = (SLACK * f64::from(grid.longest())) as f32;
        for (packet, rays) in rays.chunks(WIDTH).enumerate() {
            self.packets[packet].load(lanes, rays);
            if !self.packet(lanes, grid, packet) {
                return false;
            }
        }
        true
    }

    #[inline(always)]
    fn packet<L: Doubles>(&mut self, lanes: L, grid: &Grid, packet: usize) -> bool {
        const NEAR: f64 = 256.0;
        let (main, others) = (self.main, self.others);
        let first = packet * WIDTH;
        let out = &mut self.packets[packet];
        let cells = lanes.splat8(1.0 / grid.cell);
        let near = |axis: usize| lanes.splat8(NEAR * f64::from(grid.dims[axis]));
        let x = (widened(lanes, &out.origin[main]) - lanes.splat8(grid.lo[main])) * cells;
        let d = widened(lanes, &out.dir[main]);
        let inverse = lanes.splat8(1.0) / d;
        let speed = d * cells;
        let ahead =
            if self.rises { lanes.less8(lanes.splat8(0.0), d) } else { lanes.less8(d, lanes.splat8(0.0)) };
        let most = lanes.splat(f32::MAX);
        let finite = |x: &[f32; WIDTH]| lanes.at_most(lanes.abs(lanes.load(x)), most);
        let valid = finite(&out.origin[0])
            & finite(&out.origin[1])
            & finite(&out.origin[2])
            & finite(&out.dir[0])
            & finite(&out.dir[1])
            & finite(&out.dir[2])
            & lanes.less(lanes.load(&out.after), lanes.load(&out.nearest.t));
        let mut fit = ahead & lanes.bits(valid) & lanes.at_most8(lanes.abs8(x), near(main));
        let slack = lanes.splat(self.slack);
        let (mut enter, mut leave) = (lanes.splat(-1.0), lanes.splat(grid.dims[main] as f32 + 1.0));
        for side in 0..2 {
            let axis = others[side];
            let u = (widened(lanes, &out.origin[axis]) - lanes.splat8(grid.lo[axis])) * cells;
            let slope = widened(lanes, &out.dir[axis]) * inverse;
            let (at, line) = (lanes.narrow(u - slope * x), lanes.narrow(slope));
            (out.slope[side], out.at[side]) = (lanes.store(line), lanes.store(at));
            let begin = (grid.axes.near[axis] * grid.axes.per_length) as f32;
            let [low, high] = [begin - 2.0 * self.slack, grid.dims[axis] as f32 - begin + 2.0 * self.slack];
            let [from, to] = between(lanes, at, line, [low, high]);
            (enter, leave) = (lanes.max(enter, from - slack), lanes.min(leave, to + slack));
            fit &= lanes.at_most8(lanes.abs8(slope), lanes.splat8(STEEPEST))
                & lanes.at_most8(lanes.abs8(u), near(axis));
        }
        let from = lanes.narrow(x + widened(lanes, &out.after) * speed);
        let to = lanes.narrow(reach(lanes, x, widened(lanes, &out.nearest.t) * speed, self.rises));
        let (low, high) = if self.rises { (from, to) } else { (to, from) };
        out.span[0] = lanes.store(lanes.max(low - slack, enter));
        out.span[1] = lanes.store(lanes.min(high + slack, leave));
        for lane in self.len.saturating_sub(first).min(WIDTH)..WIDTH {
            out.span[0][lane] = f32::INFINITY;
            out.span[1][lane] = f32::NEG_INFINITY;
        }
        out.start = lanes.store8(x);
        out.speed = lanes.store8(speed);
        let load = |x: &[f32; WIDTH]| lanes.abs(lanes.load(x));
        let largest = lanes.max(lanes.max(load(&out.dir[0]), load(&out.dir[1])), load(&out.dir[2]));
        let fastest = 2f64.powi(FASTEST).min(2f64.powi(100) * grid.cell) as f32;
        let (short, long) = (lanes.splat(2f32.powi(-EXPONENT)), lanes.splat(fastest));
        fit &= lanes.bits(lanes.less(short, largest) & lanes.less(largest, long));
        let largest = lanes.store(largest);
        for lane in 0..WIDTH {
            // 2^e and 2^-e, where the largest component is in [2^(e - 1), 2^e); anything where it does not fit.
            let exponent = largest[lane].to_bits() >> 23;
            out.scale[lane] = f32::from_bits((exponent + 1) << 23);
            out.unit[lane] = f32::from_bits(253u32.wrapping_sub(exponent) << 23);
        }
        let unit = lanes.load(&out.unit);
        for axis in 0..3 {
            out.scaled[axis] = lanes.store(lanes.load(&out.dir[axis]) * unit);
        }
        let scale = widened(lanes, &out.scale);
        let t_min = -above(lanes, lanes.splat8(0.0) - widened(lanes, &out.after) * scale);
        // Zero is exact, and what is added to it would be subnormal: slow to multiply by, for each triangle.
        let zero = lanes.splat(0.0);
        let starts = lanes.at_most(lanes.abs(lanes.load(&out.after)), zero);
        out.t_min = lanes.store(lanes.select(starts, zero, t_min));
        out.t_max = lanes.store(above(lanes, widened(lanes, &out.nearest.t) * scale));
        fit == 0xff
    }
}

impl Packet {
    /// Takes up to eight rays, and has the last one again where they are fewer.
    #[inline(always)]
    fn load<L: Lanes>(&mut self, lanes: L, rays: &[Ray]) {
        let ray = |i: usize| lanes.load(bytemuck::cast_ref(&rays[i.min(rays.len() - 1)]));
        let rows = [ray(0), ray(1), ray(2), ray(3), ray(4), ray(5), ray(6), ray(7)];
        let [x, y, z, t_min, dx, dy, dz, t_max] = transpose(lanes, rows);
        self.origin = [lanes.store(x), lanes.store(y), lanes.store(z)];
        self.dir = [lanes.store(dx), lanes.store(dy), lanes.store(dz)];
        self.after = lanes.store(t_min);
        self.nearest = Nearest::up_to(lanes, t_max);
    }

    /// Rays with a hit are done.
    #[inline(always)]
    pub(crate) fn finish<L: Lanes>(&mut self, lanes: L) {
        let hits = lanes.mask(self.nearest.found());
        let low = lanes.select(hits, lanes.splat(f32::INFINITY), lanes.load(&self.span[0]));
        self.span[0] = lanes.store(low);
    }

    /// Nothing beyond the closest hits counts.
    #[inline(always)]
    pub(crate) fn shorten<L: Doubles>(&mut self, lanes: L, rises: bool, slack: f32) {
        let t = widened(lanes, &self.nearest.t);
        let way = t * lanes.load8(&self.speed);
        let x = lanes.narrow(reach(lanes, lanes.load8(&self.start), way, rises));
        if rises {
            let x = lanes.min(lanes.load(&self.span[1]), x + lanes.splat(slack));
            self.span[1] = lanes.store(x);
        } else {
            let x = lanes.max(lanes.load(&self.span[0]), x - lanes.splat(slack));
            self.span[0] = lanes.store(x);
        }
        self.t_max = lanes.store(above(lanes, t * widened(lanes, &self.scale)));
    }
}

/// The x between which lines at + slope * x are between two places.
#[inline(always)]
fn between<L: Lanes>(lanes: L, at: L::F32, slope: L::F32, [low, high]: [f32; 2]) -> [L::F32; 2] {
    let level = lanes.less(lanes.abs(slope), lanes.splat(LEVEL));
    let inverse = lanes.splat(1.0) / lanes.select(level, lanes.splat(LEVEL), slope);
    let (a, b) = ((lanes.splat(low) - at) * inverse, (lanes.splat(high) - at) * inverse);
    [lanes.min(a, b), lanes.max(a, b)]
}

#[inline(always)]
fn widened<L: Doubles>(lanes: L, x: &[f32; WIDTH]) -> L::F64x8 {
    lanes.widen(lanes.load(x))
}

/// Where a ray ends that goes that way along the main axis, in proportion to a t of which half a unit in the
/// last place counts too.
#[inline(always)]
fn reach<L: Doubles>(lanes: L, start: L::F64x8, way: L::F64x8, rises: bool) -> L::F64x8 {
    let more = lanes.abs8(way) * lanes.splat8(HALF_ULP);
    start + (if rises { way + more } else { way - more })
}

/// More than half a unit in the last place of an f32, relative to it.
const HALF_ULP: f64 = 1.0 / (1u64 << 23) as f64;

/// No less than `x`, in units of scaled directions, nor than what rounds to it as a t, and an ulp or two and 2^-109 more
/// at most; finite where `x` is below the largest f32.
#[inline(always)]
fn above<L: Doubles>(lanes: L, x: L::F64x8) -> L::F32 {
    const ULP: f64 = f32::EPSILON as f64;
    const LEAST: f64 = f32::from_bits(1) as f64 * (1u64 << FASTEST) as f64;
    lanes.narrow(x + (lanes.abs8(x) * lanes.splat8(ULP) + lanes.splat8(LEAST)))
}
