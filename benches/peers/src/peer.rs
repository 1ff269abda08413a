//! What is asked of every contender.

use octogrid::{Ray, TriMesh};

use crate::memory::Bytes;

/// A closest hit. A miss has t infinite and `prim == u32::MAX`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Answer {
    pub(crate) t: f32,
    pub(crate) prim: u32,
}

impl Answer {
    /// No hit.
    pub(crate) const MISS: Self = Self { t: f32::INFINITY, prim: u32::MAX };

    /// Whether there is one.
    pub(crate) fn is_hit(&self) -> bool {
        self.prim != u32::MAX
    }
}

/// What is asked of a set of rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Question {
    Closest,
    Any,
    /// How many hits there are.
    All,
}

/// A structure ready for rays. Calls take whole slices, so that the loop is the contender's own.
pub(crate) trait Peer: Send + Sync {
    /// The closest hit of each ray; coherent neighbours start and point nearly alike.
    fn closest(&self, rays: &[Ray], coherent: bool, answers: &mut [Answer]);

    /// Whether there is any hit, for each ray.
    fn occluded(&self, rays: &[Ray], coherent: bool, blocked: &mut [bool]);

    /// The number of hits of each ray.
    fn count(&self, rays: &[Ray], counts: &mut [u32]);

    /// Whether it answers this question at all.
    fn answers(&self, _: Question) -> bool {
        true
    }

    /// Its memory, where Rust's allocator does not see it.
    fn bytes(&self) -> Option<Bytes> {
        None
    }
}

/// A build to be timed.
pub(crate) type Build<'a> = Box<dyn FnOnce() -> Box<dyn Peer> + Send + 'a>;

/// A way to trace: a library with its options.
pub(crate) trait Tracer: Sync {
    /// Does what is not part of a build, such as starting a library.
    fn prepare<'a>(&self, mesh: TriMesh<'a>, threads: usize) -> Build<'a>;

    /// Whether its build uses more than one thread.
    fn builds_in_parallel(&self) -> bool {
        true
    }

    /// Whether its answers must have the bits of the reference.
    fn is_exact(&self) -> bool {
        false
    }
}
