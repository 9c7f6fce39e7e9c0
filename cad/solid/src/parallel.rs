//! Parallel loops. Without the feature `parallel`, they run on one thread.
//!
//! Chunks have a fixed size and their results are in order, so that results do not depend on the
//! number of threads.

use std::ops::Range;

#[cfg(feature = "parallel")]
use rayon::prelude::*;

/// Items per chunk. Fewer are processed on one thread: starting tasks would take longer than the
/// work.
const CHUNK: usize = 4096;

/// Returns the number of chunks of `len` items.
pub(crate) fn chunks(len: usize) -> usize {
    len.div_ceil(CHUNK).max(1)
}

/// Calls `work` on chunks of the range `0..len`; returns the results in the order of the chunks.
pub(crate) fn in_chunks<R: Send>(len: usize, work: impl Fn(Range<usize>) -> R + Sync) -> Vec<R> {
    if len <= CHUNK {
        return vec![work(0..len)];
    }
    let chunk = |i: usize| work(i * CHUNK..len.min((i + 1) * CHUNK));
    let chunks = 0..len.div_ceil(CHUNK);
    #[cfg(feature = "parallel")]
    return chunks.into_par_iter().map(chunk).collect();
    #[cfg(not(feature = "parallel"))]
    return chunks.map(chunk).collect();
}

/// Calls both functions, in parallel if `len` items are more than a chunk.
pub(crate) fn both<A: Send, B: Send>(
    len: usize,
    a: impl FnOnce() -> A + Send,
    b: impl FnOnce() -> B + Send,
) -> (A, B) {
    #[cfg(feature = "parallel")]
    if len > CHUNK {
        return rayon::join(a, b);
    }
    let _ = len;
    (a(), b())
}

/// Sorts without keeping the order of equal items, which must be identical.
pub(crate) fn sort<T: Ord + Send>(items: &mut [T]) {
    #[cfg(feature = "parallel")]
    if items.len() > CHUNK {
        items.par_sort_unstable();
        return;
    }
    items.sort_unstable();
}
