//! The threads that queries run on.

use rayon::ThreadPool;

use crate::failure::Failure;

/// How many threads.
#[derive(Debug, clap::Args)]
pub(crate) struct ThreadArgs {
    /// Threads to use [default: all]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
}

impl ThreadArgs {
    /// Runs `work` in a pool of that many threads.
    ///
    /// # Errors
    /// As `work`, and where the system refuses the threads.
    pub(crate) fn run<T: Send>(
        &self,
        work: impl FnOnce() -> Result<T, Failure> + Send,
    ) -> Result<T, Failure> {
        of(self.threads.map_or(0, usize::from))?.install(work)
    }
}

/// A pool of that many threads, or of one a core for 0.
///
/// # Errors
/// Where the system refuses the threads.
pub(crate) fn of(threads: usize) -> Result<ThreadPool, Failure> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.map_err(|e| Failure::Expected(format!("can't start the threads: {e}")))
}
