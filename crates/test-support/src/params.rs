//! Solver parameters of tests.

use incise_pbd_gpu::SolverParams;

/// Ground at height 0 and ten iterations of one substep, which is harder than the default.
pub const GROUND: SolverParams = SolverParams {
    iterations: 10,
    substeps: 1,
    gravity: [0.0, -9.81, 0.0],
    ground: Some(0.0),
    diagonal_scale: 0.5,
    attachments: true,
    ..SolverParams::paper()
};

/// As [`GROUND`], without the ground.
pub const HANGING: SolverParams = SolverParams {
    ground: None,
    ..GROUND
};

/// As [`HANGING`], without gravity.
pub const WEIGHTLESS: SolverParams = SolverParams {
    gravity: [0.0; 3],
    ..HANGING
};
