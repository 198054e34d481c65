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
    /// A substep's iterations end early, as soon as one of them moves no vertex by this or more along any axis \[m\].
    /// Near its shape at rest a body's iterations move it ever less, so that a vertex ends a substep at most as many residuals
    /// off as iterations were left out; in a body that crumples it may be more. 0 leaves out none; `None` does not even
    /// look, and costs nothing.
    ///
    /// A device does all iterations: they are with it before the first is done. A single iteration has nothing to leave out.
    pub residual: Option<f32>,
    /// The part of its own weight `w = sum of |grad C|^2 / m` that a compliant constraint is projected against, 1/2 to 1:
    /// a projection divides by the greater of `w` and `compliance / h^2 + own_weight w`. 1 is XPBD's.
    ///
    /// In a sweep a constraint sees what those before it did and nothing of those after it, so with half of its own
    /// weight it sees the half of everything, and what a single iteration leaves is of second order in the
    /// substep; with all of it soft bodies move as if they were softer and damped. A projection never goes past the
    /// rest value: a rigid constraint, or one of the paper's stiffness, is projected as ever, and more iterations tend to the same.
    pub own_weight: f32,
    /// Whether vertices of a body that does not stretch are held to within reach of where it is pinned: see [`Tether`](crate::Tether).
    /// A pass more an iteration over such a body, and none over others.
    pub tethers: bool,
    /// How a substep leads from one state to the next.
    pub integrator: Integrator,
}

/// How a substep leads from one state to the next.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Integrator {
    /// Implicit Euler: of first order. What moves loses energy, the more the longer a substep is.
    #[default]
    Euler,
    /// The second backward difference formula, `(3 x' - 4 x + x0) / 2h = v'`: of second order, for a pass more over the
    /// vertices a substep. A substep is one of implicit Euler, two thirds as long, from `(4 x - x0) / 3` and `(4 v - v0) / 3`,
    /// so constraints are projected as ever. Needs the state of a substep before: the first substep of a motion, and the
    /// one after anything else has changed positions, velocities, masses or the time step, or after the body has come near the
    /// ground, is one of implicit Euler. It takes nothing of the energy, so what iterations leave of rigid constraints is not damped
    /// either: a body that is held gains without end by 16 substeps of one iteration, and several times what there was by 16 of four. It is for bodies with compliance. Only [`Solver::step`](crate::Solver::step) and
    /// [`Solver::step_on`](crate::Solver::step_on) have it; a device refuses it.
    Bdf2,
}

impl Default for SolverParams {
    /// 16 substeps of one iteration each against half of the own weight, no ground. Of all ways to spend about so much time,
    /// from 1 to 64 substeps of 1 to 64 iterations, it lies on or near the front of work and precision of what `incise-bench
    /// accuracy` moves: more iterations in fewer substeps leave larger errors (Macklin et al. 2019, "Small Steps in
    /// Physics Simulation"), and all of the own weight leaves a soft body softer and slower than it is.
    fn default() -> Self {
        Self {
            iterations: 1,
            substeps: 16,
            own_weight: 0.5,
            tethers: true,
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
            residual: None,
            own_weight: 1.0,
            tethers: false,
            integrator: Integrator::Euler,
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
        if let Some(value) = self.residual
            && !(value.is_finite() && value >= 0.0)
        {
            return Err(StepError::BadResidual { value });
        }
        if !(0.5..=1.0).contains(&self.own_weight) {
            let value = self.own_weight;
            return Err(StepError::BadOwnWeight { value });
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
    /// Iterations left out, of all substeps: what they would have moved was below [`SolverParams::residual`].
    pub iterations_skipped: u32,
    /// Stretch constraints projected.
    pub stretch_projections: u64,
    /// Bending constraints projected.
    pub bending_projections: u64,
    /// Struts projected.
    pub strut_projections: u64,
    /// Contacts looked at, whether they touched or not.
    pub contact_projections: u64,
    /// Volume constraints projected.
    pub volume_projections: u64,
    /// Ground passes that ran.
    pub ground_passes: u32,
    /// Ground passes left out because the body was predicted above the ground.
    pub ground_passes_skipped: u32,
    /// No coordinate of any vertex changed by more than this, but for rounding of the sum \[m\].
    pub farthest: f32,
    /// No coordinate of any vertex changed by more than this in a substep \[m\].
    pub farthest_substep: f32,
}
