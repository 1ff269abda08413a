//! Walking a structure along a ray.
//!
//! Three things are kept apart: the walks of this module move through space, a [`Visit`] tests what
//! they find ([`leaf`]), and a [`crate::Query`] keeps hits. Each structure has one walk for all of it.

mod brick;
mod hybrid;
mod leaf;
mod octree;
mod recursive;
mod uniform;

use std::ops::ControlFlow;

use crate::arena::{Arena, Form};
use crate::dda::{Clip, Path};
use crate::descent::Walk;
use crate::kernel::Test;
use crate::lanes::Lanes;
use crate::query::Query;
use crate::ray::Ray;
use leaf::LeafTest;

/// What is done with the voxels along a path, in their order.
pub(crate) trait Visit {
    /// The path enters a voxel.
    fn enter(&mut self) {}

    /// The walk reads `data`.
    fn read<T>(&mut self, _data: &T) {}

    /// The voxel holds a cluster. `Break` ends the walk.
    fn cluster(&mut self, index: u32) -> ControlFlow<()>;

    /// No hit beyond this t is of use.
    fn limit(&self) -> f64;
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

/// Runs a query over a structure.
#[inline(always)]
pub(crate) fn query<K: Test, L: Lanes, Q: Query>(
    lanes: L,
    arena: &Arena,
    walk: Walk,
    ray: &Ray,
    query: &mut Q,
) {
    if ray.is_valid() {
        visit(lanes, arena, walk, ray, &mut LeafTest::<L, K, Q>::new(lanes, arena, ray, query));
    }
}

/// Walks along a valid ray.
#[inline(always)]
pub(crate) fn visit<L: Lanes, V: Visit>(lanes: L, arena: &Arena, walk: Walk, ray: &Ray, visit: &mut V) {
    let path = match Path::clip(ray, &arena.grid) {
        Clip::Miss => return,
        Clip::Path(path) => path,
        Clip::TooFar => return every_cluster(arena, visit),
    };
    // The walks end by running out of voxels or by `Break`; neither is news.
    let _ = match (arena.form, walk) {
        (Form::Bricks, _) => hybrid::walk(lanes, arena, &path, visit),
        (Form::Lists { divisions: 2 }, Walk::Special) => octree::walk(lanes, arena, &path, visit),
        (Form::Lists { divisions }, _) => match divisions {
            1 => uniform::walk(arena, &path, visit),
            2 => recursive::walk::<2, _>(arena, &path, visit),
            3 => recursive::walk::<3, _>(arena, &path, visit),
            4 => recursive::walk::<4, _>(arena, &path, visit),
            5 => recursive::walk::<5, _>(arena, &path, visit),
            6 => recursive::walk::<6, _>(arena, &path, visit),
            7 => recursive::walk::<7, _>(arena, &path, visit),
            8 => recursive::walk::<8, _>(arena, &path, visit),
            n => unreachable!("built with {n} divisions"),
        },
    };
}

/// Visits all clusters, for a ray that no walk can follow.
#[cold]
#[inline(never)]
fn every_cluster<V: Visit>(arena: &Arena, visit: &mut V) {
    let _ = (0..arena.clusters.len() as u32).try_for_each(|index| visit.cluster(index));
}
