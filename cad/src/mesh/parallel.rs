//! The only place of meshes and their examination that knows threads; without them, its functions are plain loops.
//!
//! Chunks have a fixed size and their results come back in order, so nothing found depends on the number of threads.

use std::ops::Range;

use rayon::prelude::*;

/// Items of one chunk. A mesh with fewer is left to one thread: handing it out would take longer than the work.
const CHUNK: usize = 4096;

/// `work` on the numbers below `len`, chunk by chunk, with the results in the order of the chunks.
pub(crate) fn in_chunks<R: Send>(len: usize, work: impl Fn(Range<usize>) -> R + Sync) -> Vec<R> {
    if len <= CHUNK {
        return vec![work(0..len)];
    }
    let chunk = |i: usize| work(i * CHUNK..len.min((i + 1) * CHUNK));
    (0..len.div_ceil(CHUNK)).into_par_iter().map(chunk).collect()
}

/// Both results, worked out at the same time if there are `len` items enough for two threads.
pub(crate) fn both<A: Send, B: Send>(
    len: usize,
    a: impl FnOnce() -> A + Send,
    b: impl FnOnce() -> B + Send,
) -> (A, B) {
    if len <= CHUNK { (a(), b()) } else { rayon::join(a, b) }
}

/// Sorts without keeping the order of equal items; items that are equal must be alike.
pub(crate) fn sort<T: Ord + Send>(items: &mut [T]) {
    if items.len() <= CHUNK { items.sort_unstable() } else { items.par_sort_unstable() }
}
