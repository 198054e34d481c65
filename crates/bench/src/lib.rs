//! What the benchmark measures errors against: the mechanics of the solver, solved until nothing is left to
//! solve, in 64 bits.
//!
//! It is behind the feature `reference`, on by default: its sparse linear algebra takes most of the time of a
//! build from nothing.
//!
//! [`Model::of`] and [`State::of`] take a body from a solver, a [`Stepper`] moves it. Models of plain arrays do as well:
//!
//! ```
//! # #[cfg(feature = "reference")] {
//! use incise_bench::{Constraints, Model, State, Stepper};
//! use nalgebra::Vector3;
//!
//! // 2 kg hang from a nail by a spring of 1 mm a newton.
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
//! # }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#[cfg(feature = "reference")]
mod reference;

#[cfg(feature = "reference")]
pub use reference::{
    Constraints, Measure, Model, Piece, ReferenceError, Residuals, State, StepReport, Stepper,
    Volumes, edge, hinge,
};
