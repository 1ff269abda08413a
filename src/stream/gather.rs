//! Finding rays that go alike in a stream of any order.
//!
//! Sixteen groups are open at a time, and every ray joins one whose first ray starts near it and points nearly alike;
//! where there is none it opens a group in place of the one opened longest ago. So rays of a camera come together as
//! they follow one another, and rays to several lights in turn are sorted by light: the group that a ray joins is
//! likely the one that was joined last time after the ray before it. Where groups stay small, the next rays are not
//! looked at.

use crate::lanes::{Lanes, WIDTH, greater};
use crate::ray::Ray;
use crate::traverse::GROUP;

/// How far the directions of a group may be from the first, the largest component being 1.
const SPREAD: f32 = 1.0 / 6.0;

/// How far the origins of a group may be from the first, in sizes of the scene.
const REACH: f32 = 1.0 / 24.0;

/// Groups that are open at a time.
pub(super) const OPEN: usize = 16;

/// The lanes of a ray that are its origin, and those that are its direction.
const ORIGIN: [f32; WIDTH] = [1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0];
const DIRECTION: [f32; WIDTH] = [0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 0.0];

/// The groups that are open.
pub(super) struct Gather {
    /// The first rays: a difference of 1 is too much.
    keys: [[f32; WIDTH]; OPEN],
    pub(super) rays: [[u32; GROUP]; OPEN],
    pub(super) len: [usize; OPEN],
    /// The one that was joined after each.
    next: [usize; OPEN],
    /// The one that was joined last.
    last: usize,
    oldest: usize,
    /// Units of a ray's lanes.
    scale: [f32; WIDTH],
}

impl Gather {
    /// None open, in a scene of this size.
    pub(super) fn new(size: f64) -> Self {
        let origin = ((1.0 / (size * f64::from(REACH))) as f32).min(f32::MAX);
        Self {
            keys: [[f32::INFINITY; WIDTH]; OPEN],
            rays: [[0; GROUP]; OPEN],
            len: [0; OPEN],
            next: [0; OPEN],
            last: 0,
            oldest: 0,
            scale: std::array::from_fn(|lane| ORIGIN[lane] * origin + DIRECTION[lane] / SPREAD),
        }
    }

    /// The group that a ray may join, which counts as joined; none where there is none.
    #[inline(always)]
    pub(super) fn find<L: Lanes>(&mut self, lanes: L, ray: &Ray) -> Option<usize> {
        let [at, unit] = self.place(lanes, ray);
        let near = |group: usize| {
            let apart = lanes.abs(at - lanes.load(&self.keys[group]) * unit);
            const LANES: u32 = 0x77;
            lanes.bits(lanes.less(apart, unit)) & LANES == LANES
        };
        let likely = self.next[self.last];
        if near(likely) {
            self.last = likely;
            return Some(likely);
        }
        let group = (0..OPEN).find(|&group| near(group))?;
        self.join(group);
        Some(group)
    }

    /// The group to be closed in favour of another.
    #[inline(always)]
    pub(super) fn oldest(&mut self) -> usize {
        self.oldest = (self.oldest + 1) % OPEN;
        self.oldest
    }

    /// Opens a group, closed before, for this ray, which joins it.
    #[inline(always)]
    pub(super) fn open<L: Lanes>(&mut self, lanes: L, group: usize, ray: &Ray) {
        let [at, unit] = self.place(lanes, ray);
        self.keys[group] = lanes.store(at / unit);
        self.join(group);
    }

    #[inline(always)]
    fn join(&mut self, group: usize) {
        self.next[self.last] = group;
        self.last = group;
    }

    /// Adds a ray to a group; whether it is full now.
    #[inline(always)]
    pub(super) fn add(&mut self, group: usize, ray: u32) -> bool {
        self.rays[group][self.len[group]] = ray;
        self.len[group] += 1;
        self.len[group] == GROUP
    }

    /// A ray's lanes, and what of them a group may span.
    #[inline(always)]
    fn place<L: Lanes>(&self, lanes: L, ray: &Ray) -> [L::F32; 2] {
        let [x, y, z] = ray.dir.abs().to_array();
        let size = greater(greater(x, y), z);
        let unit = lanes.mul_add(lanes.splat(size), lanes.load(&DIRECTION), lanes.load(&ORIGIN));
        [lanes.load(bytemuck::cast_ref(ray)) * lanes.load(&self.scale), unit]
    }
}
