//! The walk through a recursive regular grid, for any N (paper, sections 3.2 and 3.3).
//!
//! One [`Dda`] a level. Descending into a divided voxel is the paper's general code: divide the width
//! by N, divide the remaining time by it and truncate for the number of planes left, clamp, multiply by
//! the strides. A path that leaves a voxel for a neighbour that is divided as deeply finds the
//! coefficients of the levels below still valid: along the axis that it crosses it enters the first
//! voxel of the next block, and on the others nothing changes.

use std::ops::ControlFlow;

use super::Visit;
use crate::arena::{Arena, LIST_LEVELS, Voxel};
use crate::dda::{Dda, Path, signed_strides};

/// The top level and those below it.
const LEVELS: usize = LIST_LEVELS as usize + 1;

/// A voxel of a block at one level.
#[derive(Clone, Copy)]
struct Level {
    dda: Dda,
    width: [f64; 3],
    /// The index of the block's first word.
    first: u32,
}

#[inline(always)]
pub(crate) fn walk<const N: u32, V: Visit>(arena: &Arena, path: &Path, visit: &mut V) -> ControlFlow<()> {
    let top_strides = signed_strides(arena.grid.strides(), path.octant);
    let strides = signed_strides([1, N, N * N], path.octant);
    let top = Level { dda: Dda::new(path, &arena.grid), width: path.width, first: 0 };
    let mut levels = [top; LEVELS];
    let mut depth = 0;
    // The deepest level whose coefficients belong to the voxel at hand.
    let mut valid = 0;
    let mut time = 0.0;
    let mut limit = path.time(visit.limit());
    loop {
        visit.enter();
        let Level { dda, first, .. } = &levels[depth];
        let word = &arena.words[(first + dda.voxel) as usize];
        visit.read(word);
        match word.get() {
            Voxel::Empty => {}
            Voxel::Leaf(first) => {
                visit.leaf(first)?;
                limit = path.time(visit.limit());
            }
            Voxel::Node(first) => {
                if depth == valid {
                    levels[depth + 1] = descend::<N>(&levels[depth], time, path.octant);
                    valid += 1;
                }
                depth += 1;
                levels[depth].first = first;
                continue;
            }
        }
        let axis = levels[depth].dda.axis();
        time = levels[depth].dda.exit[axis];
        if time > limit {
            return ControlFlow::Continue(());
        }
        valid = depth;
        while depth > 0 {
            let Level { dda, width, .. } = &mut levels[depth];
            if dda.step(axis, width, &strides) {
                break;
            }
            // On to the first voxel of the next block.
            dda.left[axis] = N - 1;
            dda.exit[axis] += width[axis];
            dda.voxel = dda.voxel.wrapping_add_signed(-strides[axis] * (N as i32 - 1));
            depth -= 1;
        }
        if depth == 0 && !levels[0].dda.step(axis, &path.width, &top_strides) {
            return ControlFlow::Continue(());
        }
    }
}

/// The voxel of a divided one in which the path is at `time`: the paper's general descent.
#[inline(always)]
fn descend<const N: u32>(parent: &Level, time: f64, octant: u32) -> Level {
    let increments = [1, N, N * N];
    let mut level = Level { dda: Dda { voxel: 0, ..parent.dda }, width: parent.width, first: 0 };
    for axis in 0..3 {
        let width = parent.width[axis] / f64::from(N);
        let remain = parent.dda.exit[axis] - time;
        let left = ((remain / width) as u32).min(N - 1);
        level.width[axis] = width;
        level.dda.exit[axis] = parent.dda.exit[axis] - f64::from(left) * width;
        level.dda.left[axis] = left;
        let index = if octant >> axis & 1 != 0 { left } else { N - 1 - left };
        level.dda.voxel += index * increments[axis];
    }
    level
}
