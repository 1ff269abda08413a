//! [`octogrid_fuzz::closest`] under libFuzzer.
#![no_main]

use libfuzzer_sys::fuzz_target;
use octogrid_fuzz::{Case, closest};

fuzz_target!(|case: Case| closest(&case));
