//! [`follow_cut`]: the BVH and the solver of a body follow a cut, side by side for a large one.

use incise_cut::Cutter;
use incise_mesh::{Surface, TopologyDelta};
use incise_pbd_gpu::{ConstraintError, Solver};
use std::num::NonZeroUsize;

/// Minimum number of new triangles for which threads share the work; a fork costs 10 us.
const MIN_SHARED: usize = 1 << 9;

/// Updates the BVH of a cutter that defers it, then constraints and masses.
///
/// It is [`Cutter::update_bvh`] and [`Solver::apply_delta`]. At most `threads` share a large cut;
/// `None` means all of the current rayon pool, and one does not touch it. The results do not
/// depend on it.
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
    solver.write_inverse_masses(surface);
    Ok(())
}
