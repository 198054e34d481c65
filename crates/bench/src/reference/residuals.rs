//! How far positions are from where a step leads, by measures that need no length.

use super::error::ReferenceError;
use super::model::{Model, State};
use super::step::{Solved, Stepper};
use nalgebra::Vector3;

/// What positions lack of the end of a step, each over what its prediction lacks; all 0 where there is nothing to solve.
///
/// The function whose minimum a step ends at is `|x - y|^2 m (1 + damping h) / (2 h^2)` and the energy of constraints, of those that
/// are nearly rigid with the multipliers of the solution.
#[derive(Debug, Clone, Copy, Default, PartialEq, serde::Serialize)]
pub struct Residuals {
    /// The value of that function above its least.
    pub energy: f64,
    /// The decrement of Newton's method.
    pub decrement: f64,
    /// Its gradient, the residual of the first equation of a step, every vertex by the root of its mass.
    pub primal: f64,
}

impl Stepper<'_> {
    /// The residuals of positions that are to be the end of a step of `h` \[s\] from a state.
    ///
    /// # Errors
    /// As [`Stepper::step`].
    pub fn residuals(
        &mut self,
        state: &State,
        h: f64,
        ends: &[Vec<Vector3<f64>>],
    ) -> Result<Vec<Residuals>, ReferenceError> {
        let Solved { objective, x, .. } = self.solve(state, h, &[])?;
        let least = objective.value(&x);
        let model = self.model();
        let mut lack = |x: &[Vector3<f64>]| -> Result<[f64; 3], ReferenceError> {
            Ok([
                objective.value(x) - least,
                self.decrement(&objective, x)?,
                by_mass(model, &objective.gradient(x)),
            ])
        };
        let first = lack(objective.goal())?;
        let over = |now: f64, first: f64| if first > 0.0 { now / first } else { 0.0 };
        let residuals = |x: &Vec<Vector3<f64>>| {
            let now = lack(x)?;
            Ok(Residuals {
                energy: over(now[0], first[0]),
                decrement: over(now[1], first[1]),
                primal: over(now[2], first[2]),
            })
        };
        ends.iter().map(residuals).collect()
    }
}

fn by_mass(model: &Model, gradient: &[Vector3<f64>]) -> f64 {
    let each = gradient.iter().zip(&model.mass);
    let squares = each
        .filter(|(_, m)| **m > 0.0)
        .map(|(g, m)| g.norm_squared() / m);
    squares.sum::<f64>().sqrt()
}
