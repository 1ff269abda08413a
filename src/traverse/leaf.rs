//! Testing a leaf: its clusters against the ray, and what is hit to the query.

use std::marker::PhantomData;
use std::ops::ControlFlow;

use super::Visit;
use crate::arena::Arena;
use crate::filter::{RayLanes, Scale};
use crate::hit::Hit;
use crate::kernel::{Subject, Test};
use crate::lanes::Lanes;
use crate::query::Query;
use crate::ray::Ray;

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

/// Tests leaves for one ray and query.
pub(crate) struct LeafTest<'a, L: Lanes, K, Q> {
    lanes: L,
    arena: &'a Arena,
    ray: &'a Ray,
    scale: Scale,
    ray_lanes: RayLanes<L>,
    mailbox: Mailbox,
    kernel: PhantomData<K>,
    query: &'a mut Q,
}

impl<'a, L: Lanes, K: Test, Q: Query> LeafTest<'a, L, K, Q> {
    #[inline(always)]
    pub(crate) fn new(lanes: L, arena: &'a Arena, ray: &'a Ray, query: &'a mut Q) -> Self {
        let scale = Scale::of(ray.dir);
        let ray_lanes = RayLanes::splat(lanes, ray, scale);
        Self { lanes, arena, ray, scale, ray_lanes, mailbox: Mailbox::EMPTY, kernel: PhantomData, query }
    }
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
        while bits != 0 {
            let lane = bits.trailing_zeros() as usize;
            bits &= bits - 1;
            let prim = cluster.ids()[lane];
            if prim == crate::cluster::Cluster::NO_TRIANGLE {
                break;
            }
            let subject = Subject { ray: self.ray, cluster, lane, rule: Q::RULE };
            let Some(at) = K::decide(self.lanes, &found, &subject) else { continue };
            if at.t > self.ray.t_min && at.t <= self.query.t_max() {
                self.query.accept(Hit { t: at.t, u: at.u, v: at.v, prim })?;
                self.ray_lanes.t_max = self.lanes.splat(self.scale.time(self.query.t_max()));
            }
        }
        ControlFlow::Continue(())
    }

    #[inline(always)]
    fn t_max(&self) -> f32 {
        self.query.t_max()
    }
}
