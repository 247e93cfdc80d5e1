//! Sorting, compiled once for all types.
//!
//! The compiler compiles a sort of the standard library again for every type and every comparison, and each copy is a
//! thousand lines long. This module sorts indices, with a comparison through a function pointer. Time-critical loops use
//! the standard sorts instead.

use std::cmp::Ordering;

/// Sorts items. Equal items keep their order.
pub(crate) fn sort_by<T>(items: &mut [T], mut compare: impl FnMut(&T, &T) -> Ordering) {
    let order = order_of(items.len(), &mut |a, b| compare(&items[a], &items[b]));
    let mut places = vec![0; order.len()];
    for (place, item) in order.into_iter().enumerate() {
        places[item] = place;
    }
    for k in 0..items.len() {
        while places[k] != k {
            let place = places[k];
            items.swap(k, place);
            places.swap(k, place);
        }
    }
}

/// Sorts items by a key. Items with equal keys keep their order.
pub(crate) fn sort_by_key<T, K: Ord>(items: &mut [T], key: impl Fn(&T) -> K) {
    sort_by(items, |a, b| key(a).cmp(&key(b)));
}

/// Sorts numbers in ascending order.
pub(crate) fn sort_numbers(numbers: &mut [f64]) {
    numbers.sort_unstable_by(f64::total_cmp);
}

/// Indices of `count` items in ascending order. Equal items keep their order.
fn order_of(count: usize, compare: &mut dyn FnMut(usize, usize) -> Ordering) -> Vec<usize> {
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by(|a, b| compare(*a, *b));
    order
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// `sort_by_key` gives the order of the standard library, also for equal items.
        #[test]
        fn the_order_is_that_of_a_stable_sort(keys in proptest::collection::vec(0..20_u8, 0..60)) {
            let mut found: Vec<(u8, usize)> = keys.into_iter().zip(0..).collect();
            let mut expected = found.clone();
            expected.sort_by_key(|item| item.0);
            sort_by_key(&mut found, |item| item.0);
            prop_assert_eq!(found, expected);
        }

        #[test]
        fn numbers_ascend(mut numbers in proptest::collection::vec(-1e3..1e3, 0..60)) {
            sort_numbers(&mut numbers);
            prop_assert!(numbers.is_sorted());
        }
    }
}
