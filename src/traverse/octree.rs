//! The walk through an octree: the paper's code for N_SUB_VOXELS = 2 (section 3.3).
//!
//! As [`super::recursive`], with [`Halves`] for parts and one voxel on top, where a step out ends the
//! walk.

use std::ops::ControlFlow;

use super::{Visit, Walker, list};
use crate::arena::{Arena, LIST_LEVELS, Voxel};
use crate::dda::{Limit, Path};
use crate::descent::{Halves, first_exit};
use crate::lanes::{Lanes, axes};

/// The root and the levels below it.
const LEVELS: usize = LIST_LEVELS as usize + 1;

/// A part of a divided voxel, or the root.
#[derive(Clone, Copy)]
struct Level {
    part: Halves,
    /// The index of the divided voxel's first word.
    first: u32,
}

/// The walk.
pub(crate) struct Octree;

impl Walker for Octree {
    #[inline(always)]
    fn walk<L: Lanes, V: Visit>(lanes: L, arena: &Arena, path: &Path<L>, visit: &mut V) -> ControlFlow<()> {
        let rises = !path.octant & 7;
        let exit = lanes.store4((lanes.splat4(1.0) - path.origin) * path.width);
        let width = lanes.store4(path.width);
        let root = Halves::whole(axes(|axis| exit[axis]), axes(|axis| width[axis]));
        let mut levels = [Level { part: root, first: 0 }; LEVELS];
        // The level at hand, and the deepest whose coefficients belong to the voxel at hand.
        let (mut depth, mut valid) = (0, 0);
        let mut time = 0.0;
        let mut limit = Limit::new(path.clock, f64::INFINITY, visit.t_max());
        loop {
            visit.enter();
            let Level { part, first } = &levels[depth];
            let word = &arena.words[(first + part.voxel) as usize];
            visit.read(word);
            match word.get() {
                Voxel::Empty => {}
                Voxel::Leaf(first) => {
                    list(arena, first, visit)?;
                    limit.update(path.clock, visit.t_max());
                }
                Voxel::Node(first) => {
                    if depth == valid {
                        levels[depth + 1].part = levels[depth].part.descend_in(lanes, time, rises);
                        valid += 1;
                    }
                    depth += 1;
                    levels[depth].first = first;
                    continue;
                }
            }
            let axis = first_exit(levels[depth].part.exit());
            time = levels[depth].part.exit()[axis];
            if time > limit.time {
                return ControlFlow::Continue(());
            }
            valid = depth;
            while depth > 0 && !levels[depth].part.step(axis, rises) {
                depth -= 1;
            }
            if depth == 0 {
                return ControlFlow::Continue(());
            }
        }
    }
}
