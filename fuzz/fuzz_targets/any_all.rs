//! [`octogrid_fuzz::any_all`] under libFuzzer.
#![no_main]

use libfuzzer_sys::fuzz_target;
use octogrid_fuzz::{Case, any_all};

fuzz_target!(|case: Case| any_all(&case));
