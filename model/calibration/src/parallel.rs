//! Independent work side by side, on as many threads as there are processors; results in the order of what was given.

#[cfg(feature = "parallel")]
use std::cell::Cell;

#[cfg(feature = "parallel")]
thread_local! {
    /// Whether this thread is one of several at work already: what it does is not dealt out again.
    static IS_ONE_OF_SEVERAL: Cell<bool> = const { Cell::new(false) };
}

/// `of` each item.
#[cfg(feature = "parallel")]
pub(crate) fn map_each<I: Send, T: Send>(items: Vec<I>, of: impl Fn(I) -> T + Sync) -> Vec<T> {
    use std::sync::{Mutex, PoisonError};
    let threads = std::thread::available_parallelism().map_or(1, usize::from).min(items.len());
    if threads < 2 || IS_ONE_OF_SEVERAL.get() {
        return items.into_iter().map(of).collect();
    }
    let (todo, done) = (Mutex::new(items.into_iter().enumerate()), Mutex::new(Vec::new()));
    let work = || {
        let next = || todo.lock().unwrap_or_else(PoisonError::into_inner).next();
        while let Some((place, item)) = next() {
            let result = of(item);
            done.lock().unwrap_or_else(PoisonError::into_inner).push((place, result));
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                IS_ONE_OF_SEVERAL.set(true);
                work();
            });
        }
    });
    let mut done = done.into_inner().unwrap_or_else(PoisonError::into_inner);
    done.sort_by_key(|(place, _)| *place);
    done.into_iter().map(|(_, result)| result).collect()
}

/// `of` each item.
#[cfg(not(feature = "parallel"))]
pub(crate) fn map_each<I, T>(items: Vec<I>, of: impl Fn(I) -> T) -> Vec<T> {
    items.into_iter().map(of).collect()
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
    }
}
