//! The walk through an octree: the paper's code for N_SUB_VOXELS = 2 (section 3.3).
//!
//! ```text
//! descend:  sub = far corner of the direction
//!           for each axis:  halve the width;  if the path has not passed the middle plane,
//!                           leave there and flip the axis' bit of sub
//! step:     flip the axis' bit of sub; if it was on the far side, the step leads out of the parent,
//!           and sub is already right for the parent's neighbour if that is divided too
//! ```

use std::ops::ControlFlow;

use super::Visit;
use crate::arena::{Arena, LIST_LEVELS, Voxel};
use crate::dda::{Path, first_exit};

/// The top level and those below it.
const LEVELS: usize = LIST_LEVELS as usize + 1;

/// One of the eight voxels of a divided one.
#[derive(Clone, Copy)]
struct Level {
    exit: [f64; 3],
    width: [f64; 3],
    /// The index of the first of the eight words.
    first: u32,
    /// Which of the eight: a bit an axis.
    sub: u32,
}

#[inline(always)]
pub(crate) fn walk<V: Visit>(arena: &Arena, path: &Path, visit: &mut V) -> ControlFlow<()> {
    // The root is the one voxel of the top grid. Bits of the far corner are set where the path rises.
    let far = !path.octant & 7;
    let exit = std::array::from_fn(|axis| (1.0 - path.origin[axis]) * path.width[axis]);
    let root = Level { exit, width: path.width, first: 0, sub: 0 };
    let mut levels = [root; LEVELS];
    let mut depth = 0;
    let mut valid = 0;
    let mut time = 0.0;
    let mut limit = path.time(visit.limit());
    loop {
        visit.enter();
        let Level { first, sub, .. } = levels[depth];
        let word = &arena.words[(first + sub) as usize];
        visit.read(word);
        match word.get() {
            Voxel::Empty => {}
            Voxel::Leaf(first) => {
                visit.leaf(first)?;
                limit = path.time(visit.limit());
            }
            Voxel::Node(first) => {
                if depth == valid {
                    levels[depth + 1] = descend(&levels[depth], time, far);
                    valid += 1;
                }
                depth += 1;
                levels[depth].first = first;
                continue;
            }
        }
        let axis = first_exit(&levels[depth].exit);
        time = levels[depth].exit[axis];
        if time > limit {
            return ControlFlow::Continue(());
        }
        valid = depth;
        loop {
            if depth == 0 {
                return ControlFlow::Continue(());
            }
            let level = &mut levels[depth];
            level.sub ^= 1 << axis;
            level.exit[axis] += level.width[axis];
            if (level.sub ^ far) >> axis & 1 == 0 {
                break;
            }
            depth -= 1;
        }
    }
}

/// The voxel of a divided one in which the path is at `time`: the paper's descent for N = 2.
#[inline(always)]
fn descend(parent: &Level, time: f64, far: u32) -> Level {
    let mut level = Level { sub: far, ..*parent };
    for axis in 0..3 {
        level.width[axis] *= 0.5;
        let middle = parent.exit[axis] - level.width[axis];
        if middle > time {
            level.exit[axis] = middle;
            level.sub ^= 1 << axis;
        }
    }
    level
}
