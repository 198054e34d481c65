//! Sorting by buckets: linear time for the many small groups of a mesh's elements.

/// Returns the items by bucket, ascending, and sorted within each of the `count` buckets.
///
/// Items are sorted as a whole if `bucket` ascends with them. O(n + k) for k buckets of few items
/// each, O(n log n) otherwise.
pub(crate) fn sort_in_buckets<T: Copy + Ord>(
    items: impl Iterator<Item = T> + Clone,
    count: usize,
    bucket: impl Fn(&T) -> u32,
) -> Vec<T> {
    let mut ends = vec![0_u32; count];
    let mut out: Vec<T> = items.clone().collect();
    debug_assert!(
        u32::try_from(out.len()).is_ok(),
        "more items than 32 bits count"
    );
    for item in &out {
        ends[bucket(item) as usize] += 1;
    }
    let mut start = 0;
    for end in &mut ends {
        start += std::mem::replace(end, start);
    }
    for item in items {
        let end = &mut ends[bucket(&item) as usize];
        out[*end as usize] = item;
        *end += 1;
    }
    let mut start = 0;
    for end in ends {
        out[start..end as usize].sort_unstable();
        start = end as usize;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn ascending_buckets_sort_everything(
            items in prop::collection::vec((0..9_u32, 0..99_u32), 0..200),
        ) {
            let mut expected = items.clone();
            expected.sort_unstable();
            prop_assert_eq!(sort_in_buckets(items.iter().copied(), 9, |item| item.0), expected);
        }

        #[test]
        fn equal_items_are_neighbors(items in prop::collection::vec(0..30_u32, 0..200)) {
            let bucket = |item: &u32| item.wrapping_mul(2_654_435_769) >> 30;
            let sorted = sort_in_buckets(items.iter().copied(), 4, bucket);
            let mut runs: Vec<u32> = sorted.chunk_by(|a, b| a == b).map(|run| run[0]).collect();
            let count = runs.len();
            runs.sort_unstable();
            runs.dedup();
            prop_assert_eq!(runs.len(), count);
            prop_assert_eq!(sorted.len(), items.len());
        }
    }
}
