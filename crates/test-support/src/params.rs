//! Solver parameters of tests.

use incise_pbd_gpu::{Collider, MovingCollider, Solver, SolverParams};

/// Ten iterations of one substep, which is harder than the default.
pub const TEN_ITERATIONS: SolverParams = SolverParams {
    iterations: 10,
    substep: None,
    lift: 0.0,
    gravity: [0.0, -9.81, 0.0],
    diagonal_scale: 0.5,
    attachments: true,
    ..SolverParams::paper()
};

/// As [`TEN_ITERATIONS`], without gravity.
pub const WEIGHTLESS: SolverParams = SolverParams {
    gravity: [0.0; 3],
    ..TEN_ITERATIONS
};

/// Sets a horizontal plane at a height \[m\] as the only collider of a body.
///
/// # Panics
/// If the height is not finite.
pub fn set_ground(solver: &mut Solver, height: f32) {
    let ground = MovingCollider::from(Collider::ground(height));
    (solver.set_colliders(&[ground])).expect("a finite height");
}
