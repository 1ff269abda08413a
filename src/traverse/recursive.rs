//! The walk through a recursive regular grid, for any N (paper, sections 3.2 and 3.3).
//!
//! A [`Dda`] over the top grid, and below it one [`General`] part a level. A path that leaves a voxel
//! for a neighbour that is divided as deeply finds the coefficients of the levels below still valid:
//! along the axis that it crosses it enters the first part, and on the others nothing changes.

use std::ops::ControlFlow;

use super::{Visit, Walker, list};
use crate::arena::{Arena, LIST_LEVELS, Voxel};
use crate::dda::{Dda, Limit, Path};
use crate::descent::{General, first_exit};
use crate::lanes::Lanes;

const LEVELS: usize = LIST_LEVELS as usize;

/// A part of a divided voxel.
#[derive(Clone, Copy)]
struct Level<const N: u32> {
    part: General<N>,
    /// The index of the divided voxel's first word.
    first: u32,
}

/// The walk.
pub(crate) struct Recursive<const N: u32>;

impl<const N: u32> Walker for Recursive<N> {
    #[inline(always)]
    fn walk<L: Lanes, V: Visit>(lanes: L, arena: &Arena, path: &Path<L>, visit: &mut V) -> ControlFlow<()> {
        let rises = !path.octant & 7;
        let (mut top, steps) = Dda::new(lanes, path, &arena.grid);
        let mut levels = [Level { part: General::<N>::whole(top.exit, steps.width), first: 0 }; LEVELS];
        // The number of levels below the top, and of those whose coefficients belong to the voxel at hand.
        let (mut depth, mut valid) = (0, 0);
        let mut time = 0.0;
        let mut limit = Limit::new(path.clock, f64::INFINITY, visit.t_max());
        loop {
            visit.enter();
            let index =
                if depth == 0 { top.voxel } else { levels[depth - 1].first + levels[depth - 1].part.voxel };
            let word = &arena.words[index as usize];
            visit.read(word);
            match word.get() {
                Voxel::Empty => {}
                Voxel::Leaf(first) => {
                    list(arena, first, visit)?;
                    limit.update(path.clock, visit.t_max());
                }
                Voxel::Node(first) => {
                    if depth == valid {
                        let whole = match depth {
                            0 => General::whole(top.exit, steps.width),
                            _ => levels[depth - 1].part,
                        };
                        levels[depth].part = whole.descend(time, rises);
                        valid += 1;
                    }
                    levels[depth].first = first;
                    depth += 1;
                    continue;
                }
            }
            let axis = if depth == 0 { top.axis() } else { first_exit(&levels[depth - 1].part.exit) };
            time = if depth == 0 { top.exit[axis] } else { levels[depth - 1].part.exit[axis] };
            if time > limit.time {
                return ControlFlow::Continue(());
            }
            valid = depth;
            while depth > 0 && !levels[depth - 1].part.step(axis, rises) {
                depth -= 1;
            }
            if depth == 0 && !top.step(axis, &steps) {
                return ControlFlow::Continue(());
            }
        }
    }
}
