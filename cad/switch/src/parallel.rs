//! Parallel maps: on all processors with the feature `parallel`, sequential without it, with equal results.

/// Maps `items` in their order.
#[cfg(feature = "parallel")]
pub(crate) fn map_each<T: Send, R: Send>(items: Vec<T>, work: impl Fn(T) -> R + Sync + Send) -> Vec<R> {
    use rayon::prelude::*;
    items.into_par_iter().map(work).collect()
}

/// Maps `items` in their order.
#[cfg(not(feature = "parallel"))]
pub(crate) fn map_each<T, R>(items: Vec<T>, work: impl Fn(T) -> R) -> Vec<R> {
    items.into_iter().map(work).collect()
}
