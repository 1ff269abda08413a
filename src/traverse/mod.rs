//! Walking a structure along a ray.
//!
//! Three things are kept apart: the walks of this module move through space, a [`Visit`] tests what
//! they find ([`leaf`]), and a [`crate::Query`] keeps hits. Each structure has one walk for all of it.

mod batch;
mod brick;
mod brute;
mod coherent;
mod frustum;
mod group;
mod hybrid;
mod leaf;
mod nearest;
mod octree;
mod recursive;
mod uniform;

use std::ops::ControlFlow;

use crate::arena::{Arena, Form};
use crate::dda::{Clip, Path};
use crate::descent::Walk;
use crate::kernel::{Exact, Test};
use crate::lanes::{Isa, Lanes, WIDTH, dispatch};
use crate::query::Query;
use crate::ray::Ray;
#[cfg(feature = "parallel")]
pub(crate) use batch::entering;
pub(crate) use batch::{PerRay, batch};
use brute::Brute;
use coherent::Coherent;
#[cfg(feature = "parallel")]
pub(crate) use group::GROUP;
pub(crate) use group::{FEWEST, Group, PACKETS, Packet};
use hybrid::Hybrid;
use leaf::LeafTest;
use octree::Octree;
use recursive::Recursive;
use uniform::Uniform;

/// What is done with the voxels along a path, in their order.
pub(crate) trait Visit {
    /// The path enters a voxel.
    fn enter(&mut self) {}

    /// The walk reads `data`.
    fn read<T>(&mut self, _data: &T) {}

    /// The voxel holds a cluster. `Break` ends the walk.
    fn cluster(&mut self, index: u32) -> ControlFlow<()>;

    /// The same for a cluster that comes once, or so seldom again that to remember it does not pay.
    #[inline(always)]
    fn only(&mut self, index: u32) -> ControlFlow<()> {
        self.cluster(index)
    }

    /// No hit beyond this t is of use (closed end). May only fall.
    fn t_max(&self) -> f32;
}

/// Visits the clusters of a leaf of a list structure.
#[inline(always)]
fn list<V: Visit>(arena: &Arena, first: u32, visit: &mut V) -> ControlFlow<()> {
    for reference in &arena.references[first as usize..] {
        visit.read(reference);
        visit.cluster(reference.cluster())?;
        if reference.is_last() {
            break;
        }
    }
    ControlFlow::Continue(())
}

/// A walk through one kind of structure.
pub(crate) trait Walker {
    /// Visits the voxels along a path. It ends by running out of voxels or by `Break`.
    fn walk<L: Lanes, V: Visit>(lanes: L, arena: &Arena, path: &Path<L>, visit: &mut V) -> ControlFlow<()>;
}

/// Whether the walk of a hybrid is the one without bricks.
#[inline(always)]
fn leaves_out_bricks(arena: &Arena, walk: Walk) -> bool {
    arena.bricks.is_empty() && walk == Walk::Special
}

/// Runs `$body` with `$walker` as the [`Walker`] of an arena: each in a function of its own, which the
/// compiler finds registers for.
macro_rules! dispatch_walk {
    ($arena:expr, $walk:expr, $walker:ident => $body:expr) => {
        dispatch_walk!(@ $arena, $walk, $walker, $body,
            (Form::Bricks, _) if leaves_out_bricks($arena, $walk) => Hybrid<false>,
            (Form::Bricks, _) => Hybrid<true>,
            (Form::Lists { divisions: 2 }, Walk::Special) => Octree,
            (Form::BRUTE, _) if $arena.is_brute() => Brute,
            (Form::Lists { divisions: 1 }, _) => Uniform,
            (Form::Lists { divisions: 2 }, Walk::General) => Recursive<2>,
            (Form::Lists { divisions: 3 }, _) => Recursive<3>,
            (Form::Lists { divisions: 4 }, _) => Recursive<4>,
            (Form::Lists { divisions: 5 }, _) => Recursive<5>,
            (Form::Lists { divisions: 6 }, _) => Recursive<6>,
            (Form::Lists { divisions: 7 }, _) => Recursive<7>,
            (Form::Lists { divisions: 8 }, _) => Recursive<8>
        )
    };
    (@ $arena:expr, $walk:expr, $walker:ident, $body:expr, $($form:pat $(if $guard:expr)? => $type:ty),*) => {
        match ($arena.form, $walk) {
            $($form $(if $guard)? => { type $walker = $type; $body })*
            (Form::Lists { divisions }, _) => unreachable!("built with {divisions} divisions"),
        }
    };
}

/// Runs a query over a structure.
#[inline(always)]
pub(crate) fn query<K: Test, Q: Query>(isa: Isa, arena: &Arena, walk: Walk, ray: &Ray, query: &mut Q) {
    dispatch_walk!(arena, walk, W => dispatch!(isa, lanes => {
        if !along::<W, _, K, Q>(lanes, arena, ray, query) {
            all_clusters::<_, K, Q>(lanes, arena, ray, query);
        }
    }));
}

/// What a query answers that lives below the dispatch: all that is handed over and kept finds registers.
#[inline(always)]
pub(crate) fn answer<Q: PerRay>(isa: Isa, arena: &Arena, walk: Walk, ray: &Ray) -> Q::Answer {
    dispatch_walk!(arena, walk, W => dispatch!(isa, lanes => {
        let mut query = Q::up_to(ray.t_max);
        if along::<W, _, Exact, Q>(lanes, arena, ray, &mut query) {
            query.answer()
        } else {
            answer_of_all::<_, Q>(lanes, arena, ray)
        }
    }))
}

/// Runs a query along a ray; false where no walk can follow it.
#[inline(always)]
fn along<W: Walker, L: Lanes, K: Test, Q: Query>(lanes: L, arena: &Arena, ray: &Ray, query: &mut Q) -> bool {
    match Path::clip(lanes, ray, &arena.grid) {
        Clip::Miss => true,
        Clip::Path(path) => {
            let mut leaves = LeafTest::<_, K, Q>::new(lanes, arena, ray, query);
            if W::walk(lanes, arena, &path, &mut leaves).is_continue() {
                leaves.finish();
            }
            true
        }
        Clip::TooFar => false,
    }
}

/// [`answer`] for a ray that no walk can follow.
#[cold]
#[inline(never)]
fn answer_of_all<L: Lanes, Q: PerRay>(lanes: L, arena: &Arena, ray: &Ray) -> Q::Answer {
    let mut query = Q::up_to(ray.t_max);
    all_clusters::<_, Exact, Q>(lanes, arena, ray, &mut query);
    query.answer()
}

/// Tests all clusters.
#[cold]
#[inline(never)]
fn all_clusters<L: Lanes, K: Test, Q: Query>(lanes: L, arena: &Arena, ray: &Ray, query: &mut Q) {
    lanes.vectorize(
        #[inline(always)]
        || {
            let mut leaves = LeafTest::<_, K, Q>::new(lanes, arena, ray, query);
            if every_cluster(arena, &mut leaves).is_continue() {
                leaves.finish();
            }
        },
    );
}

/// Visits the clusters of the voxels along a ray.
#[inline(always)]
pub(crate) fn visit<V: Visit>(isa: Isa, arena: &Arena, walk: Walk, ray: &Ray, visit: &mut V) {
    dispatch_walk!(arena, walk, W => dispatch!(isa, lanes => {
        // How the walk ended is no news.
        let _ = match Path::clip(lanes, ray, &arena.grid) {
            Clip::Miss => ControlFlow::Continue(()),
            Clip::Path(path) => W::walk(lanes, arena, &path, visit),
            Clip::TooFar => every_cluster(arena, visit),
        };
    }));
}

#[inline(always)]
fn every_cluster<V: Visit>(arena: &Arena, visit: &mut V) -> ControlFlow<()> {
    for index in 0..arena.clusters.len() as u32 {
        visit.only(index)?;
    }
    ControlFlow::Continue(())
}

/// What has become of rays that were to be answered together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Outcome {
    Answered,
    /// They don't go alike; nothing is answered.
    Apart,
    /// They go alike, but what they meet is so small that they are faster alone; nothing is answered.
    GivenUp,
}

/// Answers rays together, up to [`GROUP`].
#[inline(never)]
pub(crate) fn group<Q: PerRay>(
    isa: Isa,
    arena: &Arena,
    group: &mut Group<'_>,
    rays: &[Ray],
    answers: &mut [Q::Answer],
) -> Outcome {
    if arena.form != Form::Bricks {
        return Outcome::Apart;
    }
    dispatch!(isa, lanes => {
        if !group.load(lanes, &arena.grid, rays) {
            return Outcome::Apart;
        }
        let outcome = Coherent::<_, Q>::run(lanes, arena, group);
        if outcome == Outcome::Answered {
            for (packet, answers) in group.packets.iter().zip(answers.chunks_mut(WIDTH)) {
                answers.copy_from_slice(&Q::answers(lanes, &packet.nearest)[..answers.len()]);
            }
        }
        outcome
    })
}
