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

#[cfg(feature = "global")]
use crate::global::GlobalStep;

/// The global step of a build without it: files have its place, and it is never there.
#[cfg(all(feature = "serde", not(feature = "global")))]
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub(crate) enum GlobalStep {}

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
    /// The global step of a body that takes it when it touches nothing.
    #[cfg(any(feature = "global", feature = "serde"))]
    pub(crate) global: Option<Box<GlobalStep>>,
    /// The scheme of the body in this frame, which the CPU steps.
    #[cfg(feature = "global")]
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) choice: crate::global::Choice,
    /// The size of the body since its last edit, once a frame has asked for it.
    #[cfg(feature = "global")]
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) extent: Option<crate::global::Extent>,
    /// Whether parameters, material and time step chose the global step in the last frame.
    #[cfg(any(feature = "global", feature = "serde"))]
    pub(crate) was_global_chosen: bool,
    /// Remaining time of settling \[s\]; above `SETTLING_TIME` the body takes sweeps first.
    #[cfg(any(feature = "global", feature = "serde"))]
    pub(crate) settling_time_left: f32,
}

impl StepState {
    /// Returns the allocated size in elements.
    pub(crate) fn capacity(&self) -> usize {
        #[cfg(feature = "global")]
        let global = self.global.as_ref().map_or(0, |global| global.capacity());
        #[cfg(not(feature = "global"))]
        let global = 0;
        self.plan.capacity() + self.history.capacity() + global
    }
}
