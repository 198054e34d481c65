//! [`Parking`]: threads of a team that sleep until the next pass, woken by the leader.

use std::sync::atomic::{AtomicUsize, Ordering, fence};
use std::sync::{Condvar, Mutex, PoisonError};

/// The parked threads of a team.
///
/// A thread increments the count before it looks for work a last time. The leader publishes work
/// before it reads the count. With a full fence between both steps on each side, either the thread
/// finds the work or the leader wakes the thread. A pass takes no lock while the count is 0.
#[derive(Debug, Default)]
pub(super) struct Parking {
    parked: AtomicUsize,
    lock: Mutex<()>,
    wake: Condvar,
}

impl Parking {
    /// Parks the calling thread until `has_work` holds at a wake-up, or at once.
    pub(super) fn park_until(&self, has_work: impl Fn() -> bool) {
        let mut guard = self.lock.lock().unwrap_or_else(PoisonError::into_inner);
        self.parked.fetch_add(1, Ordering::Relaxed);
        fence(Ordering::SeqCst);
        while !has_work() {
            let woken = self.wake.wait(guard);
            guard = woken.unwrap_or_else(PoisonError::into_inner);
        }
        self.parked.fetch_sub(1, Ordering::Relaxed);
    }

    /// Wakes all parked threads, after the caller has published their work.
    pub(super) fn wake_all(&self) {
        fence(Ordering::SeqCst);
        if self.parked.load(Ordering::Relaxed) > 0 {
            // A thread between its last look and its wait holds the lock.
            drop(self.lock.lock().unwrap_or_else(PoisonError::into_inner));
            self.wake.notify_all();
        }
    }

    /// Returns the number of parked threads.
    #[cfg(test)]
    pub(super) fn parked(&self) -> usize {
        self.parked.load(Ordering::Relaxed)
    }
}
