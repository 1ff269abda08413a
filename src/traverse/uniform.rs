//! The walk through a uniform grid: 3D-DDA (paper, section 3.1).

use std::ops::ControlFlow;

use super::{Visit, Walker, list};
use crate::arena::{Arena, Voxel};
use crate::dda::{Dda, Limit, Path};
use crate::lanes::Lanes;

/// The walk.
pub(crate) struct Uniform;

impl Walker for Uniform {
    #[inline(always)]
    fn walk<L: Lanes, V: Visit>(lanes: L, arena: &Arena, path: &Path<L>, visit: &mut V) -> ControlFlow<()> {
        let (mut dda, steps) = Dda::new(lanes, path, &arena.grid);
        let mut limit = Limit::new(path.clock, steps.end, visit.t_max());
        loop {
            visit.enter();
            // A path that starts where it leaves the grid may step out of it.
            let Some(word) = arena.words.get(dda.voxel as usize) else {
                return ControlFlow::Continue(());
            };
            visit.read(word);
            if let Voxel::Leaf(first) = word.get() {
                list(arena, first, visit)?;
                limit.update(path.clock, visit.t_max());
            }
            if !dda.advance(limit.time, &steps) {
                return ControlFlow::Continue(());
            }
        }
    }
}
