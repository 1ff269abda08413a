//! The parts of the command that load scenes and find a place to stand.
//!
//! Each knows the others as modules of the crate's root, where they are imported.
#![allow(dead_code, reason = "the command needs more of them")]

#[path = "../../../src/bin/octogrid/camera.rs"]
pub(crate) mod camera;
#[path = "../../../src/bin/octogrid/failure.rs"]
pub(crate) mod failure;
#[path = "../../../src/bin/octogrid/load.rs"]
pub(crate) mod load;
#[path = "../../../src/bin/octogrid/output.rs"]
pub(crate) mod output;
#[path = "../../../src/bin/octogrid/saved.rs"]
pub(crate) mod saved;
#[path = "../../../src/bin/octogrid/streams.rs"]
pub(crate) mod streams;
#[path = "../../../src/bin/octogrid/survey.rs"]
pub(crate) mod survey;
#[path = "../../../src/bin/octogrid/viewpoint.rs"]
pub(crate) mod viewpoint;
