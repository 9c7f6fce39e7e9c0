//! Loops on several threads. Without the feature `parallel`, they run on the caller's thread.

use std::error::Error;
use std::ops::Range;

#[cfg(feature = "parallel")]
use rayon::prelude::*;

/// The threads of a run.
#[derive(Debug)]
pub(crate) struct Pool {
    #[cfg(feature = "parallel")]
    threads: rayon::ThreadPool,
}

impl Pool {
    /// Starts the threads; 0 means one per processor.
    #[cfg(feature = "parallel")]
    pub(crate) fn new(threads: usize) -> Result<Self, Box<dyn Error + Send + Sync>> {
        Ok(Self { threads: rayon::ThreadPoolBuilder::new().num_threads(threads).build()? })
    }

    /// A pool that starts no threads.
    #[cfg(not(feature = "parallel"))]
    #[allow(clippy::unnecessary_wraps)] // The signature of the other one.
    pub(crate) fn new(_: usize) -> Result<Self, Box<dyn Error + Send + Sync>> {
        Ok(Self {})
    }

    /// Returns the number of threads.
    pub(crate) fn threads(&self) -> usize {
        #[cfg(feature = "parallel")]
        return self.threads.current_num_threads();
        #[cfg(not(feature = "parallel"))]
        return 1;
    }

    /// Calls `work`; the loops in it run on the threads of the pool.
    pub(crate) fn install<T: Send>(&self, work: impl FnOnce() -> T + Send) -> T {
        #[cfg(feature = "parallel")]
        return self.threads.install(work);
        #[cfg(not(feature = "parallel"))]
        return work();
    }
}

/// Calls `work` for each item; returns the results in the order of the items.
pub(crate) fn map<I: Sync, T: Send>(items: &[I], work: impl Fn(&I) -> T + Sync + Send) -> Vec<T> {
    #[cfg(feature = "parallel")]
    return items.par_iter().map(work).collect();
    #[cfg(not(feature = "parallel"))]
    return items.iter().map(work).collect();
}

/// Calls `work` for each index; returns the results in the order of the indices.
pub(crate) fn map_range<T: Send>(range: Range<u64>, work: impl Fn(u64) -> T + Sync + Send) -> Vec<T> {
    #[cfg(feature = "parallel")]
    return range.into_par_iter().map(work).collect();
    #[cfg(not(feature = "parallel"))]
    return range.map(work).collect();
}

/// Calls `work` for each item until one fails; returns the results in the order of the items.
pub(crate) fn try_map<I: Sync, T: Send, E: Send>(
    items: &[I],
    work: impl Fn(&I) -> Result<T, E> + Sync + Send,
) -> Result<Vec<T>, E> {
    #[cfg(feature = "parallel")]
    return items.par_iter().map(work).collect();
    #[cfg(not(feature = "parallel"))]
    return items.iter().map(work).collect();
}

/// Sorts without keeping the order of equal items, which must be identical.
pub(crate) fn sort<T: Ord + Send>(items: &mut [T]) {
    #[cfg(feature = "parallel")]
    items.par_sort_unstable();
    #[cfg(not(feature = "parallel"))]
    items.sort_unstable();
}
