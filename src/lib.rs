#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

mod aabb;
mod arena;
mod build;
pub mod builtin;
mod bundle;
mod cluster;
mod dda;
pub mod descent;
mod exact;
#[cfg(feature = "file")]
mod file;
mod filter;
mod hit;
mod kernel;
mod lanes;
mod mesh;
mod model;
#[cfg(feature = "obj")]
pub mod obj;
#[cfg(feature = "oracle")]
pub mod oracle;
mod overlap;
mod packets;
mod parallel;
mod prepared;
mod query;
mod ray;
mod rng;
mod scene;
#[cfg(feature = "parallel")]
mod stream;
mod traverse;
mod triangle;
mod validate;

pub use build::{
    BuildError, BuildOptions, Decision, Forced, HybridParams, OctreeParams, Part, Plan, Quality,
    RecursiveParams, SceneProfile, Structure, UniformParams,
};
pub use cluster::Cluster;
#[cfg(feature = "file")]
pub use file::{LoadError, MeshMismatch};
pub use hit::{Hit, HitPacket};
pub use kernel::Kernel;
pub use lanes::Isa;
pub use mesh::{MeshError, TriMesh};
pub use model::{Material, Model};
pub use query::{All, Any, Closest, Counting, Counts, EdgeRule, Query, Wanted};
pub use ray::{Ray, RayPacket};
pub use rng::Rng;
pub use scene::{AllHits, Scene};
#[cfg(feature = "parallel")]
pub use stream::{HitLists, TooManyHits};
pub use triangle::{Intersection, intersect};
pub use validate::{Statistics, Violation};
