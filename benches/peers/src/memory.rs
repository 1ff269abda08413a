//! Bytes that Rust's side holds, and the most that it held.

use std::alloc::System;

use peakmem_alloc::{PeakMemAlloc, PeakMemAllocTrait};
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};

/// One of the two knows the sum, the other the peak; both hand every call on as it is.
#[global_allocator]
static MEMORY: PeakMemAlloc<&StatsAlloc<System>> = PeakMemAlloc::new(&INSTRUMENTED_SYSTEM);

/// Memory of a structure, its triangles included.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Bytes {
    /// What it holds after the build.
    pub(crate) held: usize,
    /// The most that was in use during the build.
    pub(crate) peak: usize,
}

/// Runs `work`, and says which memory it took and kept.
pub(crate) fn measure<T>(work: impl FnOnce() -> T) -> (T, Bytes) {
    MEMORY.reset_peak_memory();
    let region = Region::new(&INSTRUMENTED_SYSTEM);
    let done = work();
    let change = region.change();
    let held = change.bytes_allocated.saturating_sub(change.bytes_deallocated);
    (done, Bytes { held, peak: MEMORY.get_peak_memory() })
}
