//! Counts heap allocations: a frame without a cut makes none.

use stats_alloc::{INSTRUMENTED_SYSTEM, StatsAlloc};
use std::alloc::System;

#[global_allocator]
static GLOBAL: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// Returns the number of allocations and reallocations of this process.
pub(crate) fn count() -> usize {
    let stats = GLOBAL.stats();
    stats.allocations + stats.reallocations
}
