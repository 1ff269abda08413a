//! [`octogrid_fuzz::ogrid`] under libFuzzer.
#![no_main]

use libfuzzer_sys::fuzz_target;
use octogrid_fuzz::ogrid;

fuzz_target!(|data: &[u8]| ogrid(data));
