//! [`SavedStep`]: the state that a step hands to the next one, for files.
//!
//! The format does not depend on the feature `global`; only the conversions do.

use super::StepState;
use super::params::StepStats;
use super::plan::{PlanKey, StepPlan};
use super::second_order::{History, SavedHistory};
use crate::constraints::Constraints;
use crate::error::InvalidSolver;
use incise_mesh::VertexId;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// A [`StepState`], as it is saved.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct SavedStep<'a> {
    /// The inputs of the plan, if it is current.
    plan: Option<PlanKey>,
    history: Option<SavedHistory<'a>>,
    longest_substep: f32,
    mean_rest_length: Option<f64>,
    substeps: u32,
    stats: StepStats,
    /// Vertices, mass \[kg\] and edge length \[m\] of the extent.
    extent: Option<(u64, f64, f64)>,
    global: Option<SavedGlobalStep<'a>>,
    /// Whether the global step was chosen in the last frame.
    was_global_chosen: bool,
    /// Remaining time of settling \[s\].
    settling_time_left: f32,
}

/// The global step of a body, as it is saved.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct SavedGlobalStep<'a> {
    /// The input of the factor in use.
    pub(crate) factor: Option<SavedMatrix<'a>>,
    /// Whether a vertex has a row in the factor, shape [vertex slots].
    pub(crate) has_row: Vec<bool>,
    pub(crate) inverse_diagonal: Cow<'a, [f64]>,
    /// Of edges, hinges and interior springs.
    pub(crate) compliances: [f64; 3],
    pub(crate) pins: Cow<'a, [VertexId]>,
    pub(crate) is_stale: bool,
    pub(crate) is_diagonal_stale: bool,
    pub(crate) pending: Option<SavedPending<'a>>,
    pub(crate) factorizations: u32,
    pub(crate) factor_age: u32,
}

/// A factorization beside the frames, as it is saved.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct SavedPending<'a> {
    pub(crate) input: SavedMatrix<'a>,
    pub(crate) frames_left: u32,
    pub(crate) age: u32,
    pub(crate) changed: Vec<u32>,
}

/// The input of a factorization, as it is saved.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct SavedMatrix<'a> {
    pub(crate) inverse_masses: Cow<'a, [f32]>,
    pub(crate) rest: Cow<'a, [[f32; 3]]>,
    pub(crate) edges: Cow<'a, [[VertexId; 2]]>,
    pub(crate) springs: Cow<'a, [[VertexId; 2]]>,
    pub(crate) hinges: Cow<'a, [[VertexId; 4]]>,
    /// Of edges, hinges and interior springs.
    pub(crate) compliances: [f64; 3],
}

impl StepState {
    /// Returns the state as plain data for a file.
    pub(crate) fn to_saved(&self) -> SavedStep<'_> {
        #[cfg(feature = "global")]
        let (extent, global, was_global_chosen, settling_time_left) = (
            self.extent.map(crate::global::Extent::to_saved),
            self.global.as_ref().map(|global| global.to_saved()),
            self.was_global_chosen,
            self.settling_time_left,
        );
        #[cfg(not(feature = "global"))]
        let (extent, global, was_global_chosen, settling_time_left) = (None, None, false, 0.0);
        SavedStep {
            plan: self.plan.current_key(),
            history: self.history.to_saved(),
            longest_substep: self.longest_substep,
            mean_rest_length: self.mean_rest_length,
            substeps: self.substeps,
            stats: self.stats,
            extent,
            global,
            was_global_chosen,
            settling_time_left,
        }
    }

    /// Returns a saved state of a body with `slots` vertex slots.
    ///
    /// # Errors
    /// [`InvalidSolver::Array`], and [`InvalidSolver::NoGlobalStep`] without the feature `global`.
    pub(crate) fn from_saved(
        saved: SavedStep<'_>,
        constraints: &Constraints,
        slots: usize,
    ) -> Result<Self, InvalidSolver> {
        let invalid = |array| InvalidSolver::Array { array };
        let mut plan = StepPlan::default();
        if let Some(key) = saved.plan {
            let Constraints {
                stretch,
                bending,
                interior_springs,
                ..
            } = constraints;
            plan.update(key, stretch, bending.as_ref(), interior_springs.as_ref());
        }
        let history = match saved
            .history
            .map(|history| History::from_saved(history, slots))
        {
            Some(history) => history.ok_or(invalid("velocities of the last substep"))?,
            None => History::default(),
        };
        let mean = saved.mean_rest_length.unwrap_or_default();
        let times = [saved.longest_substep, saved.settling_time_left];
        if !(times.iter().all(|time| time.is_finite()) && mean.is_finite()) {
            return Err(invalid("times of the last step"));
        }
        #[cfg(feature = "global")]
        let global = match saved.global {
            Some(global) => {
                let global = crate::global::GlobalStep::from_saved(global, slots);
                Some(Box::new(
                    global.ok_or(invalid("inputs of the global step"))?,
                ))
            }
            None => None,
        };
        #[cfg(not(feature = "global"))]
        if saved.global.is_some() {
            return Err(InvalidSolver::NoGlobalStep);
        }
        Ok(Self {
            plan,
            history,
            longest_substep: saved.longest_substep,
            mean_rest_length: saved.mean_rest_length,
            substeps: saved.substeps,
            stats: saved.stats,
            #[cfg(feature = "global")]
            choice: crate::global::Choice::default(),
            #[cfg(feature = "global")]
            global,
            #[cfg(feature = "global")]
            extent: saved.extent.map(crate::global::Extent::from_saved),
            #[cfg(feature = "global")]
            was_global_chosen: saved.was_global_chosen,
            #[cfg(feature = "global")]
            settling_time_left: saved.settling_time_left,
        })
    }
}
