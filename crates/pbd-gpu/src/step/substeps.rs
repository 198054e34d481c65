//! Number of substeps of a frame, which is higher for bodies that fall far in one.
//!
//! An iteration carries the weight of a body on a plane by about one edge. In equilibrium, edges
//! are therefore short by a strain that is proportional to the fall per substep, relative to an
//! edge and divided by the iterations. Where this fall is an edge and more, the plane flattens a
//! body in every substep, and constraints cannot restore its shape.
//!
//! In the same way planes and contacts carry the weight of a piece by a part of its volume, which
//! is proportional to the fall relative to its thickness.

use crate::step::params::SolverParams;

/// Maximum fall per substep from rest, in mean rest lengths of edges per iteration.
///
/// A ball of 42 vertices has a mean strain of 4 % at this limit.
const MAX_FALL_IN_EDGES: f64 = 0.02;

/// Maximum fall per substep from rest, in thicknesses of the thinnest piece per iteration.
///
/// The halves of a plate lose 0.4 % of their volumes at this limit.
const MAX_FALL_IN_THICKNESSES: f64 = 0.002;

/// Maximum factor of the number of substeps.
const MAX_FACTOR: f64 = 64.0;

/// Lengths of a body at rest \[m\].
#[derive(Debug, Clone, Copy)]
pub(crate) struct Lengths {
    /// Mean length of an edge.
    pub(crate) edge: f64,
    /// Thickness of the thinnest piece that preserves its volume, infinite without one.
    pub(crate) thickness: f64,
}

/// Returns the number of substeps of a body that a plane may carry.
///
/// Others take [`SolverParams::substeps`].
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the factor is a whole number between 1 and its maximum"
)]
pub(crate) fn substeps(dt: f32, params: &SolverParams, body: Lengths) -> u32 {
    let fall = fall(substep(dt, params), params.gravity);
    let max_fall = f64::from(params.iterations) * max_fall(body);
    if fall <= max_fall || max_fall == 0.0 {
        return params.substeps;
    }
    let factor = (fall / max_fall).sqrt().ceil().min(MAX_FACTOR);
    params.substeps.saturating_mul(factor as u32)
}

/// Returns the maximum fall per substep and iteration \[m\].
fn max_fall(body: Lengths) -> f64 {
    f64::min(
        MAX_FALL_IN_EDGES * body.edge,
        MAX_FALL_IN_THICKNESSES * body.thickness,
    )
}

/// Returns the duration of a substep \[s\].
fn substep(dt: f32, params: &SolverParams) -> f64 {
    f64::from(dt) / f64::from(params.substeps)
}

/// Returns the fall from rest in a substep of `h` \[s\]: `|g| h^2` \[m\].
pub(crate) fn fall(h: f64, gravity: [f32; 3]) -> f64 {
    let squares = gravity.map(|g| f64::from(g) * f64::from(g));
    squares.iter().sum::<f64>().sqrt() * h * h
}

#[cfg(test)]
mod tests {
    use super::*;

    const DT: f32 = 1.0 / 60.0;

    fn params(iterations: u32) -> SolverParams {
        SolverParams {
            iterations,
            ..SolverParams::paper()
        }
    }

    /// A body without a volume.
    fn shell(edge: f64) -> Lengths {
        Lengths {
            edge,
            thickness: f64::INFINITY,
        }
    }

    #[test]
    fn the_fall_per_iteration_is_limited_by_edges_and_thickness() {
        for iterations in [1, 10] {
            for edge in [1e-4, 1e-3, 1e-2, 1e-1, 1.0] {
                for thickness in [0.1 * edge, edge, 100.0 * edge, f64::INFINITY] {
                    let (params, body) = (params(iterations), Lengths { edge, thickness });
                    let substeps = substeps(DT, &params, body);
                    let of = |substeps| {
                        let params = SolverParams { substeps, ..params };
                        fall(substep(DT, &params), params.gravity)
                    };
                    let most = f64::from(iterations) * f64::min(0.02 * edge, 0.002 * thickness);
                    let enough = of(substeps) <= most * (1.0 + 1e-9);
                    assert!(enough || substeps == 64, "{body:?}, {substeps} substeps");
                    let fewer = substeps == 1 || of(substeps - 1) > most;
                    assert!(fewer, "{body:?} needs fewer than {substeps} substeps");
                }
            }
        }
    }

    #[test]
    fn bodies_without_weight_or_edges_take_the_given_substeps() {
        let falling = params(1);
        assert!(substeps(DT, &falling, shell(1e-3)) > 1);
        let weightless = SolverParams {
            gravity: [0.0; 3],
            ..falling
        };
        for (params, edge) in [(weightless, 1e-3), (falling, 0.0)] {
            assert_eq!(substeps(DT, &params, shell(edge)), 1, "{params:?}");
        }
    }

    #[test]
    fn extreme_falls_have_a_bounded_number_of_substeps() {
        let heavy = SolverParams {
            gravity: [f32::MAX; 3],
            ..params(1)
        };
        assert_eq!(substeps(f32::MAX, &heavy, shell(f64::MIN_POSITIVE)), 64);
        let most = SolverParams {
            substeps: u32::MAX,
            ..heavy
        };
        assert_eq!(substeps(f32::MAX, &most, shell(1e-3)), u32::MAX);
    }
}
