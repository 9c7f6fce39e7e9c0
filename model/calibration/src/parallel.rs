//! Parallel evaluation on all processors; results are in the order of the items.

/// Applies `of` to each item.
#[cfg(feature = "parallel")]
pub(crate) fn map_each<I: Send, T: Send>(items: Vec<I>, of: impl Fn(I) -> T + Sync + Send) -> Vec<T> {
    use rayon::prelude::*;
    // Items are few and slow: idle threads take one at a time.
    items.into_par_iter().with_max_len(1).map(of).collect()
}

/// Applies `of` to each item.
#[cfg(not(feature = "parallel"))]
pub(crate) fn map_each<I, T>(items: Vec<I>, of: impl Fn(I) -> T) -> Vec<T> {
    items.into_iter().map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_keep_the_order_when_nested() {
        let squares = |upto: u32| map_each((0..upto).collect(), |i| i * i);
        let expected = |upto: u32| (0..upto).map(|i| i * i).collect::<Vec<_>>();
        assert_eq!(map_each((0..20).collect(), squares), (0..20).map(expected).collect::<Vec<_>>());
        assert_eq!(map_each(Vec::new(), squares), Vec::<Vec<u32>>::new());
    }
}
