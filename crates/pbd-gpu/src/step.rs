//! A step of the solver: its list of passes, its constants and their execution on the CPU.

pub(crate) mod backend;
pub(crate) mod body;
mod body_step;
pub(crate) mod cell_sweep;
pub(crate) mod constants;
pub(crate) mod guard;
pub(crate) mod island;
mod island_points;
#[cfg(feature = "serde")]
mod load;
pub(crate) mod params;
pub(crate) mod pass;
pub(crate) mod plan;
pub(crate) mod prepare;
pub(crate) mod reach;
pub(crate) mod rounds;
pub(crate) mod second_order;
pub(crate) mod stage;
pub(crate) mod substeps;
pub(crate) mod sweep;

use guard::EnergyBudget;
use params::StepStats;
use plan::StepPlan;
use second_order::History;
use substeps::Substeps;

/// State that a step hands to the next one.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct StepState {
    pub(crate) plan: StepPlan,
    pub(crate) history: History,
    pub(crate) budget: EnergyBudget,
    /// Time that the last frame left to the next one, in substeps, 0 to 1.
    pub(crate) time_left: f64,
    /// Mean rest length of edges \[m\], once it is needed after a change of topology.
    pub(crate) mean_rest_length: Option<f64>,
    /// Substeps of the last frame.
    pub(crate) substeps: Substeps,
    pub(crate) stats: StepStats,
}

impl StepState {
    /// Returns the allocated size in elements.
    pub(crate) fn capacity(&self) -> usize {
        self.plan.capacity() + self.history.capacity()
    }
}
