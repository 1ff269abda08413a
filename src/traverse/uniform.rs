//! The walk through a uniform grid: 3D-DDA (paper, section 3.1).

use std::ops::ControlFlow;

use super::{Visit, Walker, list};
use crate::arena::{Arena, Voxel};
use crate::dda::{Dda, Limit, Path, signed_strides};
use crate::lanes::Lanes;

/// The walk.
pub(crate) struct Uniform;

impl Walker for Uniform {
    #[inline(always)]
    fn walk<L: Lanes, V: Visit>(_: L, arena: &Arena, path: &Path, visit: &mut V) -> ControlFlow<()> {
        let strides = signed_strides(arena.grid.strides(), path.octant);
        let mut dda = Dda::new(path, &arena.grid);
        let mut limit = Limit::new(path, visit.t_max());
        loop {
            visit.enter();
            let word = &arena.words[dda.voxel as usize];
            visit.read(word);
            if let Voxel::Leaf(first) = word.get() {
                list(arena, first, visit)?;
                limit.update(path, visit.t_max());
            }
            if !dda.advance(limit.time, &path.width, &strides) {
                return ControlFlow::Continue(());
            }
        }
    }
}
