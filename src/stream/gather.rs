//! Finding rays that go alike in a stream of any order.
//!
//! Sixteen groups are open at a time, a lane each, and every ray joins one whose first ray starts near it and points
//! nearly alike; where there is none it opens a group in place of the one opened longest ago. So rays of a camera come
//! together as they follow one another, and rays to several lights in turn are sorted by light. Where groups stay
//! small, the next rays are not looked at.

use crate::lanes::{Lanes, WIDTH, greater};
use crate::ray::Ray;
use crate::traverse::GROUP;

/// How far the directions of a group may be from the first, the largest component being 1.
const SPREAD: f32 = 1.0 / 6.0;

/// How far the origins of a group may be from the first, in sizes of the scene.
const REACH: f32 = 1.0 / 24.0;

/// Groups that are open at a time.
pub(super) const OPEN: usize = 16;

/// The groups that are open.
pub(super) struct Gather {
    /// The first rays: origins, and directions whose largest component is 1.
    origins: [[[f32; WIDTH]; 3]; OPEN / WIDTH],
    dirs: [[[f32; WIDTH]; 3]; OPEN / WIDTH],
    pub(super) rays: [[u32; GROUP]; OPEN],
    pub(super) len: [usize; OPEN],
    oldest: usize,
    /// How far origins may be apart.
    reach: f32,
}

impl Gather {
    /// None open, in a scene of this size.
    pub(super) fn new(size: f64) -> Self {
        Self {
            origins: [[[f32::INFINITY; WIDTH]; 3]; OPEN / WIDTH],
            dirs: [[[0.0; WIDTH]; 3]; OPEN / WIDTH],
            rays: [[0; GROUP]; OPEN],
            len: [0; OPEN],
            oldest: 0,
            reach: (size * f64::from(REACH)) as f32,
        }
    }

    /// The group that a ray may join; none where there is none.
    #[inline(always)]
    pub(super) fn find<L: Lanes>(&self, lanes: L, ray: &Ray) -> Option<usize> {
        let size = lanes.splat(size(ray));
        let (reach, spread) = (lanes.splat(self.reach), lanes.splat(SPREAD) * size);
        let mut near = 0;
        for eight in 0..OPEN / WIDTH {
            let (origins, dirs) = (&self.origins[eight], &self.dirs[eight]);
            let away = |axis: usize| lanes.abs(lanes.splat(ray.origin[axis]) - lanes.load(&origins[axis]));
            let turned = |axis: usize| {
                lanes.abs(lanes.mul_add(lanes.load(&dirs[axis]), -size, lanes.splat(ray.dir[axis])))
            };
            let away = lanes.max(lanes.max(away(0), away(1)), away(2));
            let turned = lanes.max(lanes.max(turned(0), turned(1)), turned(2));
            near |= lanes.bits(lanes.less(away, reach) & lanes.less(turned, spread)) << (WIDTH * eight);
        }
        (near != 0).then(|| near.trailing_zeros() as usize)
    }

    /// The group to be closed in favour of another.
    #[inline(always)]
    pub(super) fn oldest(&mut self) -> usize {
        self.oldest = (self.oldest + 1) % OPEN;
        self.oldest
    }

    /// Opens a group, closed before, for this ray.
    #[inline(always)]
    pub(super) fn open(&mut self, group: usize, ray: &Ray) {
        let (eight, lane, size) = (group / WIDTH, group % WIDTH, size(ray));
        for axis in 0..3 {
            self.origins[eight][axis][lane] = ray.origin[axis];
            self.dirs[eight][axis][lane] = ray.dir[axis] / size;
        }
    }

    /// Adds a ray to a group; whether it is full now.
    #[inline(always)]
    pub(super) fn add(&mut self, group: usize, ray: u32) -> bool {
        self.rays[group][self.len[group]] = ray;
        self.len[group] += 1;
        self.len[group] == GROUP
    }
}

/// The largest component of a ray's direction.
#[inline(always)]
fn size(ray: &Ray) -> f32 {
    let [x, y, z] = ray.dir.abs().to_array();
    greater(greater(x, y), z)
}
