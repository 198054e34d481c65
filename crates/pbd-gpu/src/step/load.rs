//! Completes and validates a loaded [`StepState`].

use super::StepState;
use super::guard::EnergyBudget;
use crate::constraints::Constraints;
use crate::error::InvalidSolver;

impl StepState {
    /// Completes a state that was read with serde, of a body with `slots` vertex slots.
    ///
    /// # Errors
    /// [`InvalidSolver::Array`].
    pub(crate) fn finish_load(
        &mut self,
        constraints: &Constraints,
        slots: usize,
    ) -> Result<(), InvalidSolver> {
        let Constraints {
            stretch,
            bending,
            interior_springs,
            interior,
            ..
        } = constraints;
        let cells = interior.as_ref().map(|interior| &interior.cells);
        let (bending, springs) = (bending.as_ref(), interior_springs.as_ref());
        (self.plan).finish_load(stretch, bending, springs, cells);
        self.history.validate(slots)?;
        let mean = self.mean_rest_length.unwrap_or_default();
        let EnergyBudget { slack, age } = self.budget;
        let is_valid = mean.is_finite() && slack >= 0.0 && age >= 0.0 && age.is_finite();
        if !(is_valid && (0.0..=1.0).contains(&self.time_left)) {
            let array = "times of the last step";
            return Err(InvalidSolver::Array { array });
        }
        Ok(())
    }
}
