//! [`FactorJob`]: a factorization beside the frames, on a thread of the pool.

use super::matrix::{Factor, MatrixInput};
use std::num::NonZeroUsize;
use std::sync::{Arc, Condvar, Mutex, PoisonError};

/// A factorization that another thread may run.
///
/// The thread that takes the input first runs it: one of the pool, or the one that needs the
/// factor. So a busy pool costs time only.
#[derive(Debug, Clone)]
pub(super) struct FactorJob(Arc<Shared>);

#[derive(Debug)]
struct Shared {
    progress: Mutex<Progress>,
    is_done: Condvar,
}

/// The progress of a factorization.
#[derive(Debug)]
enum Progress {
    Waiting(Box<MatrixInput>),
    Running,
    Done(Option<Arc<Factor>>),
}

impl FactorJob {
    /// Starts a factorization on the current pool; with one thread it waits for [`Self::finish`].
    pub(super) fn start(input: MatrixInput, threads: Option<NonZeroUsize>) -> Self {
        let job = Self(Arc::new(Shared {
            progress: Mutex::new(Progress::Waiting(Box::new(input))),
            is_done: Condvar::new(),
        }));
        if threads.is_none_or(|threads| threads.get() > 1) {
            let other = job.clone();
            rayon::spawn(move || other.run());
        }
        job
    }

    /// Runs the factorization unless another thread has taken it.
    fn run(&self) {
        let taken = {
            let mut progress = self.lock();
            match std::mem::replace(&mut *progress, Progress::Running) {
                Progress::Waiting(input) => Some(input),
                other => {
                    *progress = other;
                    None
                }
            }
        };
        if let Some(input) = taken {
            let factor = input.factor().map(Arc::new);
            *self.lock() = Progress::Done(factor);
            self.0.is_done.notify_all();
        }
    }

    /// Returns the factor, after running the factorization or waiting for it.
    pub(super) fn finish(&self) -> Option<Arc<Factor>> {
        self.run();
        let mut progress = self.lock();
        loop {
            if let Progress::Done(factor) = &*progress {
                return factor.clone();
            }
            let woken = self.0.is_done.wait(progress);
            progress = woken.unwrap_or_else(PoisonError::into_inner);
        }
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, Progress> {
        (self.0.progress.lock()).unwrap_or_else(PoisonError::into_inner)
    }
}
