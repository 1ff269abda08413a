//! Pools of threads that are kept, so that starting threads is in no measurement.
//!
//! Each thread keeps to a processor of its own. Left alone, Linux at times wakes two threads that have slept on
//! the same processor and moves neither for milliseconds, which is longer than some builds.

use std::sync::OnceLock;

use rayon::{ThreadPool, ThreadPoolBuilder};
use rustix::thread::{CpuSet, sched_getaffinity, sched_setaffinity};

/// Runs `work` on a pool of one or two threads; on one, all of it runs on the same thread.
///
/// # Panics
/// Where the system refuses threads.
pub(crate) fn on<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    static POOLS: [OnceLock<ThreadPool>; 2] = [const { OnceLock::new() }; 2];
    let pool = ThreadPoolBuilder::new().num_threads(threads).start_handler(keep_to);
    let start = || pool.build().expect("threads start");
    POOLS[threads - 1].get_or_init(start).install(work)
}

/// Keeps the calling thread to one of the processors that this program may use.
fn keep_to(thread: usize) {
    // Where the system refuses, the thread runs anywhere.
    let Ok(allowed) = sched_getaffinity(None) else { return };
    let Some(processor) = (0..CpuSet::MAX_CPU).filter(|&i| allowed.is_set(i)).nth(thread) else { return };
    let mut own = CpuSet::new();
    own.set(processor);
    let _ = sched_setaffinity(None, &own);
}
