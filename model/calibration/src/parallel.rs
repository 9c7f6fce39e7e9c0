//! Independent work side by side, on as many threads as there are processors; results in the order of what was given.

/// `of` each item.
#[cfg(feature = "parallel")]
pub(crate) fn map_each<I: Send, T: Send>(items: Vec<I>, of: impl Fn(I) -> T + Sync + Send) -> Vec<T> {
    use rayon::prelude::*;
    // Items are few and each takes long: whoever is idle takes one.
    items.into_par_iter().with_max_len(1).map(of).collect()
}

/// The results of two.
#[cfg(feature = "parallel")]
pub(crate) fn both<A: Send, B: Send>(a: impl FnOnce() -> A + Send, b: impl FnOnce() -> B + Send) -> (A, B) {
    rayon::join(a, b)
}

/// `of` each item.
#[cfg(not(feature = "parallel"))]
pub(crate) fn map_each<I, T>(items: Vec<I>, of: impl Fn(I) -> T) -> Vec<T> {
    items.into_iter().map(of).collect()
}

/// The results of two.
#[cfg(not(feature = "parallel"))]
pub(crate) fn both<A, B>(a: impl FnOnce() -> A, b: impl FnOnce() -> B) -> (A, B) {
    (a(), b())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_come_in_the_order_of_the_items_also_of_work_within_work() {
        let squares = |upto: u32| map_each((0..upto).collect(), |i| i * i);
        let expected = |upto: u32| (0..upto).map(|i| i * i).collect::<Vec<_>>();
        assert_eq!(map_each((0..20).collect(), squares), (0..20).map(expected).collect::<Vec<_>>());
        assert_eq!(map_each(Vec::new(), squares), Vec::<Vec<u32>>::new());
        assert_eq!(both(|| squares(7), || squares(3)), (expected(7), expected(3)));
    }
}
