//! Implicit Euler in 64 bits, each step solved to rounding: the reference of the solver's errors.
//!
//! [`Model::of`] and [`State::of`] copy a body from a solver, and a [`Stepper`] moves it. Models of
//! plain arrays work too:
//!
//! ```
//! use incise_reference::{Constraints, Model, State, Stepper};
//! use nalgebra::Vector3;
//!
//! // 2 kg hang from a pin by a spring of 1 mm/N.
//! let stretch = Constraints { vertices: vec![[0, 1]], rest: vec![1.0], compliance: 1e-3 };
//! let gravity = Vector3::new(0.0, -10.0, 0.0);
//! let model = Model { mass: vec![0.0, 2.0], stretch, gravity, ..Model::default() };
//! let mut state = State::at(vec![Vector3::zeros(), Vector3::new(0.0, -1.0, 0.0)]);
//! let mut stepper = Stepper::new(&model)?;
//! for _ in 0..100 {
//!     let report = stepper.step(&mut state, 0.1, &[])?;
//!     assert!(report.decrement <= 1e-12);
//! }
//! assert!((state.x[1].y + 1.02).abs() < 1e-12);
//! # Ok::<(), incise_reference::ReferenceError>(())
//! ```
//!
//! # Method
//!
//! A step of `h` goes from positions `x` and velocities `v` to the positions `x'` at which
//!
//! ```text
//! (1 + damping h) m (x' - y) / h^2 = sum of lambda grad C(x'),    C(x') + compliance lambda = 0,
//! ```
//!
//! with the prediction `y = x + h (v + h g) / (1 + damping h)`, and then `v' = (x' - x) / h`.
//! `Model::damping` is a drag of `damping m v'`, unlike that of a material. The solver's
//! projections approach the solution of these equations: XPBD (Macklin et al. 2016, equations 8
//! and 9) with both residuals zero. Projections solve the second equation only. The residual of the
//! first goes to zero with the substep, not with the iterations (Chen et al., "Primal Extended
//! Position Based Dynamics", 2023).
//!
//! The method of multipliers solves rigid constraints to rounding, so compliance may be 0. Each
//! step is Newton's method with line search; the Hessian of every constraint is projected to a
//! positive one. The volume of a closed piece is one constraint over all of its vertices: the dense
//! part of its Hessian has rank one, and Woodbury's formula adds it to the sparse matrix.

mod edge;
mod error;
mod hinge;
mod matrix;
mod measure;
mod model;
mod objective;
mod patches;
mod quantities;
mod sparse;
mod step;
#[cfg(test)]
mod tests;
mod volume;

pub use edge::edge;
pub use error::ReferenceError;
pub use hinge::hinge;
pub use measure::Measure;
pub use model::{Constraints, Model, Plane, State};
pub use patches::PatchStepper;
pub use step::{StepReport, Stepper};
pub use volume::{Piece, Volumes};
