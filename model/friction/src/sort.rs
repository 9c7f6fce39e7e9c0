//! Sorting by a number, with little code for each type.

/// Sorts items by a number, in ascending order. The sort is stable, and `NaN` is last
/// ([`f64::total_cmp`]).
///
/// The WebAssembly module sorts in sixty places. [`slice::sort_by`] would add about 6 kB to it for
/// each, because the compiler repeats the algorithm for every type and comparison. This function
/// sorts plain numbers in shared code, then permutes the items.
pub fn sort_by_number<T>(items: &mut [T], number: impl Fn(&T) -> f64) {
    let mut from = sorted_indices(items.iter().map(number).collect());
    // Follows each cycle of the permutation, so that every item moves once.
    for start in 0..items.len() {
        let mut place = start;
        while from[place] != place {
            let next = std::mem::replace(&mut from[place], place);
            if next != start {
                items.swap(place, next);
            }
            place = next;
        }
    }
}

/// Returns the index of the smallest number, then that of the next one, and so on.
#[inline(never)]
fn sorted_indices(numbers: Vec<f64>) -> Vec<usize> {
    let mut places: Vec<(f64, usize)> = numbers.into_iter().zip(0..).collect();
    places.sort_by(|a, b| a.0.total_cmp(&b.0));
    places.into_iter().map(|(_, place)| place).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn sorting_is_stable(numbers in prop::collection::vec(-3i8..3, 0..40)) {
            let mut items: Vec<(i8, usize)> = numbers.into_iter().zip(0..).collect();
            let mut expected = items.clone();
            expected.sort_by_key(|item| item.0);
            sort_by_number(&mut items, |item| f64::from(item.0));
            prop_assert_eq!(items, expected);
        }
    }

    #[test]
    fn nan_is_last() {
        let mut items = [f64::NAN, 2.0, f64::NEG_INFINITY, -1.0];
        sort_by_number(&mut items, |x| *x);
        assert_eq!(items[..3], [f64::NEG_INFINITY, -1.0, 2.0]);
    }
}
