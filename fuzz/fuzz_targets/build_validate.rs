//! [`octogrid_fuzz::build_validate`] under libFuzzer.
#![no_main]

use libfuzzer_sys::fuzz_target;
use octogrid_fuzz::{Case, Options, build_validate};

fuzz_target!(|input: (Options, Case)| build_validate(&input));
