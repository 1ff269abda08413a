//! What the answers must be, found in ways too simple to be wrong, and the one assertion on them.
//!
//! For tests, fuzz targets and benches. Slow by design: the number of triangles times the number of
//! rays.
//!
//! - [`exact`]: integers of any length, correct by construction, no code shared with the structures;
//! - [`brute`]: the library's own kernel on every triangle, the same bits as every structure;
//! - [`rays`], [`meshes`] and [`extremes`]: seeded cases, the ordinary ones and the dangerous;
//! - [`hazards`]: which of these have broken others, by name;
//! - [`watertight`]: closed meshes, and rays that must not get out of them;
//! - `forge`, with the feature `file`: saved scenes whose checksums hide what was done to them;
//! - [`Agreement`]: builds structures and compares all their answers with both.

mod agree;
pub mod brute;
mod compare;
#[cfg(test)]
mod coverage;
mod disagreement;
pub mod exact;
pub mod extremes;
mod filter;
#[cfg(feature = "file")]
pub mod forge;
pub mod hazards;
#[cfg(test)]
mod lattice;
pub mod meshes;
mod rational;
pub mod rays;
mod scan;
mod source;
#[cfg(test)]
mod subject;
pub mod watertight;

pub use agree::{Agreement, Report, Subjects, assert_agree, check_agree};
pub use disagreement::Disagreement;
pub use scan::Answer;
