//! The only place of this crate that knows threads; without the feature `parallel` its functions are plain loops.
//!
//! Chunks have a fixed size and their results come back in order, so nothing found depends on the number of threads.

use std::ops::Range;

#[cfg(feature = "parallel")]
use rayon::prelude::*;

/// Items of one chunk. A mesh with fewer is left to one thread: handing it out would take longer than the work.
const CHUNK: usize = 4096;

/// `work` on the numbers below `len`, chunk by chunk, with the results in the order of the chunks.
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

/// Both results, worked out at the same time if there are `len` items enough for two threads.
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

/// Sorts without keeping the order of equal items; items that are equal must be alike.
pub(crate) fn sort<T: Ord + Send>(items: &mut [T]) {
    #[cfg(feature = "parallel")]
    if items.len() > CHUNK {
        items.par_sort_unstable();
        return;
    }
    items.sort_unstable();
}
