//! What a frame is stepped by: its plan, and the numbers that kernels read.

use crate::error::StepError;
use crate::material::{Projection, Stiffness, Volume, VolumeProjection};
use crate::params::{Integrator, SolverParams};
use crate::plan::{PlanKey, StepConstants};
use crate::second_order::SHORTER;
use crate::solver::Solver;
use crate::struts::OWN_WEIGHT;

/// For how many of its own lengths a long substep's errors are there. Measured on a limp ball, ten iterations a frame
/// of 1/600 to 1/60 s at random, 18 times 600 frames: with 1 its energy grows by up to 80 %, with 3 by 9 %, with 10 and more not at all.
const AFTERMATH: f32 = 10.0;

impl Solver {
    /// Brings the plan up to date and finds the numbers of a frame.
    ///
    /// # Errors
    /// [`StepError::TooShort`]; nothing is changed then.
    pub(crate) fn prepare(
        &mut self,
        dt: f32,
        params: &SolverParams,
    ) -> Result<StepConstants, StepError> {
        let mut constants = self.constants(dt, params);
        constants.check()?;
        let sizes = self.volumes.pieces().iter().map(|piece| piece.rest().abs());
        let largest = sizes.fold(0.0, f32::max);
        // What kernels reckon with is that of a piece.
        if !(constants.volume.alpha * largest).is_finite() {
            return Err(StepError::TooShort { h: constants.h });
        }
        if params.integrator == Integrator::Bdf2 {
            (self.constants_of(SHORTER * constants.h, 1, params)).check()?;
        }
        constants.keep(self.kept_errors(dt, constants.h));
        let tethers = params.tethers && !self.pins.is_empty() && self.material.stretch.is_rigid();
        if tethers {
            let slots = self.mass.len();
            self.tethers.update(&self.stretch, &self.pins, slots);
        }
        let key = PlanKey {
            tethers,
            iterations: params.iterations,
            pins: !self.pins.is_empty(),
            volumes: !self.volumes.pieces().is_empty(),
            contacts: !self.contacts.is_empty(),
            colliders: !self.colliders.records.is_empty(),
            ground: params.ground.is_some(),
            multipliers: constants.keeps_multipliers()
                || params.iterations > 1 && !self.contacts.is_empty(),
        };
        let struts = self.struts.as_ref();
        (self.plan).update(key, &self.stretch, self.bending.as_ref(), struts);
        Ok(constants)
    }

    /// The part of old errors that rigid constraints leave in a frame of `dt` and substeps of `h` \[s\]: as velocities follow
    /// from displacements, what a long substep's iterations left would be a blow in a short one. It comes back as fast as in a
    /// substep as long as the longest one lately, which counts for [`AFTERMATH`] of its lengths.
    fn kept_errors(&mut self, dt: f32, h: f32) -> f32 {
        let longest = self.longest;
        if h >= longest {
            self.longest = h;
            return 0.0;
        }
        self.longest -= dt / AFTERMATH;
        1.0 - h / longest
    }

    fn constants(&self, dt: f32, params: &SolverParams) -> StepConstants {
        self.constants_of(dt / params.substeps as f32, params.substeps, params)
    }

    /// The numbers of substeps of `h` \[s\].
    pub(crate) fn constants_of(
        &self,
        h: f32,
        substeps: u32,
        params: &SolverParams,
    ) -> StepConstants {
        let slowed = 1.0 + self.material.damping * h;
        // Damping holds back what constraints push as it does what gravity pulls: else it would hold up a soft
        // body that hangs at rest.
        let projection = |stiffness: Stiffness| {
            let projection = stiffness.projection(params.iterations, h);
            Projection {
                alpha: projection.alpha * slowed,
                own_weight: params.own_weight,
                ..projection
            }
        };
        let stretch = projection(self.material.stretch);
        let bending = |stiffness| projection(stiffness).beside_edges(stretch.alpha);
        let volume = |volume: Volume| {
            let projection = volume.projection(params.iterations, h);
            VolumeProjection {
                alpha: projection.alpha * slowed,
                own_weight: params.own_weight,
                ..projection
            }
        };
        StepConstants {
            h,
            substeps,
            gravity_step: params.gravity.map(|g| g * h),
            kept_velocity: 1.0 / slowed,
            stretch,
            bending: self.material.bending.map_or(Projection::NONE, bending),
            struts: (self.material.struts).map_or(Projection::NONE, |struts| Projection {
                own_weight: OWN_WEIGHT,
                ..projection(struts.stiffness)
            }),
            volume: (self.material.volume).map_or(VolumeProjection::NONE, volume),
            ground: params.ground.unwrap_or(f32::NEG_INFINITY),
            friction: self.material.friction,
            // A single iteration has nothing to leave out.
            residual: params.residual.filter(|_| params.iterations > 1),
        }
    }
}
