//! How a frame is stepped, and what was done.

use crate::error::StepError;

/// How a frame is stepped. The y axis points up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SolverParams {
    /// Projections of every constraint a substep, usually 1 to 20.
    pub iterations: u32,
    /// Parts that a frame is divided into, usually 1 to 20. More substeps make stiffer bodies than as
    /// many more iterations do.
    pub substeps: u32,
    /// Acceleration of everything [m/s^2].
    pub gravity: [f32; 3],
    /// Height of a ground plane that nothing sinks below \[m\].
    pub ground: Option<f32>,
}

impl Default for SolverParams {
    /// 16 substeps of one iteration each, no ground. Of all ways to spend about so much time, from 1 to 64 substeps of 1 to 64
    /// iterations, it lies on the front of work and precision of hung sheets, stiff and soft, in `incise-bench accuracy`, and
    /// near that of a bar: more iterations in fewer substeps leave larger errors (Macklin et al. 2019, "Small Steps in Physics
    /// Simulation").
    fn default() -> Self {
        Self {
            iterations: 1,
            substeps: 16,
            ..Self::paper()
        }
    }
}

impl SolverParams {
    /// The paper's Algorithm 1: one substep, ten iterations, no ground.
    #[must_use]
    pub const fn paper() -> Self {
        Self {
            iterations: 10,
            substeps: 1,
            gravity: [0.0, -9.81, 0.0],
            ground: None,
        }
    }

    /// Checks every number and the time step `dt` \[s\].
    ///
    /// # Errors
    /// The first one out of its range.
    pub fn check(&self, dt: f32) -> Result<(), StepError> {
        if !(dt.is_finite() && dt > 0.0) {
            return Err(StepError::BadTimeStep { value: dt });
        }
        for (name, count) in [("iteration", self.iterations), ("substep", self.substeps)] {
            if count == 0 {
                return Err(StepError::NoneOf { name });
            }
        }
        if !self.gravity.iter().all(|g| g.is_finite()) {
            return Err(StepError::NonFiniteParameter { name: "gravity" });
        }
        if self.ground.is_some_and(|height| !height.is_finite()) {
            return Err(StepError::NonFiniteParameter { name: "the ground" });
        }
        Ok(())
    }
}

/// What a frame did.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct StepStats {
    /// Substeps.
    pub substeps: u32,
    /// Passes over vertices or batches.
    pub passes: u32,
    /// Stretch constraints projected.
    pub stretch_projections: u64,
    /// Bending constraints projected.
    pub bending_projections: u64,
    /// Ground passes that ran.
    pub ground_passes: u32,
    /// Ground passes left out because the body was predicted above the ground.
    pub ground_passes_skipped: u32,
    /// No coordinate of any vertex changed by more than this, but for rounding of the sum \[m\].
    pub farthest: f32,
}
