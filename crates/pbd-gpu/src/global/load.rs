//! Completes and validates a loaded global step: makes its factors again from their inputs.

use super::GlobalStep;
use super::coordinates::COORDINATES;
use super::job::FactorJob;
use super::matrix::{MatrixInput, NO_ROW};
use super::preconditioner::Preconditioner;
use crate::error::InvalidSolver;
use std::num::NonZeroUsize;
use std::sync::Arc;

/// The thread on which factors of a loaded body are made: that of the caller.
const ONE_THREAD: Option<NonZeroUsize> = NonZeroUsize::new(1);

impl GlobalStep {
    /// Completes a step that was read with serde, of a body with `slots` vertex slots.
    ///
    /// # Errors
    /// [`InvalidSolver::Array`].
    pub(crate) fn finish_load(&mut self, slots: usize) -> Result<(), InvalidSolver> {
        let state = &mut self.preconditioner;
        if !state.is_valid(slots) {
            let array = "inputs of the global step";
            return Err(InvalidSolver::Array { array });
        }
        let make = |input: &Arc<MatrixInput>| {
            let input = input.clone();
            FactorJob::start(move || input.factor(), ONE_THREAD)
        };
        state.factor = (state.input.as_ref()).and_then(|input| make(input).finish());
        let factor = state.factor.as_ref();
        state.scratch = factor.and_then(|factor| factor.cholesky.scratch(COORDINATES));
        state.factor_time = factor.map(|factor| factor.time).unwrap_or_default();
        let rows = factor.map_or(&[][..], |factor| &factor.rows);
        for (v, row) in state.rows.iter_mut().enumerate() {
            if *row != NO_ROW {
                *row = rows.get(v).copied().unwrap_or(NO_ROW);
            }
        }
        if let Some(pending) = &mut state.pending {
            pending.job = make(&pending.input);
        }
        Ok(())
    }
}

impl Preconditioner {
    /// Returns whether arrays fit a body with `slots` vertex slots and numbers are in range.
    fn is_valid(&self, slots: usize) -> bool {
        (self.is_local_stale || self.rows.len() == slots)
            && self.inverse_diagonal.iter().all(|value| value.is_finite())
            && self.input.as_ref().is_none_or(|input| input.is_valid())
            && (self.pending.as_ref())
                .is_none_or(|pending| pending.frames_left > 0 && pending.input.is_valid())
    }
}

impl MatrixInput {
    /// Returns whether all vertices have a mass and a rest position.
    fn is_valid(&self) -> bool {
        let slots = self.inverse_masses.len();
        let lines = self.edges.iter().chain(&self.springs).flatten();
        let mut vertices = lines.chain(self.hinges.iter().flatten());
        self.rest.len() == slots && vertices.all(|v| v.index() < slots)
    }
}
