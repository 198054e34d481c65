//! Implicit Euler in 64 bits, each step solved to the rounding of its numbers.
//!
//! A step of `h` goes from positions `x` and velocities `v` to the positions `x'` at which
//!
//! ```text
//! (1 + damping h) m (x' - y) / h^2 = sum of lambda grad C(x'),    C(x') + compliance lambda = 0,
//! ```
//!
//! `y = x + h (v + h g) / (1 + damping h)` being where things are predicted, and then `v' = (x' - x) / h`: damping is a drag of `damping m v'`. These are
//! the equations whose solution the solver's projections approach, constraints, prediction and damping
//! being its own: XPBD's (Macklin et al. 2016, equations 8 and 9) with both residuals zero. Projections fulfill the
//! second equation only; what they leave of the first goes to zero with the substep, not with the iterations
//! (Chen et al., "Primal Extended Position Based Dynamics", 2023).
//!
//! Compliance 0 is a multiplier like any other: the method of multipliers closes rigid constraints to
//! rounding, so there is no least compliance. The volume of a closed piece is one constraint over all of its vertices: its part of the matrix
//! that is dense has rank one and is added to the sparse rest by Woodbury's formula. Within it, Newton's method with line search on Hessians that are
//! made positive where they are not, a constraint at a time.

mod edge;
mod error;
mod hinge;
mod matrix;
mod measure;
mod model;
mod objective;
mod quantities;
mod residuals;
mod step;
#[cfg(test)]
mod tests;
mod volume;

pub use edge::edge;
pub use error::ReferenceError;
pub use hinge::hinge;
pub use measure::Measure;
pub use model::{Constraints, Model, State};
pub use residuals::Residuals;
pub use step::{StepReport, Stepper};
pub use volume::{Piece, Volumes};
