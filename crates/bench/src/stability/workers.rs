//! [`side_by_side`]: independent runs, one thread each.

use std::num::NonZeroUsize;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

/// Runs every item and returns the results in the order of the items.
///
/// A thread takes the next item when it is done with one. Each has a thread pool of its own, so
/// that a run neither waits for others nor depends on their number.
pub(super) fn side_by_side<T: Sync, R: Send>(items: &[T], run: impl Fn(&T) -> R + Sync) -> Vec<R> {
    let threads = thread::available_parallelism().map_or(1, NonZeroUsize::get);
    let next = AtomicUsize::new(0);
    let take = || {
        let mut done = Vec::new();
        while let Some((i, item)) = {
            let i = next.fetch_add(1, Ordering::Relaxed);
            items.get(i).map(|item| (i, item))
        } {
            done.push((i, run(item)));
        }
        done
    };
    let mut all: Vec<(usize, R)> = thread::scope(|scope| {
        let spawn = |_| {
            scope.spawn(|| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(1);
                // Without a pool of its own it shares the global one: slower, not different.
                let _pool = pool.use_current_thread().build();
                take()
            })
        };
        let handles: Vec<_> = (0..threads.min(items.len())).map(spawn).collect();
        let join = handles.into_iter().map(thread::ScopedJoinHandle::join);
        join.flat_map(|done| done.unwrap_or_else(|panic| resume_unwind(panic)))
            .collect()
    });
    all.sort_unstable_by_key(|&(i, _)| i);
    all.into_iter().map(|(_, result)| result).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_are_in_the_order_of_the_items() {
        let items: Vec<usize> = (0..100).collect();
        assert_eq!(side_by_side(&items, |&i| 2 * i)[99], 198);
        assert!(side_by_side(&[0; 0], |&i: &i32| i).is_empty());
        let threads = side_by_side(&items, |_| rayon::current_num_threads());
        assert!(threads.iter().all(|&n| n == 1), "a pool of its own");
    }
}
