//! Time that neighbours on a shared machine do not take.

use std::time::Instant;

use rustix::time::{ClockId, clock_gettime};

/// Seconds that something took.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Elapsed {
    pub(crate) wall: f64,
    /// Of the calling thread alone.
    pub(crate) cpu: f64,
}

/// Runs `work`, and says how long that took.
pub(crate) fn time<T>(work: impl FnOnce() -> T) -> (T, Elapsed) {
    let (start, before) = (Instant::now(), thread_seconds());
    let done = work();
    let elapsed = Elapsed { cpu: thread_seconds() - before, wall: start.elapsed().as_secs_f64() };
    (done, elapsed)
}

/// Seconds that the calling thread has been running.
fn thread_seconds() -> f64 {
    let now = clock_gettime(ClockId::ThreadCPUTime);
    now.tv_sec as f64 + now.tv_nsec as f64 * 1e-9
}
