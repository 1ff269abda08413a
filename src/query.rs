//! What a query wants to know: the closest hit, any hit, or all of them.
//!
//! A structure walks the voxels along the ray and offers every hit it finds to a [`Query`], which
//! narrows the interval or ends the walk. Each structure's traversal is written once for all of them.

use std::collections::HashSet;
use std::ops::ControlFlow;

use crate::hit::Hit;

/// Which triangles a ray through an edge or a vertex meets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EdgeRule {
    /// A triangle is closed: its edges and vertices belong to it.
    Closed,
    /// A ray that meets an edge or a vertex exactly is moved aside by an infinitesimal step, the
    /// same for every triangle, so that it crosses a surface once where triangles join and meets a
    /// closed mesh an even number of times.
    Crossing,
}

/// Which hits a query has to be offered.
///
/// A query of one's own gets all of them unless it says that it needs less:
///
/// ```
/// use octogrid::{EdgeRule, Hit, Query, Ray, Scene, Wanted, builtin};
/// use std::ops::ControlFlow;
/// /// Looks through one triangle.
/// struct Without(u32, Hit);
/// impl Query for Without {
///     const RULE: EdgeRule = EdgeRule::Closed;
///     const WANTED: Wanted = Wanted::All;
///     fn t_max(&self) -> f32 {
///         self.1.t
///     }
///     fn accept(&mut self, hit: Hit) -> ControlFlow<()> {
///         if hit.prim != self.0 && hit.precedes(&self.1) {
///             self.1 = hit;
///         }
///         ControlFlow::Continue(())
///     }
/// }
/// let scene = Scene::build(&builtin::cube().mesh()?, &Default::default())?;
/// let ray = Ray::new([0.1, 0.2, 9.0], [0.0, 0.0, -1.0]);
/// let front = scene.closest(&ray);
/// let mut query = Without(front.prim, Hit::MISS);
/// scene.query(&ray, &mut query);
/// assert!(query.1.t > front.t && query.1.is_hit());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wanted {
    /// All within the interval.
    All,
    /// The closest one; of the others any number, in any order. Not for a query that refuses hits.
    Closest,
    /// One, if there is any. Its t, u and v are not specified, and it ends the walk.
    Any,
}

/// A sink for hits that steers the traversal.
///
/// A triangle that lies in several voxels may be offered several times, with the same bits.
/// The `on_*` functions do nothing unless a decorator such as [`Counting`] overrides them.
pub trait Query {
    /// Which triangles a ray through an edge or vertex meets.
    const RULE: EdgeRule;

    /// Which hits it has to be offered: the less, the faster.
    const WANTED: Wanted = Wanted::All;

    /// Hits beyond this t are of no use (closed end). May only fall during the walk.
    fn t_max(&self) -> f32;

    /// Takes a hit, with t in (`ray.t_min`, [`Query::t_max`]]. `Break` ends the walk.
    fn accept(&mut self, hit: Hit) -> ControlFlow<()>;

    /// The walk enters a voxel, empty or not.
    fn on_voxel(&mut self) {}

    /// The walk tests a cluster of triangles.
    fn on_cluster(&mut self) {}

    /// The walk reads `data`.
    fn on_read<T>(&mut self, _data: &T) {}
}

/// The closest hit: the least (t, triangle index).
#[derive(Clone, Copy, Debug)]
pub struct Closest {
    hit: Hit,
    t_max: f32,
}

impl Closest {
    /// Nothing found yet up to `t_max` (closed).
    pub fn new(t_max: f32) -> Self {
        Self { hit: Hit::MISS, t_max }
    }

    /// The closest hit offered so far, or [`Hit::MISS`].
    pub fn hit(&self) -> Hit {
        self.hit
    }
}

impl Query for Closest {
    const RULE: EdgeRule = EdgeRule::Closed;
    const WANTED: Wanted = Wanted::Closest;

    #[inline(always)]
    fn t_max(&self) -> f32 {
        self.t_max
    }

    #[inline(always)]
    fn accept(&mut self, hit: Hit) -> ControlFlow<()> {
        if hit.precedes(&self.hit) {
            // As one vector, as which it is read: a load waits until separate stores have left the processor.
            let Hit { t, u, v, prim } = hit;
            self.hit = bytemuck::cast(glam::Vec4::new(t, u, v, f32::from_bits(prim)));
            self.t_max = t;
        }
        ControlFlow::Continue(())
    }
}

/// Whether there is any hit.
#[derive(Clone, Copy, Debug)]
pub struct Any {
    found: bool,
    t_max: f32,
}

impl Any {
    /// Nothing found yet up to `t_max` (closed).
    pub fn new(t_max: f32) -> Self {
        Self { found: false, t_max }
    }

    /// Whether a hit was offered.
    pub fn found(&self) -> bool {
        self.found
    }
}

impl Query for Any {
    const RULE: EdgeRule = EdgeRule::Closed;
    const WANTED: Wanted = Wanted::Any;

    #[inline(always)]
    fn t_max(&self) -> f32 {
        self.t_max
    }

    #[inline(always)]
    fn accept(&mut self, _: Hit) -> ControlFlow<()> {
        self.found = true;
        ControlFlow::Break(())
    }
}

/// All hits, each triangle once, sorted by (t, triangle index), in the caller's buffer.
///
/// Where there are more hits than the buffer holds, it keeps the first ones along the ray and
/// [`All::is_complete`] is false.
#[derive(Debug)]
pub struct All<'a> {
    hits: &'a mut [Hit],
    len: usize,
    complete: bool,
    t_max: f32,
}

impl<'a> All<'a> {
    /// Nothing found yet up to `t_max` (closed); `hits` is overwritten from its start.
    pub fn new(t_max: f32, hits: &'a mut [Hit]) -> Self {
        Self { hits, len: 0, complete: true, t_max }
    }

    /// The number of hits in the buffer.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there was no hit.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Whether the buffer had room for every hit.
    pub fn is_complete(&self) -> bool {
        self.complete
    }
}

impl Query for All<'_> {
    const RULE: EdgeRule = EdgeRule::Crossing;

    #[inline(always)]
    fn t_max(&self) -> f32 {
        self.t_max
    }

    /// O(1) for hits in order, as most come, O(n) where one comes late.
    #[inline]
    fn accept(&mut self, hit: Hit) -> ControlFlow<()> {
        let before = |at: usize| at.checked_sub(1).map(|last| self.hits[last]);
        let mut at = self.len;
        while before(at).is_some_and(|last| hit.precedes(&last)) {
            at -= 1;
        }
        if before(at).is_some_and(|last| !last.precedes(&hit)) {
            return ControlFlow::Continue(());
        }
        if self.len < self.hits.len() {
            self.len += 1;
        } else {
            self.complete = false;
        }
        if at < self.len {
            if at + 1 < self.len {
                self.hits.copy_within(at..self.len - 1, at + 1);
            }
            self.hits[at] = hit;
        }
        if !self.complete {
            // The buffer is full: only hits before its last one can still enter it.
            self.t_max = self.len.checked_sub(1).map_or(self.t_max, |last| self.hits[last].t);
        }
        ControlFlow::Continue(())
    }
}

/// How much work a query took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Voxels entered, empty or not; of a 4x4x4 brick only those that hold something.
    pub voxels: u64,
    /// Clusters of up to eight triangles tested.
    pub clusters: u64,
    /// Distinct 64-byte cache lines of the structure read.
    pub cache_lines: u64,
}

impl std::ops::AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        self.voxels += other.voxels;
        self.clusters += other.clusters;
        self.cache_lines += other.cache_lines;
    }
}

/// Decorates a query with [`Counts`]; it answers as the query alone does.
///
/// Unlike the plain queries it allocates, for the set of cache lines.
///
/// ```
/// use octogrid::{Closest, Counting, Ray, Scene, TriMesh};
/// let vertices = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.0]];
/// let scene = Scene::build(&TriMesh::new(&vertices, &[[0, 1, 2]])?, &Default::default())?;
/// let ray = Ray::new([0.0, 0.0, 2.0], [0.0, 0.0, -1.0]);
/// let mut query = Counting::new(Closest::new(ray.t_max));
/// scene.query(&ray, &mut query);
/// assert_eq!(query.query().hit().t, 2.0);
/// assert_eq!(query.counts().clusters, 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Counting<Q> {
    query: Q,
    counts: Counts,
    lines: HashSet<usize>,
}

impl<Q: Query> Counting<Q> {
    /// Counts from zero.
    pub fn new(query: Q) -> Self {
        Self { query, counts: Counts::default(), lines: HashSet::new() }
    }

    /// The decorated query.
    pub fn query(&self) -> &Q {
        &self.query
    }

    /// What was counted so far.
    pub fn counts(&self) -> Counts {
        Counts { cache_lines: self.lines.len() as u64, ..self.counts }
    }
}

impl<Q: Query> Query for Counting<Q> {
    const RULE: EdgeRule = Q::RULE;
    const WANTED: Wanted = Q::WANTED;

    fn t_max(&self) -> f32 {
        self.query.t_max()
    }

    fn accept(&mut self, hit: Hit) -> ControlFlow<()> {
        self.query.accept(hit)
    }

    fn on_voxel(&mut self) {
        self.counts.voxels += 1;
    }

    fn on_cluster(&mut self) {
        self.counts.clusters += 1;
    }

    fn on_read<T>(&mut self, data: &T) {
        const LINE: usize = 64;
        let start = std::ptr::from_ref(data).addr();
        let end = start + size_of::<T>().max(1);
        self.lines.extend(start / LINE..end.div_ceil(LINE));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hit(t: f32, prim: u32) -> Hit {
        Hit { t, u: 0.0, v: 0.0, prim }
    }

    #[test]
    fn closest_keeps_the_least() {
        let mut query = Closest::new(10.0);
        for h in [hit(3.0, 5), hit(2.0, 9), hit(2.0, 4), hit(2.0, 7)] {
            assert!(query.accept(h).is_continue());
        }
        assert_eq!((query.hit(), query.t_max()), (hit(2.0, 4), 2.0));
    }

    #[test]
    fn all_sorts_and_drops_repeats() {
        let mut buffer = [Hit::MISS; 8];
        let mut query = All::new(f32::INFINITY, &mut buffer);
        for h in [hit(3.0, 1), hit(1.0, 2), hit(3.0, 1), hit(1.0, 0), hit(2.0, 1)] {
            assert!(query.accept(h).is_continue());
        }
        assert!(query.is_complete());
        let len = query.len();
        assert_eq!(buffer[..len], [hit(1.0, 0), hit(1.0, 2), hit(2.0, 1), hit(3.0, 1)]);
    }

    #[test]
    fn all_keeps_the_first_where_room_is_short() {
        let mut buffer = [Hit::MISS; 2];
        let mut query = All::new(f32::INFINITY, &mut buffer);
        for t in [5.0, 1.0, 3.0, 2.0, 9.0] {
            assert!(query.accept(hit(t, t as u32)).is_continue());
        }
        assert!(!query.is_complete());
        assert_eq!(query.t_max(), 2.0);
        assert_eq!(buffer, [hit(1.0, 1), hit(2.0, 2)]);
        let mut query = All::new(7.0, &mut []);
        assert!(query.accept(hit(1.0, 1)).is_continue());
        assert_eq!((query.len(), query.is_complete()), (0, false));
    }
}
