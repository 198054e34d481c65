//! Number and length of the substeps of a frame.
//!
//! All substeps of a body have the same length. Rigid projections do not depend on it, so that the
//! stiffness of a body grows with its inverse square. Alternating lengths would therefore add
//! energy: up to 1.72 times per pair of frames for `h` and `h / 2`.
//!
//! Substeps are shorter for bodies that fall far in one. An iteration carries the weight of a body
//! on a plane by about one edge. In equilibrium, edges are therefore short by a strain that is
//! proportional to the fall per substep, relative to an edge and divided by the iterations. Where
//! this fall is an edge and more, the plane flattens a body in every substep, and constraints
//! cannot restore its shape. In the same way planes and contacts carry the weight of a piece by a
//! part of its volume, which is proportional to the fall relative to its thickness.

use crate::step::params::SolverParams;

/// Maximum fall per substep from rest, in mean rest lengths of edges per iteration.
///
/// A ball of 42 vertices has a mean strain of 4 % at this limit.
const MAX_FALL_IN_EDGES: f64 = 0.02;

/// Maximum fall per substep from rest, in thicknesses of the thinnest piece per iteration.
///
/// The halves of a plate lose 0.4 % of their volumes at this limit.
const MAX_FALL_IN_THICKNESSES: f64 = 0.002;

/// Maximum number of parts of a substep.
const MAX_PARTS: f64 = 64.0;

/// Rounding error of the quotient of two numbers of 32 bits.
const ROUNDING: f64 = 2.0 * f32::EPSILON as f64;

/// The substeps of a frame.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Substeps {
    /// Their number, 0 in a frame that is too short for one.
    pub(crate) count: u32,
    /// Their length \[s\].
    pub(crate) h: f32,
}

impl Substeps {
    /// Returns the substeps of a frame of `dt` \[s\], and the time left to the next frame.
    ///
    /// `time_left` is that of the last frame; both are in substeps. A frame whose length is a
    /// multiple of a substep, up to rounding, always takes that many.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "parameters limit the number of substeps"
    )]
    pub(crate) fn for_frame(time_left: f64, dt: f32, params: &SolverParams) -> (Self, f64) {
        let Some(h) = params.substep else {
            return (Self { count: 1, h: dt }, 0.0);
        };
        let length = f64::from(dt) / f64::from(h);
        let whole = length.round();
        if (length - whole).abs() <= ROUNDING * whole {
            let count = whole as u32;
            return (Self { count, h }, time_left);
        }
        let time = time_left + length;
        let count = time.floor();
        let substeps = Self {
            count: count as u32,
            h,
        };
        (substeps, time - count)
    }

    /// Divides every substep into equal parts.
    pub(crate) fn divided(self, parts: u32) -> Self {
        Self {
            count: self.count.saturating_mul(parts),
            h: self.h / parts as f32,
        }
    }
}

/// Lengths of a body at rest \[m\].
#[derive(Debug, Clone, Copy)]
pub(crate) struct Lengths {
    /// Mean length of an edge.
    pub(crate) edge: f64,
    /// Thickness of the thinnest piece that preserves its volume, infinite without one.
    pub(crate) thickness: f64,
}

/// Returns the number of parts of each substep of `h` \[s\] of a body that a plane may carry.
///
/// Substeps of other bodies are whole.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a whole number between 1 and its maximum"
)]
pub(crate) fn parts(h: f32, params: &SolverParams, body: Lengths) -> u32 {
    let fall = fall(h.into(), params.gravity);
    let max_fall = f64::from(params.iterations) * max_fall(body);
    if fall <= max_fall || max_fall == 0.0 {
        return 1;
    }
    (fall / max_fall).sqrt().ceil().min(MAX_PARTS) as u32
}

/// Returns the maximum fall per substep and iteration \[m\].
fn max_fall(body: Lengths) -> f64 {
    f64::min(
        MAX_FALL_IN_EDGES * body.edge,
        MAX_FALL_IN_THICKNESSES * body.thickness,
    )
}

/// Returns the fall from rest in a substep of `h` \[s\]: `|g| h^2` \[m\].
pub(crate) fn fall(h: f64, gravity: [f32; 3]) -> f64 {
    let squares = gravity.map(|g| f64::from(g) * f64::from(g));
    squares.iter().sum::<f64>().sqrt() * h * h
}

#[cfg(test)]
mod tests {
    use super::*;

    const H: f32 = 1.0 / 60.0;

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
    fn a_fixed_frame_always_has_the_same_substeps() {
        let params = SolverParams::default();
        for (dt, count) in [(1.0 / 60.0, 12), (1.0 / 30.0, 24), (1.0 / 144.0, 5)] {
            let mut left = 0.0;
            for _ in 0..100_000 {
                let (substeps, next) = Substeps::for_frame(left, dt, &params);
                assert_eq!((substeps.count, substeps.h), (count, 1.0 / 720.0));
                left = next;
            }
        }
        let (whole, _) = Substeps::for_frame(0.0, 0.1, &SolverParams::paper());
        assert_eq!(whole, Substeps { count: 1, h: 0.1 });
    }

    #[test]
    fn substeps_follow_the_time_of_uneven_frames() {
        let params = SolverParams::default();
        let (mut left, mut time, mut count) = (0.0, 0.0, 0);
        for i in 0..10_000 {
            let dt = [1.0 / 75.0, 3e-4, 1.0 / 60.0, 0.1, 0.0123][i % 5];
            let (substeps, next) = Substeps::for_frame(left, dt, &params);
            assert!((0.0..1.0).contains(&next));
            left = next;
            time += f64::from(dt);
            count += u64::from(substeps.count);
            let done = (count as f64 + left) / 720.0;
            assert!(
                (time - done).abs() < 1e-7 * (1.0 + time),
                "{done} of {time} s"
            );
        }
    }

    #[test]
    fn the_fall_per_iteration_is_limited_by_edges_and_thickness() {
        for iterations in [1, 10] {
            for edge in [1e-4, 1e-3, 1e-2, 1e-1, 1.0] {
                for thickness in [0.1 * edge, edge, 100.0 * edge, f64::INFINITY] {
                    let (params, body) = (params(iterations), Lengths { edge, thickness });
                    let parts = parts(H, &params, body);
                    let of = |parts: u32| fall(f64::from(H) / f64::from(parts), params.gravity);
                    let most = f64::from(iterations) * f64::min(0.02 * edge, 0.002 * thickness);
                    let enough = of(parts) <= most * (1.0 + 1e-9);
                    assert!(enough || parts == 64, "{body:?}, {parts} parts");
                    let fewer = parts == 1 || of(parts - 1) > most;
                    assert!(fewer, "{body:?} needs fewer than {parts} parts");
                }
            }
        }
    }

    #[test]
    fn bodies_without_weight_or_edges_take_the_given_substeps() {
        let falling = params(1);
        assert!(parts(H, &falling, shell(1e-3)) > 1);
        let weightless = SolverParams {
            gravity: [0.0; 3],
            ..falling
        };
        for (params, edge) in [(weightless, 1e-3), (falling, 0.0)] {
            assert_eq!(parts(H, &params, shell(edge)), 1, "{params:?}");
        }
    }

    #[test]
    fn extreme_falls_have_a_bounded_number_of_substeps() {
        let heavy = SolverParams {
            gravity: [f32::MAX; 3],
            ..params(1)
        };
        assert_eq!(parts(f32::MAX, &heavy, shell(f64::MIN_POSITIVE)), 64);
        let most = Substeps {
            count: u32::MAX,
            h: H,
        };
        assert_eq!(most.divided(64).count, u32::MAX);
    }
}
