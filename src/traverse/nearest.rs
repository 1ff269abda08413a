//! The closest hits of eight rays so far, of which some are still to be decided.
//!
//! Most hits are certain before they are decided, with t between two bounds
//! ([`Bounded::certain`](crate::filter::Bounded::certain)): enough to end the ray's interval there, and to see
//! which of two is closer. What is left at the end is decided eight rays at a time.

use glam::Vec3;

use crate::arena::Arena;
use crate::hit::Hit;
use crate::lanes::{Doubles, Lanes, WIDTH};
use crate::prepared::known8;
use crate::query::EdgeRule;
use crate::ray::Ray;
use crate::triangle::{Intersection, intersect};

/// A triangle of the arena.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Source {
    pub(crate) cluster: u32,
    pub(crate) lane: u32,
}

/// The closest hits, a ray a lane.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub(crate) struct Nearest {
    /// t or, where it is to be decided, its upper bound; at first the end of the interval.
    pub(crate) t: [f32; WIDTH],
    /// t or its lower bound.
    low: [f32; WIDTH],
    u: [f32; WIDTH],
    v: [f32; WIDTH],
    prim: [u32; WIDTH],
    /// Where the triangles of hits that are to be decided are; [`NONE`] of the others.
    cluster: [u32; WIDTH],
    slot: [u32; WIDTH],
}

/// No cluster.
const NONE: u32 = u32::MAX;

impl Nearest {
    /// Not started.
    pub(crate) const ZERO: Self = Self {
        t: [0.0; WIDTH],
        low: [0.0; WIDTH],
        u: [0.0; WIDTH],
        v: [0.0; WIDTH],
        prim: [0; WIDTH],
        cluster: [0; WIDTH],
        slot: [0; WIDTH],
    };

    /// Starts anew, with nothing beyond `t_max`.
    #[inline(always)]
    pub(crate) fn start(&mut self, lane: usize, t_max: f32) {
        (self.t[lane], self.low[lane]) = (t_max, t_max);
        (self.prim[lane], self.cluster[lane]) = (u32::MAX, NONE);
    }

    /// None yet, with nothing beyond `t_max`.
    #[inline(always)]
    pub(crate) fn up_to<L: Lanes>(lanes: L, t_max: L::F32) -> Self {
        let t = lanes.store(t_max);
        Self { t, low: t, prim: [u32::MAX; WIDTH], cluster: [NONE; WIDTH], ..Self::ZERO }
    }

    /// The hits, once they are decided.
    #[inline(always)]
    pub(crate) fn hits<L: Lanes>(&self, lanes: L) -> [Hit; WIDTH] {
        let hits = lanes.mask(self.found());
        let t = lanes.select(hits, lanes.load(&self.t), lanes.splat(Hit::MISS.t));
        let u = lanes.select(hits, lanes.load(&self.u), lanes.splat(Hit::MISS.u));
        let v = lanes.select(hits, lanes.load(&self.v), lanes.splat(Hit::MISS.v));
        let prim = lanes.load(bytemuck::cast_ref(&self.prim));
        let ([tv0, tv1], [up0, up1]) = (lanes.interleave(t, v), lanes.interleave(u, prim));
        let ([a, b], [c, d]) = (lanes.interleave(tv0, up0), lanes.interleave(tv1, up1));
        bytemuck::cast([lanes.store(a), lanes.store(b), lanes.store(c), lanes.store(d)])
    }

    /// The lanes with a hit, as bits.
    #[inline(always)]
    pub(crate) fn found(&self) -> u32 {
        (0..WIDTH).fold(0, |bits, lane| bits | u32::from(self.is_hit(lane)) << lane)
    }

    /// Whether there is a hit.
    #[inline(always)]
    pub(crate) fn is_hit(&self, lane: usize) -> bool {
        self.prim[lane] != u32::MAX
    }

    /// Whether there is a hit that is still to be decided.
    #[inline(always)]
    fn is_pending(&self, lane: usize) -> bool {
        self.cluster[lane] != NONE
    }

    /// Notes hits of one triangle of which nothing else is asked, which are certain, t below `high`. The lanes in
    /// which that was done, and those in which only a decision tells whether they are within the interval.
    #[inline(always)]
    pub(crate) fn note<L: Lanes>(&mut self, lanes: L, hits: u32, high: L::F32, prim: u32) -> [u32; 2] {
        let within = hits & lanes.bits(lanes.at_most(high, lanes.load(&self.t)));
        put_bits(lanes, within, &mut self.prim, prim);
        [within, hits & !within]
    }

    /// Takes hits of one triangle that are certain, t between `low` and `high`, where they are closer. The lanes in
    /// which that was done, and those in which only decisions tell.
    ///
    /// In all lanes at once: a vector is not loaded before single values stored to it have left the processor.
    #[inline(always)]
    pub(crate) fn defer<L: Lanes>(
        &mut self,
        lanes: L,
        hits: u32,
        [low, high]: [L::F32; 2],
        prim: u32,
        source: Source,
    ) -> [u32; 2] {
        let closer = hits & lanes.bits(lanes.less(high, lanes.load(&self.low)));
        let later = lanes.bits(lanes.less(lanes.load(&self.t), low));
        put(lanes, closer, &mut self.t, high);
        put(lanes, closer, &mut self.low, low);
        put_bits(lanes, closer, &mut self.prim, prim);
        put_bits(lanes, closer, &mut self.cluster, source.cluster);
        put_bits(lanes, closer, &mut self.slot, source.lane);
        [closer, hits & !closer & !later]
    }

    /// Takes a decided hit within the interval if it is the closest; whether it is.
    #[inline(always)]
    pub(crate) fn take(
        &mut self,
        arena: &Arena,
        ray: &Ray,
        lane: usize,
        at: Intersection,
        prim: u32,
    ) -> bool {
        if self.is_pending(lane) && at.t >= self.low[lane] {
            self.settle(arena, ray, lane);
        }
        let closer = (at.t, prim) < (self.t[lane], self.prim[lane]);
        if closer {
            self.set(lane, at);
            self.prim[lane] = prim;
        }
        closer
    }

    #[inline(always)]
    fn set(&mut self, lane: usize, at: Intersection) {
        (self.t[lane], self.low[lane], self.u[lane], self.v[lane]) = (at.t, at.t, at.u, at.v);
        self.cluster[lane] = NONE;
    }

    /// Decides one hit.
    #[cold]
    #[inline(never)]
    fn settle(&mut self, arena: &Arena, ray: &Ray, lane: usize) {
        let corners = arena.clusters[self.cluster[lane] as usize].triangle(self.slot[lane] as usize);
        let at = intersect(ray, corners, EdgeRule::Closed);
        debug_assert!(at.is_some(), "what is certain is a hit: {ray:?} {corners:?}");
        match at {
            Some(at) => self.set(lane, at),
            None => self.start(lane, f32::INFINITY),
        }
    }

    /// Decides all that is left; the rays by axis and lane.
    #[inline(always)]
    pub(crate) fn finish<L: Doubles>(
        &mut self,
        lanes: L,
        arena: &Arena,
        origin: &[[f32; WIDTH]; 3],
        dir: &[[f32; WIDTH]; 3],
    ) {
        let mut pending = 0u32;
        for lane in 0..WIDTH {
            pending |= u32::from(self.is_pending(lane)) << lane;
        }
        if pending == 0 {
            return;
        }
        let mut corners = [[[0.0; WIDTH]; 3]; 3];
        for lane in 0..WIDTH {
            // Any triangle where none is pending.
            let cluster = if pending >> lane & 1 != 0 { self.cluster[lane] } else { 0 };
            let triangle = arena.clusters[cluster as usize].triangle(self.slot[lane] as usize & (WIDTH - 1));
            for corner in 0..3 {
                for axis in 0..3 {
                    corners[corner][axis][lane] = triangle[corner][axis];
                }
            }
        }
        let width = lanes.load(&self.t) - lanes.load(&self.low);
        let hits = known8(lanes, origin, dir, &corners, width);
        let clear = hits.clear & pending;
        let [t, u, v] = [lanes.load(&hits.t), lanes.load(&hits.u), lanes.load(&hits.v)];
        put(lanes, clear, &mut self.t, t);
        put(lanes, clear, &mut self.low, t);
        put(lanes, clear, &mut self.u, u);
        put(lanes, clear, &mut self.v, v);
        put_bits(lanes, clear, &mut self.cluster, NONE);
        let mut left = pending & !clear;
        while left != 0 {
            let lane = left.trailing_zeros() as usize;
            left &= left - 1;
            self.settle(arena, &line(origin, dir, lane), lane);
        }
    }
}

/// Replaces the values of some lanes.
#[inline(always)]
fn put<L: Lanes>(lanes: L, bits: u32, to: &mut [f32; WIDTH], x: L::F32) {
    *to = lanes.store(lanes.select(lanes.mask(bits), x, lanes.load(to)));
}

/// Replaces the values of some lanes by one.
#[inline(always)]
fn put_bits<L: Lanes>(lanes: L, bits: u32, to: &mut [u32; WIDTH], x: u32) {
    put(lanes, bits, bytemuck::cast_mut(to), lanes.splat(f32::from_bits(x)));
}

/// One of eight rays, but for its interval.
#[inline(always)]
pub(crate) fn line(origin: &[[f32; WIDTH]; 3], dir: &[[f32; WIDTH]; 3], lane: usize) -> Ray {
    let at = |v: &[[f32; WIDTH]; 3]| Vec3::new(v[0][lane], v[1][lane], v[2][lane]);
    Ray::new(at(origin), at(dir))
}
