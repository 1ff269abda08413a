//! No walk at all: every cluster for a ray that meets the scene's box, where there are so few that a walk costs
//! more than it saves.

use std::ops::ControlFlow;

use super::{Visit, Walker, every_cluster};
use crate::arena::Arena;
use crate::dda::Path;
use crate::lanes::Lanes;

/// The walk.
pub(crate) struct Brute;

impl Walker for Brute {
    #[inline(always)]
    fn walk<L: Lanes, V: Visit>(_: L, arena: &Arena, _: &Path<L>, visit: &mut V) -> ControlFlow<()> {
        every_cluster(arena, visit)
    }
}
