//! From triangles to an arena.

mod options;

pub use options::{
    BuildError, BuildOptions, HybridParams, OctreeParams, RecursiveParams, Structure, UniformParams,
};
