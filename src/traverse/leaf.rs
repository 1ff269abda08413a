//! Testing a leaf: its clusters against the ray, and what is hit to the query.

use std::marker::PhantomData;
use std::ops::ControlFlow;

use super::Visit;
use crate::arena::Arena;
use crate::cluster::Cluster;
use crate::filter::{RayLanes, Scale};
use crate::hit::Hit;
use crate::kernel::{Subject, Test, known};
use crate::lanes::Lanes;
use crate::query::{Query, Wanted};
use crate::ray::Ray;
use crate::triangle::Intersection;

/// Clusters tested last, which need no second test.
///
/// A cluster that lies in several voxels is met again soon or not at all, so a few are enough
/// (mailboxing: J. Amanatides and A. Woo, 1987).
struct Mailbox {
    recent: [u32; 4],
}

impl Mailbox {
    const EMPTY: Self = Self { recent: [u32::MAX; 4] };

    /// Whether the cluster is new; it no longer is afterwards.
    #[inline(always)]
    fn is_new(&mut self, cluster: u32) -> bool {
        let [a, b, c, d] = self.recent;
        let known = cluster == a || cluster == b || cluster == c || cluster == d;
        if !known {
            self.recent = [cluster, a, b, c];
        }
        !known
    }
}

/// A hit that is certain, but not yet what t, u and v it has.
#[derive(Clone, Copy)]
struct Pending {
    cluster: u32,
    lane: usize,
    /// t lies between these.
    low: f32,
    high: f32,
}

impl Pending {
    const NONE: Self = Self { cluster: u32::MAX, lane: 0, low: f32::INFINITY, high: f32::INFINITY };
}

/// Tests leaves for one ray and query.
///
/// The closest hit is mostly certain before it is decided: the filter's bounds are enough to narrow the interval
/// and to see that another one is closer. So only what is the closest at the end of the walk is decided, while
/// the processor begins with what follows.
pub(crate) struct LeafTest<'a, L: Lanes, K, Q> {
    lanes: L,
    arena: &'a Arena,
    ray: &'a Ray,
    scale: Scale,
    ray_lanes: RayLanes<L>,
    mailbox: Mailbox,
    pending: Pending,
    kernel: PhantomData<K>,
    query: &'a mut Q,
}

impl<'a, L: Lanes, K: Test, Q: Query> LeafTest<'a, L, K, Q> {
    #[inline(always)]
    pub(crate) fn new(lanes: L, arena: &'a Arena, ray: &'a Ray, query: &'a mut Q) -> Self {
        let scale = Scale::of(ray.dir);
        let ray_lanes = RayLanes::splat(lanes, ray, scale);
        let (mailbox, pending) = (Mailbox::EMPTY, Pending::NONE);
        Self { lanes, arena, ray, scale, ray_lanes, mailbox, pending, kernel: PhantomData, query }
    }

    /// Decides what is pending, once the walk has come to its end.
    #[inline(always)]
    pub(crate) fn finish(&mut self) {
        if self.pending.cluster != u32::MAX {
            let _ = self.settle();
        }
    }

    /// Decides what is pending.
    #[inline(always)]
    fn settle(&mut self) -> ControlFlow<()> {
        let Pending { cluster, lane, low, high } = std::mem::replace(&mut self.pending, Pending::NONE);
        let at = known(&self.subject(cluster, lane), high - low);
        self.decided(cluster, lane, at)
    }

    /// One lane of a cluster.
    #[inline(always)]
    fn subject(&self, cluster: u32, lane: usize) -> Subject<'a> {
        let cluster = &self.arena.clusters[cluster as usize];
        Subject { ray: self.ray, cluster, lane, rule: Q::RULE }
    }

    /// Offers what is clear, and looks further into what is not.
    #[inline(always)]
    fn decided(&mut self, cluster: u32, lane: usize, clear: Option<Intersection>) -> ControlFlow<()> {
        let prim = self.arena.clusters[cluster as usize].ids()[lane];
        match clear {
            Some(at) => self.offer(at, prim),
            // A hit ends the walk, so that all of this may live in registers.
            None if Q::WANTED == Wanted::Any => match unclear::<K>(&self.subject(cluster, lane)) {
                Some(at) => self.offer(at, prim),
                None => ControlFlow::Continue(()),
            },
            None => self.offer_unclear(cluster, lane),
        }
    }

    /// Offers a hit to the query if it lies within the interval.
    #[inline(always)]
    fn offer(&mut self, at: Intersection, prim: u32) -> ControlFlow<()> {
        if at.t > self.ray.t_min && at.t <= self.query.t_max() {
            self.query.accept(Hit { t: at.t, u: at.u, v: at.v, prim })?;
            self.narrow();
        }
        ControlFlow::Continue(())
    }

    /// Nothing beyond [`Visit::t_max`] counts any more.
    #[inline(always)]
    fn narrow(&mut self) {
        self.ray_lanes.t_max = self.lanes.splat(self.scale.time(self.t_max()));
    }

    /// Takes a certain hit; false where only a decision tells whether it or the pending one is closer.
    #[inline(always)]
    fn defer(&mut self, new: Pending) -> bool {
        if new.high < self.pending.low {
            self.pending = new;
            self.narrow();
            return true;
        }
        new.low > self.pending.high
    }

    /// Decides what is pending, as something else has to be compared with it.
    #[cold]
    #[inline(never)]
    fn settle_early(&mut self) -> ControlFlow<()> {
        self.lanes.vectorize(
            #[inline(always)]
            || self.settle(),
        )
    }

    /// Offers what is not clear. It is not handed back, so that what is clear never leaves its registers.
    #[cold]
    #[inline(never)]
    fn offer_unclear(&mut self, cluster: u32, lane: usize) -> ControlFlow<()> {
        self.lanes.vectorize(
            #[inline(always)]
            || {
                let subject = self.subject(cluster, lane);
                match K::unclear(&subject) {
                    Some(at) => self.offer(at, subject.cluster.ids()[lane]),
                    None => ControlFlow::Continue(()),
                }
            },
        )
    }
}

#[cold]
#[inline(never)]
fn unclear<K: Test>(subject: &Subject<'_>) -> Option<Intersection> {
    K::unclear(subject)
}

impl<L: Lanes, K: Test, Q: Query> Visit for LeafTest<'_, L, K, Q> {
    #[inline(always)]
    fn enter(&mut self) {
        self.query.on_voxel();
    }

    #[inline(always)]
    fn read<T>(&mut self, data: &T) {
        self.query.on_read(data);
    }

    /// Tests one cluster, unless that was done just now.
    #[inline(always)]
    fn cluster(&mut self, index: u32) -> ControlFlow<()> {
        if self.mailbox.is_new(index) { self.only(index) } else { ControlFlow::Continue(()) }
    }

    #[inline(always)]
    fn only(&mut self, index: u32) -> ControlFlow<()> {
        let cluster = &self.arena.clusters[index as usize];
        self.query.on_cluster();
        self.query.on_read(cluster);
        let (mut bits, found) = K::filter(self.lanes, &self.ray_lanes, cluster);
        if bits == 0 {
            return ControlFlow::Continue(());
        }
        let certain = if Q::WANTED != Wanted::All && self.scale.is_one() {
            K::certain(self.lanes, &self.ray_lanes, &found)
        } else {
            None
        };
        while bits != 0 {
            let lane = bits.trailing_zeros() as usize;
            bits &= bits - 1;
            let prim = cluster.ids()[lane];
            if prim == Cluster::NO_TRIANGLE {
                break;
            }
            if let Some(certain) = &certain
                && certain.lanes >> lane & 1 != 0
            {
                let (low, high) = (self.lanes.lane(certain.low, lane), self.lanes.lane(certain.high, lane));
                if Q::WANTED == Wanted::Any {
                    return self.query.accept(Hit { t: high, u: 0.0, v: 0.0, prim });
                }
                if self.defer(Pending { cluster: index, lane, low, high }) {
                    continue;
                }
                self.settle_early()?;
            }
            let at = K::clear(self.lanes, &found, &Subject { ray: self.ray, cluster, lane, rule: Q::RULE });
            self.decided(index, lane, at)?;
        }
        ControlFlow::Continue(())
    }

    #[inline(always)]
    fn t_max(&self) -> f32 {
        if Q::WANTED == Wanted::Closest {
            let (t_max, high) = (self.query.t_max(), self.pending.high);
            return if high < t_max { high } else { t_max };
        }
        self.query.t_max()
    }
}
