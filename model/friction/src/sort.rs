//! Order by a number.

/// Sorts items by a number that each has, the smallest first; those with the same number keep their order.
///
/// [`slice::sort_by`] is compiled anew for every kind of item and every comparison, some 6 kB each, of which a module for a
/// browser would hold sixty. This sorts numbers and puts the items in their places.
pub fn sort_by_number<T>(items: &mut [T], number: impl Fn(&T) -> f64) {
    let mut from = order(items.iter().map(number).collect());
    // Cycle by cycle: each place takes the item that belongs there, and gives its own away.
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

/// Where the smallest number stands, then the next one.
#[inline(never)]
fn order(numbers: Vec<f64>) -> Vec<usize> {
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
        fn it_is_a_stable_sort(numbers in prop::collection::vec(-3i8..3, 0..40)) {
            let mut items: Vec<(i8, usize)> = numbers.into_iter().zip(0..).collect();
            let mut expected = items.clone();
            expected.sort_by_key(|item| item.0);
            sort_by_number(&mut items, |item| f64::from(item.0));
            prop_assert_eq!(items, expected);
        }
    }

    #[test]
    fn what_is_no_number_stands_last() {
        let mut items = [f64::NAN, 2.0, f64::NEG_INFINITY, -1.0];
        sort_by_number(&mut items, |x| *x);
        assert_eq!(items[..3], [f64::NEG_INFINITY, -1.0, 2.0]);
    }
}
