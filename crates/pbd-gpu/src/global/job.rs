//! [`FactorJob`]: a factorization on a background thread.

use super::matrix::Factor;
use std::fmt;
use std::num::NonZeroUsize;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError, Weak};
use std::thread;

/// Makes a factor; `None` if the matrix has none.
type Work = Box<dyn FnOnce() -> Option<Factor> + Send>;

/// A factorization that another thread may run.
///
/// Runs on the background thread, or on the first thread that needs the result, so that a busy
/// machine costs time only. The background thread is outside of rayon's pool, whose threads would
/// also run the factorization while they wait for parts of a frame.
#[derive(Debug, Clone)]
pub(super) struct FactorJob(Arc<Shared>);

#[derive(Debug)]
struct Shared {
    progress: Mutex<Progress>,
    is_done: Condvar,
}

/// The progress of a factorization.
enum Progress {
    Waiting(Work),
    Running,
    Done(Option<Arc<Factor>>),
}

impl fmt::Debug for Progress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Waiting(_) => "Waiting",
            Self::Running => "Running",
            Self::Done(_) => "Done",
        })
    }
}

impl Default for FactorJob {
    /// Returns a job that is done, without a factor.
    fn default() -> Self {
        Self(Arc::new(Shared {
            progress: Mutex::new(Progress::Done(None)),
            is_done: Condvar::new(),
        }))
    }
}

impl FactorJob {
    /// Starts a factorization; with one thread it waits for [`Self::finish`].
    ///
    /// The other thread holds nothing of a job that is dropped, except while it runs it.
    pub(super) fn start(
        work: impl FnOnce() -> Option<Factor> + Send + 'static,
        threads: Option<NonZeroUsize>,
    ) -> Self {
        let shared = Arc::new(Shared {
            progress: Mutex::new(Progress::Waiting(Box::new(work))),
            is_done: Condvar::new(),
        });
        if threads.is_none_or(|threads| threads.get() > 1) {
            let weak = Arc::downgrade(&shared);
            let name = "incise-factor".to_owned();
            // Without another thread the work waits for the one that needs the factor.
            let _ = thread::Builder::new().name(name).spawn(move || run(&weak));
        }
        Self(shared)
    }

    /// Returns the factor, after running the factorization or waiting for it.
    ///
    /// `None` if the matrix has no factor or the factorization panicked.
    pub(super) fn finish(&self) -> Option<Arc<Factor>> {
        run(&Arc::downgrade(&self.0));
        let mut progress = self.0.lock();
        loop {
            if let Progress::Done(factor) = &*progress {
                return factor.clone();
            }
            let woken = self.0.is_done.wait(progress);
            progress = woken.unwrap_or_else(PoisonError::into_inner);
        }
    }
}

/// Runs a factorization, unless another thread has taken it or the job was dropped.
fn run(shared: &Weak<Shared>) {
    let Some(work) = shared.upgrade().and_then(|shared| shared.take()) else {
        return;
    };
    // A panic leaves the job without a factor instead of running forever.
    let factor = catch_unwind(AssertUnwindSafe(work)).unwrap_or_default();
    if let Some(shared) = shared.upgrade() {
        *shared.lock() = Progress::Done(factor.map(Arc::new));
        shared.is_done.notify_all();
    }
}

impl Shared {
    /// Takes the work of a waiting job, which runs from then on.
    fn take(&self) -> Option<Work> {
        let mut progress = self.lock();
        match std::mem::replace(&mut *progress, Progress::Running) {
            Progress::Waiting(work) => Some(work),
            other => {
                *progress = other;
                None
            }
        }
    }

    fn lock(&self) -> MutexGuard<'_, Progress> {
        (self.progress.lock()).unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc::channel;
    use std::time::Duration;

    const THREADS: [Option<NonZeroUsize>; 2] = [NonZeroUsize::new(1), NonZeroUsize::new(2)];

    #[test]
    fn a_panic_leaves_no_factor_and_no_thread_that_waits() {
        for threads in THREADS {
            let job = FactorJob::start(|| panic!("a factorization panics in this test"), threads);
            assert!(job.finish().is_none());
            assert!(
                job.clone().finish().is_none(),
                "a clone does not wait either"
            );
        }
    }

    #[test]
    fn a_dropped_job_drops_its_work() {
        for threads in THREADS {
            let input = Arc::new(());
            let (held, (sender, receiver)) = (input.clone(), channel::<()>());
            let work = move || {
                // Until the test drops the sender.
                let _ = receiver.recv();
                drop(held);
                None
            };
            drop(FactorJob::start(work, threads));
            drop(sender);
            for _ in 0..1000 {
                if Arc::strong_count(&input) == 1 {
                    break;
                }
                thread::sleep(Duration::from_millis(1));
            }
            assert_eq!(Arc::strong_count(&input), 1, "{threads:?}");
        }
    }
}
