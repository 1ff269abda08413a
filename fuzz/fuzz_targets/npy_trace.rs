//! [`octogrid_fuzz::npy_trace`] under libFuzzer.
#![no_main]

use libfuzzer_sys::fuzz_target;
use octogrid_fuzz::npy_trace;

fuzz_target!(|data: &[u8]| npy_trace(data));
