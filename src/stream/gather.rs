//! Finding rays that go alike in a stream of any order.
//!
//! Eight groups are open at a time, a lane each, and every ray joins one whose first ray starts near it and
//! points nearly alike; where there is none it opens a group in place of the one opened longest ago. So rays of
//! a camera come together as they follow one another, and rays to several lights in turn are sorted by
//! light. A ray takes some 30 operations; where groups stay small, the next rays are not looked at.

use glam::Vec3;

use crate::lanes::{Lanes, WIDTH};
use crate::ray::Ray;
use crate::traverse::GROUP;

/// How far the directions of a group may be from the first, the largest component being 1.
const SPREAD: f32 = 0.1;

/// How far the origins of a group may be from the first, in sizes of the scene.
const REACH: f32 = 1.0 / 16.0;

/// The groups that are open.
pub(super) struct Gather {
    /// What a difference of 1 in these is too much: directions, origins.
    keys: [[f32; WIDTH]; 6],
    pub(super) rays: [[u32; GROUP]; WIDTH],
    pub(super) len: [usize; WIDTH],
    oldest: usize,
    /// An origin's unit.
    scale: f32,
}

impl Gather {
    /// None open, in a scene of this size.
    pub(super) fn new(size: f64) -> Self {
        let scale = (1.0 / (size * f64::from(REACH))) as f32;
        Self {
            keys: [[f32::INFINITY; WIDTH]; 6],
            rays: [[0; GROUP]; WIDTH],
            len: [0; WIDTH],
            oldest: 0,
            scale: scale.min(f32::MAX),
        }
    }

    /// The group that a ray may join; none where that is full, or there is none.
    #[inline(always)]
    pub(super) fn find<L: Lanes>(&self, lanes: L, ray: &Ray) -> Option<usize> {
        let key = self.key(ray);
        let mut apart = lanes.splat(0.0);
        for i in 0..key.len() {
            apart = lanes.max(apart, lanes.abs(lanes.load(&self.keys[i]) - lanes.splat(key[i])));
        }
        let near = lanes.bits(lanes.less(apart, lanes.splat(1.0)));
        (near != 0).then(|| near.trailing_zeros() as usize)
    }

    /// The group to be closed in favour of another.
    #[inline(always)]
    pub(super) fn oldest(&mut self) -> usize {
        self.oldest = (self.oldest + 1) % WIDTH;
        self.oldest
    }

    /// Opens a group, closed before, for this ray.
    #[inline(always)]
    pub(super) fn open(&mut self, group: usize, ray: &Ray) {
        let key = self.key(ray);
        for i in 0..key.len() {
            self.keys[i][group] = key[i];
        }
    }

    /// Adds a ray to a group; whether it is full now.
    #[inline(always)]
    pub(super) fn add(&mut self, group: usize, ray: u32) -> bool {
        self.rays[group][self.len[group]] = ray;
        self.len[group] += 1;
        self.len[group] == GROUP
    }

    #[inline(always)]
    fn key(&self, ray: &Ray) -> [f32; 6] {
        let size = ray.dir.abs();
        let dir = ray.dir * (1.0 / (SPREAD * size.x.max(size.y).max(size.z)));
        let origin: Vec3 = ray.origin * self.scale;
        [dir.x, dir.y, dir.z, origin.x, origin.y, origin.z]
    }
}
