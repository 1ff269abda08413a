//! What the answers must be, found in ways too simple to be wrong, and the one assertion on them.
//!
//! For tests, fuzz targets and benches. Slow by design: the number of triangles times the number of
//!
//! - [`exact`]: integers of any length, correct by construction, no code shared with the structures;
//! - [`brute`]: the library's own kernel on every triangle, the same bits as every structure;

pub mod brute;
pub mod exact;
mod filter;
mod rational;
mod rng;
mod scan;

pub use rng::SplitMix64;
pub use scan::Answer;
