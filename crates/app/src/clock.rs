//! Wall-clock times of a command's stages.

use std::time::{Duration, Instant};

/// Runs `work` and returns its wall-clock time with its result.
pub(crate) fn timed<T>(work: impl FnOnce() -> T) -> (Duration, T) {
    let begin = Instant::now();
    let out = work();
    (begin.elapsed(), out)
}

/// Returns a time in milliseconds, as reports print it.
pub(crate) fn milliseconds(seconds: f64) -> f64 {
    seconds * 1e3
}
