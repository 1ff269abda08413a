//! The walk through a uniform grid: 3D-DDA (paper, section 3.1).

use std::ops::ControlFlow;

use super::{Visit, list};
use crate::arena::{Arena, Voxel};
use crate::dda::{Dda, Path, signed_strides};

#[inline(always)]
pub(crate) fn walk<V: Visit>(arena: &Arena, path: &Path, visit: &mut V) -> ControlFlow<()> {
    let strides = signed_strides(arena.grid.strides(), path.octant);
    let mut dda = Dda::new(path, &arena.grid);
    let mut limit = path.time(visit.limit());
    loop {
        visit.enter();
        let word = &arena.words[dda.voxel as usize];
        visit.read(word);
        if let Voxel::Leaf(first) = word.get() {
            list(arena, first, visit)?;
            limit = path.time(visit.limit());
        }
        let axis = dda.axis();
        if dda.exit[axis] > limit || !dda.step(axis, &path.width, &strides) {
            return ControlFlow::Continue(());
        }
    }
}
