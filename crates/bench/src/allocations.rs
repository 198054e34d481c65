//! Counts heap allocations of the program: a frame without a cut makes none.

use stats_alloc::INSTRUMENTED_SYSTEM;

/// Returns the number of allocations and reallocations of this process.
///
/// The program's allocator counts them; `main.rs` sets it.
pub(crate) fn count() -> usize {
    let stats = INSTRUMENTED_SYSTEM.stats();
    stats.allocations + stats.reallocations
}
