//! The closest hits of eight rays so far, of which some are still to be decided.
//!
//! Most hits are certain before they are decided, with t between two bounds
//! ([`Bounded::certain`](crate::filter::Bounded::certain)): enough to end the ray's interval there, and to see
//! which of two is closer. What is left at the end is decided eight rays at a time.

use glam::Vec3;

use crate::arena::Arena;
use crate::hit::Hit;
use crate::lanes::{Doubles, WIDTH};
use crate::prepared::{Hits, known8};
use crate::query::EdgeRule;
use crate::ray::Ray;
use crate::triangle::{Intersection, intersect};

/// A triangle of the arena.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Source {
    pub(crate) cluster: u32,
    pub(crate) lane: u32,
}

impl Source {
    const NONE: Self = Self { cluster: u32::MAX, lane: 0 };
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
    source: [Source; WIDTH],
}

impl Nearest {
    /// Not started.
    pub(crate) const ZERO: Self = Self {
        t: [0.0; WIDTH],
        low: [0.0; WIDTH],
        u: [0.0; WIDTH],
        v: [0.0; WIDTH],
        prim: [0; WIDTH],
        source: [Source { cluster: 0, lane: 0 }; WIDTH],
    };

    /// Starts anew, with nothing beyond `t_max`.
    #[inline(always)]
    pub(crate) fn start(&mut self, lane: usize, t_max: f32) {
        (self.t[lane], self.low[lane]) = (t_max, t_max);
        (self.prim[lane], self.source[lane]) = (u32::MAX, Source::NONE);
    }

    /// The hit, once it is decided.
    #[inline(always)]
    pub(crate) fn hit(&self, lane: usize) -> Hit {
        match self.prim[lane] {
            u32::MAX => Hit::MISS,
            prim => Hit { t: self.t[lane], u: self.u[lane], v: self.v[lane], prim },
        }
    }

    /// Whether there is a hit.
    #[inline(always)]
    pub(crate) fn is_hit(&self, lane: usize) -> bool {
        self.prim[lane] != u32::MAX
    }

    /// Whether there is a hit that is still to be decided.
    #[inline(always)]
    fn is_pending(&self, lane: usize) -> bool {
        self.source[lane].cluster != u32::MAX
    }

    /// Notes a hit of which nothing else is asked, which is certain, t between two bounds. `None` where only a
    /// decision tells whether it is within the interval.
    #[inline(always)]
    pub(crate) fn note(&mut self, lane: usize, [_, high]: [f32; 2], prim: u32) -> Option<bool> {
        let within = high <= self.t[lane];
        if within {
            self.prim[lane] = prim;
        }
        within.then_some(true)
    }

    /// Takes a hit that is certain, t between `low` and `high`, if it is closer. `None` where only decisions tell
    /// which one is; else whether it was taken.
    #[inline(always)]
    pub(crate) fn defer(
        &mut self,
        lane: usize,
        [low, high]: [f32; 2],
        prim: u32,
        source: Source,
    ) -> Option<bool> {
        let closer = high < self.low[lane];
        if closer {
            (self.t[lane], self.low[lane]) = (high, low);
            (self.prim[lane], self.source[lane]) = (prim, source);
        }
        (closer || low > self.t[lane]).then_some(closer)
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
        self.source[lane] = Source::NONE;
    }

    /// Decides one hit.
    #[cold]
    #[inline(never)]
    fn settle(&mut self, arena: &Arena, ray: &Ray, lane: usize) {
        let Source { cluster, lane: slot } = self.source[lane];
        let corners = arena.clusters[cluster as usize].triangle(slot as usize);
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
        let mut left = 0u32;
        let mut corners = [[[0.0; WIDTH]; 3]; 3];
        let mut width = [0.0; WIDTH];
        for lane in 0..WIDTH {
            if self.is_pending(lane) {
                let Source { cluster, lane: slot } = self.source[lane];
                left |= 1 << lane;
                width[lane] = self.t[lane] - self.low[lane];
                let triangle = arena.clusters[cluster as usize].triangle(slot as usize);
                for corner in 0..3 {
                    for axis in 0..3 {
                        corners[corner][axis][lane] = triangle[corner][axis];
                    }
                }
            }
        }
        if left == 0 {
            return;
        }
        let hits: Hits = known8(lanes, origin, dir, &corners, &width);
        while left != 0 {
            let lane = left.trailing_zeros() as usize;
            left &= left - 1;
            if hits.clear >> lane & 1 != 0 {
                self.set(lane, hits.at(lane));
            } else {
                self.settle(arena, &line(origin, dir, lane), lane);
            }
        }
    }
}

/// One of eight rays, but for its interval.
#[inline(always)]
pub(crate) fn line(origin: &[[f32; WIDTH]; 3], dir: &[[f32; WIDTH]; 3], lane: usize) -> Ray {
    let at = |v: &[[f32; WIDTH]; 3]| Vec3::new(v[0][lane], v[1][lane], v[2][lane]);
    Ray::new(at(origin), at(dir))
}
