//! Counts heap allocations, to show that a frame without a cut makes none.

use stats_alloc::{INSTRUMENTED_SYSTEM, StatsAlloc};
use std::alloc::System;

#[global_allocator]
static GLOBAL: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// Allocations and reallocations of this process so far.
pub(crate) fn count() -> usize {
    let stats = GLOBAL.stats();
    stats.allocations + stats.reallocations
}
