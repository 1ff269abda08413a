//! Walking a structure along a ray.
//!
//! Three things are kept apart: the walks of this module move through space, a [`Visit`] tests leaves
//! ([`leaf`]), and a [`crate::Query`] keeps hits. Each structure has one walk for all queries.

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
use crate::lanes::Lanes;
use crate::query::Query;
use crate::ray::Ray;
use leaf::LeafTest;

/// What a walk over a list structure does in the voxels it visits, in order.
pub(crate) trait Visit {
    /// The path enters a voxel.
    fn enter(&mut self);

    /// The walk reads `data`.
    fn read<T>(&mut self, data: &T);

    /// The voxel is a leaf whose references start at `first`. `Break` ends the walk.
    fn leaf(&mut self, first: u32) -> ControlFlow<()>;

    /// No hit beyond this t is of use.
    fn limit(&self) -> f64;
}

/// Runs a query over a structure.
#[inline(always)]
pub(crate) fn query<L: Lanes, Q: Query>(lanes: L, arena: &Arena, walk: Walk, ray: &Ray, query: &mut Q) {
    if !ray.is_valid() {
        return;
    }
    let clip = Path::clip(ray, &arena.grid);
    if let Clip::Miss = clip {
        return;
    }
    let mut leaf = LeafTest::new(lanes, arena, ray, query);
    let Clip::Path(path) = clip else {
        let _ = leaf.every_cluster();
        return;
    };
    // The walks end by running out of voxels or by `Break`; neither is news.
    let _ = match (arena.form, walk) {
        (Form::Bricks, _) => hybrid::walk(arena, &path, &mut leaf),
        (Form::Lists { divisions: 2 }, Walk::Special) => octree::walk(lanes, arena, &path, &mut leaf),
        (Form::Lists { divisions }, _) => match divisions {
            1 => uniform::walk(arena, &path, &mut leaf),
            2 => recursive::walk::<2, _>(arena, &path, &mut leaf),
            3 => recursive::walk::<3, _>(arena, &path, &mut leaf),
            4 => recursive::walk::<4, _>(arena, &path, &mut leaf),
            5 => recursive::walk::<5, _>(arena, &path, &mut leaf),
            6 => recursive::walk::<6, _>(arena, &path, &mut leaf),
            7 => recursive::walk::<7, _>(arena, &path, &mut leaf),
            8 => recursive::walk::<8, _>(arena, &path, &mut leaf),
            n => unreachable!("built with {n} divisions"),
        },
    };
}
