#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

mod build;
mod exact;
mod hit;
mod lanes;
mod mesh;
mod model;
mod query;
mod ray;
mod scene;
mod triangle;

pub use build::{
    BuildError, BuildOptions, HybridParams, OctreeParams, RecursiveParams, Structure, UniformParams,
};
pub use hit::Hit;
pub use lanes::Isa;
pub use mesh::{MeshError, TriMesh};
pub use model::{Material, Model};
pub use query::{All, Any, Closest, Counting, Counts, EdgeRule, Query};
pub use ray::{Ray, RayPacket};
pub use scene::{AllHits, HitLists, Scene, Statistics, Violation};
