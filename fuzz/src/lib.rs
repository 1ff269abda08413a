//! What the fuzz targets run, apart from libFuzzer, so that the test suite replays their findings.

mod any_all;
mod build_validate;
mod case;
mod closest;
mod npy_trace;
mod obj;
mod ogrid;
mod options;
mod packet;

// Of the command, which is no library.
#[allow(dead_code)]
#[path = "../../src/bin/octogrid/answer.rs"]
mod answer;
#[allow(dead_code)]
#[path = "../../src/bin/octogrid/npy.rs"]
mod npy;

pub use any_all::any_all;
pub use build_validate::build_validate;
pub use case::Case;
pub use closest::closest;
pub use npy_trace::npy_trace;
pub use obj::obj;
pub use ogrid::ogrid;
pub use options::Options;
pub use packet::packet;
