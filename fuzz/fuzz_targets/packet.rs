//! [`octogrid_fuzz::packet`] under libFuzzer.
#![no_main]

use libfuzzer_sys::fuzz_target;
use octogrid_fuzz::{Case, packet};

fuzz_target!(|case: Case| packet(&case));
