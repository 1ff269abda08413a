//! Replays the inputs in `fuzz/regressions`, each through what its fuzz target runs.
#![cfg(feature = "cli")]

// The library of another crate, whose items are public there.
#[allow(unreachable_pub)]
#[path = "../fuzz/src/lib.rs"]
mod fuzz;

use std::fs;
use std::path::Path;

use arbitrary::{Arbitrary, Unstructured};
use fuzz::{Case, Options};

/// What the macro of libFuzzer makes of the bytes of a structured input.
fn structured<T: for<'a> Arbitrary<'a>>(run: fn(&T)) -> impl Fn(&[u8]) {
    move |data| {
        if let Ok(input) = T::arbitrary_take_rest(Unstructured::new(data)) {
            run(&input);
        }
    }
}

/// Runs every input of a target.
fn replay(target: &str, run: impl Fn(&[u8])) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/regressions").join(target);
    let files: Vec<_> = fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    assert!(!files.is_empty(), "no input in {}", folder.display());
    for path in files {
        println!("{}", path.display());
        run(&fs::read(&path).unwrap());
    }
}

#[test]
fn closest() {
    replay("closest", structured::<Case>(fuzz::closest));
}

#[test]
fn any_all() {
    replay("any_all", structured::<Case>(fuzz::any_all));
}

#[test]
fn packet() {
    replay("packet", structured::<Case>(fuzz::packet));
}

#[test]
fn build_validate() {
    replay("build_validate", structured::<(Options, Case)>(fuzz::build_validate));
}

#[test]
fn obj() {
    replay("obj", fuzz::obj);
}

#[test]
fn npy_trace() {
    replay("npy_trace", fuzz::npy_trace);
}

#[test]
fn ogrid() {
    replay("ogrid", fuzz::ogrid);
}
