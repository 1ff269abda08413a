//! When a path comes to a t: its time, rounded so that no hit comes after it.

use crate::lanes::{greater, lesser};

/// Turns t into time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Clock {
    /// Time a unit of t.
    pub(super) speed: f64,
    /// The time of t = 0, rounded up.
    pub(super) zero: f64,
}

impl Clock {
    /// Bounds the rounding of the time of t = 0.
    pub(super) const SLACK: f64 = 1.0 / (1u64 << 50) as f64;

    /// Of a path that starts `delay` after the time of t = `start`.
    #[inline(always)]
    pub(super) fn new(speed: f64, start: f64, delay: f64) -> Self {
        let back = start * speed;
        Self { speed, zero: (back.abs() + delay) * Self::SLACK + LEAST * speed - (back + delay) }
    }

    /// A time no hit comes after whose distance rounds to `t` or less.
    #[inline(always)]
    fn time(self, t: f32) -> f64 {
        // Twice half a unit in the last place of t, so that rounding here is covered.
        self.later(t, 2.0 * HALF_ULP) + self.zero
    }

    /// The same in f32, later by a few ulps of its terms. Short, as the walk waits for it.
    #[inline(always)]
    pub(crate) fn rounded_time(self, t: f32) -> f32 {
        const MORE: f64 = 4.0 * HALF_ULP;
        (self.later(t, MORE) + (self.zero + (self.zero.abs() * MORE + 2.0 * LEAST))) as f32
    }

    /// The time from t = 0 to `t`, raised by `more` of itself.
    #[inline(always)]
    fn later(self, t: f32, more: f64) -> f64 {
        let t = f64::from(t);
        greater(t * (self.speed * (1.0 + more)), t * (self.speed * (1.0 - more)))
    }
}

/// The time after which a walk finds nothing more: that of the query's `t_max`, or when it leaves the grid.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limit {
    t_max: f32,
    end: f64,
    /// No hit that rounds to `t_max` or less comes later.
    pub(crate) time: f64,
}

impl Limit {
    /// `end` is when the path leaves the grid, or infinity.
    #[inline(always)]
    pub(crate) fn new(clock: Clock, end: f64, t_max: f32) -> Self {
        Self { t_max, end, time: lesser(clock.time(t_max), end) }
    }

    /// Follows `t_max`, and says whether it has changed.
    #[inline(always)]
    pub(crate) fn update(&mut self, clock: Clock, t_max: f32) -> bool {
        let changed = t_max != self.t_max;
        if changed {
            *self = Self::new(clock, self.end, t_max);
        }
        changed
    }
}

/// No less than the largest distance that rounds to `t`: hits count if their rounded distance is within.
#[inline(always)]
pub(super) fn rounds_to(t: f32) -> f64 {
    let t = f64::from(t);
    t + (t.abs() * HALF_ULP + LEAST)
}

/// Half a unit in the last place of an f32, relative to it, and half the least f32.
pub(super) const HALF_ULP: f64 = 1.0 / (1u64 << 24) as f64;
pub(super) const LEAST: f64 = 0.5 * f32::from_bits(1) as f64;
