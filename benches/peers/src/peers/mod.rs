//! The contenders, one file a library.

pub(crate) mod bvh;
pub(crate) mod embree;
pub(crate) mod obvhs;
pub(crate) mod octogrid;
pub(crate) mod parry;
