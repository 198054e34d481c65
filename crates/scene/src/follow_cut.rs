//! [`follow_cut`]: updates BVH and solver of a body after a cut, in parallel if it is large.

use incise_cut::Cutter;
use incise_mesh::{Surface, TopologyDelta};
use incise_pbd_gpu::{ConstraintError, Solver};
use std::num::NonZeroUsize;

/// Minimum number of new triangles for a parallel update of BVH and solver.
const MIN_SHARED: usize = 1 << 9;

/// Updates the BVH, the constraints and the masses of a body after a cut.
///
/// Equivalent to [`Cutter::update_bvh`], then [`Solver::apply_delta`], for a cutter that defers its
/// BVH. `threads` limits the threads of a large cut: `None` allows the current rayon pool, and one
/// uses no pool. Results do not depend on it.
///
/// # Errors
/// As [`Solver::apply_delta`]; the BVH is updated all the same.
pub fn follow_cut(
    cutter: &mut Cutter,
    solver: &mut Solver,
    surface: &mut Surface,
    delta: &TopologyDelta,
    threads: Option<NonZeroUsize>,
) -> Result<(), ConstraintError> {
    let is_shared = delta.triangles_added.len() >= MIN_SHARED
        && threads.is_none_or(|threads| threads.get() > 1)
        && rayon::current_num_threads() > 1;
    let read = &*surface;
    let followed = if is_shared {
        rayon::in_place_scope(|scope| {
            scope.spawn(|_| cutter.update_bvh(read, delta));
            solver.follow_delta(read, delta, threads)
        })
    } else {
        cutter.update_bvh(read, delta);
        solver.follow_delta(read, delta, threads)
    };
    followed?;
    solver.finish_delta(surface, delta);
    Ok(())
}
