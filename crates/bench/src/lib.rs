//! The benchmarks of incise, and the reference that they measure errors against.
//!
//! [`program`] is the command line of `incise-bench`: the paper's table, time, error, stability,
//! and a report of all. The reference solves the solver's equations of motion to rounding in 64
//! bits.
//!
//! The feature `reference`, on by default, builds it; its sparse linear algebra takes minutes to
//! compile. [`Model::of`] and [`State::of`] copy a body from a solver, and a [`Stepper`] moves it.
//! Models of plain arrays work too:
//!
//! ```
//! # #[cfg(feature = "reference")] {
//! use incise_bench::{Constraints, Model, State, Stepper};
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
//! # }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#[cfg(feature = "reference")]
mod accuracy;
mod allocations;
mod backend;
mod chart;
mod clock;
mod cut;
mod directions;
mod frame_rates;
mod html_report;
mod json;
mod machine;
mod method;
mod models;
mod motion;
#[cfg(not(feature = "gpu"))]
mod no_gpu;
mod numbers;
mod options;
mod output;
mod picture;
mod printout;
mod program;
#[cfg(feature = "reference")]
mod reference;
mod refine;
mod skip;
mod solver;
mod stability;
mod statistics;
mod step;
mod table;
mod text_table;
mod work_precision;
mod workload;

pub use program::program;
#[cfg(feature = "reference")]
pub use reference::{
    Constraints, Measure, Model, PatchStepper, Piece, ReferenceError, State, StepReport, Stepper,
    Volumes, edge, hinge,
};
