//! Saving of the global step: the inputs of its factors, from which loading makes them again.

use super::GlobalStep;
use super::coordinates::COORDINATES;
use super::free_pieces::FreePieces;
use super::job::FactorJob;
use super::matrix::{MatrixInput, NO_ROW};
use super::minimizer::Minimizer;
use super::objective::Compliances;
use super::pieces::PieceMotions;
use super::preconditioner::{Pending, Preconditioner};
use crate::step::saved::{SavedGlobalStep, SavedMatrix, SavedPending};
use incise_mesh::index_u32;
use std::num::NonZeroUsize;
use std::sync::Arc;

/// The thread on which factors of a loaded body are made: that of the caller.
const ONE_THREAD: Option<NonZeroUsize> = NonZeroUsize::new(1);

impl GlobalStep {
    /// Returns the step as plain data for a file. The minimizer has no state between substeps.
    pub(crate) fn to_saved(&self) -> SavedGlobalStep<'_> {
        let state = &self.preconditioner;
        let pending = state.pending.as_ref().map(|pending| SavedPending {
            input: pending.input.to_saved(),
            frames_left: pending.frames_left,
            age: pending.age,
            changed: pending.changed.iter().map(|&v| index_u32(v)).collect(),
        });
        SavedGlobalStep {
            factor: state.factor.as_ref().map(|factor| factor.input.to_saved()),
            has_row: state.rows.iter().map(|&row| row != NO_ROW).collect(),
            inverse_diagonal: (&state.inverse_diagonal).into(),
            compliances: state.compliances.to_saved(),
            pins: (&state.pins).into(),
            is_stale: state.is_stale,
            is_diagonal_stale: state.is_local_stale,
            pending,
            factorizations: state.factorizations,
            factor_age: state.factor_age,
        }
    }

    /// Returns a saved step of a body with `slots` vertex slots, if it fits. Makes its factor.
    pub(crate) fn from_saved(saved: SavedGlobalStep<'_>, slots: usize) -> Option<Self> {
        let has_rows = saved.is_diagonal_stale || saved.has_row.len() == slots;
        let is_finite = |values: &[f64]| values.iter().all(|value| value.is_finite());
        if !has_rows || !is_finite(&saved.inverse_diagonal) {
            return None;
        }
        let input = match saved.factor {
            Some(input) => Some(Arc::new(MatrixInput::from_saved(input)?)),
            None => None,
        };
        let make = |input| FactorJob::start(move || MatrixInput::factor(&input), ONE_THREAD);
        let factor = input.and_then(|input| make(input).finish());
        let rows = factor.as_ref().map_or(&[][..], |factor| &factor.rows);
        let row = |(v, &has_row): (usize, &bool)| {
            let row = rows.get(v).copied().filter(|_| has_row);
            row.unwrap_or(NO_ROW)
        };
        let rows = saved.has_row.iter().enumerate().map(row).collect();
        let pending = match saved.pending {
            Some(pending) => {
                let input = Arc::new(MatrixInput::from_saved(pending.input)?);
                Some(Pending {
                    job: make(input.clone()),
                    frames_left: Some(pending.frames_left).filter(|&frames| frames > 0)?,
                    age: pending.age,
                    input,
                    changed: pending.changed.iter().map(|&v| v as usize).collect(),
                })
            }
            None => None,
        };
        Some(Self {
            preconditioner: Preconditioner {
                scratch: factor
                    .as_ref()
                    .and_then(|factor| factor.cholesky.scratch(COORDINATES)),
                factor_time: factor
                    .as_ref()
                    .map(|factor| factor.time)
                    .unwrap_or_default(),
                factor,
                rows,
                inverse_diagonal: saved.inverse_diagonal.into_owned(),
                compliances: Compliances::from_saved(saved.compliances),
                pins: saved.pins.into_owned(),
                is_stale: saved.is_stale,
                is_local_stale: saved.is_diagonal_stale,
                is_local_new: false,
                pending,
                local: None,
                free: FreePieces::default(),
                // Differ from all others, so that the next frame makes `local` again, from the same
                // constraints and pins.
                local_compliances: Compliances::default(),
                local_pins: Vec::new(),
                factorizations: saved.factorizations,
                factor_age: saved.factor_age,
            },
            minimizer: Minimizer::default(),
            pieces: PieceMotions::default(),
            iterations: 0,
            iterations_left: 0,
            settling_size: None,
            max_relative_kinetic: None,
        })
    }
}

impl MatrixInput {
    fn to_saved(&self) -> SavedMatrix<'_> {
        SavedMatrix {
            inverse_masses: (&self.inverse_masses).into(),
            rest: (&self.rest).into(),
            edges: (&self.edges).into(),
            springs: (&self.springs).into(),
            hinges: (&self.hinges).into(),
            compliances: self.compliances.to_saved(),
        }
    }

    /// Returns a saved input, if all vertices have a mass and a rest position.
    fn from_saved(saved: SavedMatrix<'_>) -> Option<Self> {
        let slots = saved.inverse_masses.len();
        let lines = saved.edges.iter().chain(&*saved.springs).flatten();
        let mut vertices = lines.chain(saved.hinges.iter().flatten());
        let is_valid = saved.rest.len() == slots && vertices.all(|v| v.index() < slots);
        is_valid.then(|| Self {
            inverse_masses: saved.inverse_masses.into_owned(),
            rest: saved.rest.into_owned(),
            edges: saved.edges.into_owned(),
            springs: saved.springs.into_owned(),
            hinges: saved.hinges.into_owned(),
            compliances: Compliances::from_saved(saved.compliances),
        })
    }
}

impl Compliances {
    fn to_saved(self) -> [f64; 3] {
        [self.stretch, self.bending, self.interior_springs]
    }

    fn from_saved([stretch, bending, interior_springs]: [f64; 3]) -> Self {
        Self {
            stretch,
            bending,
            interior_springs,
        }
    }
}
