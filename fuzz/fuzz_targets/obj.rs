//! [`octogrid_fuzz::obj`] under libFuzzer.
#![no_main]

use libfuzzer_sys::fuzz_target;
use octogrid_fuzz::obj;

fuzz_target!(|data: &[u8]| obj(data));
