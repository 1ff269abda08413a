//! Pools of threads that are kept, so that starting threads is in no measurement.

use std::sync::OnceLock;

use rayon::{ThreadPool, ThreadPoolBuilder};

/// Runs `work` on a pool of one or two threads; on one, all of it runs on the same thread.
///
/// # Panics
/// Where the system refuses threads.
pub(crate) fn on<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    static POOLS: [OnceLock<ThreadPool>; 2] = [const { OnceLock::new() }; 2];
    let start = || ThreadPoolBuilder::new().num_threads(threads).build().expect("threads start");
    POOLS[threads - 1].get_or_init(start).install(work)
}
