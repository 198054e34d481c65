//! Number of substeps of a frame, which is higher for bodies that fall far in one.
//!
//! An iteration carries the weight of a body on the ground by about one edge. In equilibrium, edges
//! are therefore short by a strain that is proportional to the fall per substep, relative to an
//! edge and divided by the iterations. Where this fall is an edge and more, the ground flattens a
//! body in every substep, and constraints cannot restore its shape.

use crate::step::params::SolverParams;

/// Maximum fall per substep from rest, in mean rest lengths of edges per iteration.
///
/// A ball of 42 vertices has a mean strain of 4 % at this limit.
const MAX_FALL: f64 = 0.02;

/// Maximum factor of the number of substeps.
const MAX_FACTOR: f64 = 64.0;

/// Returns the number of substeps of a body with edges of a mean rest length \[m\].
///
/// Only bodies above a ground need more than [`SolverParams::substeps`].
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the factor is a whole number between 1 and its maximum"
)]
pub(crate) fn substeps(dt: f32, params: &SolverParams, edge: f64) -> u32 {
    let fall = fall(dt, params);
    let max_fall = MAX_FALL * f64::from(params.iterations) * edge;
    if params.ground.is_none() || fall <= max_fall || max_fall == 0.0 {
        return params.substeps;
    }
    let factor = (fall / max_fall).sqrt().ceil().min(MAX_FACTOR);
    params.substeps.saturating_mul(factor as u32)
}

/// Returns the fall from rest in a substep: `|g| h^2` \[m\].
fn fall(dt: f32, params: &SolverParams) -> f64 {
    let h = f64::from(dt) / f64::from(params.substeps);
    let squares = params.gravity.map(|g| f64::from(g) * f64::from(g));
    squares.iter().sum::<f64>().sqrt() * h * h
}

#[cfg(test)]
mod tests {
    use super::*;

    const DT: f32 = 1.0 / 60.0;

    fn params(iterations: u32) -> SolverParams {
        SolverParams {
            iterations,
            ground: Some(0.0),
            ..SolverParams::paper()
        }
    }

    #[test]
    fn the_fall_per_iteration_is_limited() {
        for iterations in [1, 10] {
            for edge in [1e-4, 1e-3, 1e-2, 1e-1, 1.0] {
                let params = params(iterations);
                let substeps = substeps(DT, &params, edge);
                let of = |substeps| fall(DT, &SolverParams { substeps, ..params });
                let most = MAX_FALL * f64::from(iterations) * edge;
                let enough = of(substeps) <= most * (1.0 + 1e-9);
                assert!(enough || substeps == 64, "{edge} m, {substeps} substeps");
                let fewer = substeps == 1 || of(substeps - 1) > most;
                assert!(fewer, "{edge} m needs fewer than {substeps} substeps");
            }
        }
    }

    #[test]
    fn bodies_without_weight_ground_or_edges_take_the_given_substeps() {
        let falling = params(1);
        assert!(substeps(DT, &falling, 1e-3) > 1);
        let weightless = SolverParams {
            gravity: [0.0; 3],
            ..falling
        };
        let free = SolverParams {
            ground: None,
            ..falling
        };
        for (params, edge) in [(weightless, 1e-3), (free, 1e-3), (falling, 0.0)] {
            assert_eq!(substeps(DT, &params, edge), 1, "{params:?}");
        }
    }

    #[test]
    fn extreme_falls_have_a_bounded_number_of_substeps() {
        let heavy = SolverParams {
            gravity: [f32::MAX; 3],
            ..params(1)
        };
        assert_eq!(substeps(f32::MAX, &heavy, f64::MIN_POSITIVE), 64);
        let most = SolverParams {
            substeps: u32::MAX,
            ..heavy
        };
        assert_eq!(substeps(f32::MAX, &most, 1e-3), u32::MAX);
    }
}
