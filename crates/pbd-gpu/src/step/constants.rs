//! Constants of a frame that kernels read, with the coefficients of one projection of each kind.
//!
//! The coefficients follow from the stiffness of a material and the length of a substep.

use crate::error::StepError;
use crate::kernels::bending::{FIRM, HOLD, RECOVERY};
use crate::kernels::cells::CellConstants;
use crate::kernels::volume;
use crate::material::{Stiffness, Volume};
use crate::step::params::SolverParams;
use std::num::NonZeroUsize;

/// The constants of a frame that kernels read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepConstants {
    /// Time step of a substep \[s\].
    pub h: f32,
    /// Substeps of the frame.
    pub substeps: u32,
    /// Rounds of contacts and volumes per iteration.
    pub(crate) contact_rounds: u32,
    /// Time of the frame per substep, by which colliders move \[s\].
    pub(crate) collider_step: f32,
    /// Share of the last internal displacement that the prediction repeats.
    pub lift: f32,
    /// Change of velocity by gravity per substep [m/s].
    pub gravity_step: [f32; 3],
    /// Coefficients of stretch constraints.
    pub stretch: Projection,
    /// Coefficients of bending constraints.
    pub bending: Projection,
    /// Coefficients of interior springs.
    pub interior_springs: Projection,
    /// Coefficients of volume constraints.
    pub volume: VolumeProjection,
    /// Coefficients of the cells of a solid.
    pub(crate) cells: CellConstants,
    /// Coulomb friction coefficient.
    pub friction: f32,
    /// Displacement per iteration and axis below which the iterations of a substep end \[m\].
    pub residual: Option<f32>,
    /// As in [`SolverParams`](crate::SolverParams).
    pub threads: Option<NonZeroUsize>,
}

impl StepConstants {
    /// Checks the substep, which is shorter than that of the parameters in a body above a plane,
    /// and that all coefficients are finite.
    ///
    /// # Errors
    /// [`StepError::SubstepTooShort`].
    pub(crate) fn check(&self) -> Result<(), StepError> {
        let projections = [&self.stretch, &self.bending, &self.interior_springs];
        let alphas = projections.map(|projection| projection.alpha);
        let are_finite =
            alphas.iter().all(|alpha| alpha.is_finite()) && self.volume.alpha.is_finite();
        if are_finite && self.h >= SolverParams::MIN_SUBSTEP {
            return Ok(());
        }
        Err(StepError::SubstepTooShort { h: self.h })
    }

    /// Returns whether any kind of constraint accumulates its multipliers.
    pub(crate) fn accumulates_lambda(&self) -> bool {
        self.stretch.accumulates_lambda
            || self.bending.accumulates_lambda
            || self.interior_springs.accumulates_lambda
            || self.volume.accumulates_lambda
    }
}

/// Coefficients of one projection of a constraint.
///
/// `delta_lambda = -factor (C + alpha lambda) / max(w, alpha + diagonal_scale w)` with
/// `w = sum of |grad C|^2 / m`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Projection {
    /// Fraction of the error that one projection removes.
    pub factor: f32,
    /// `alpha_tilde = compliance / h^2`, over `1 - lift`.
    pub alpha: f32,
    /// As in [`SolverParams`](crate::SolverParams).
    pub diagonal_scale: f32,
    /// Whether multipliers accumulate over the iterations of a substep. A rigid constraint
    /// needs none, nor does a volume in a single iteration.
    pub accumulates_lambda: bool,
    /// Maximum correction of an angle's old error in a substep \[rad\]; bending only.
    ///
    /// Applies where bending is rigid and edges are soft.
    pub recovery: f32,
    /// Stiffness of the edges that bending works against \[kg\]; bending only.
    pub edge_stiffness: f32,
}

impl Projection {
    /// The projection of constraints that a body does not have.
    pub(crate) const NONE: Self = Self {
        factor: 0.0,
        alpha: 0.0,
        diagonal_scale: 1.0,
        accumulates_lambda: false,
        recovery: 0.0,
        edge_stiffness: 0.0,
    };

    /// Returns true if the correction depends on multipliers or on errors before the substep.
    pub(crate) fn has_history(&self) -> bool {
        self.accumulates_lambda || self.edge_stiffness < FIRM
    }

    /// Returns the projection of bending for edges of compliance `alpha`.
    pub(crate) fn beside_edges(self, alpha: f32) -> Self {
        let stiffness = HOLD / alpha;
        Self {
            edge_stiffness: if stiffness < FIRM { stiffness } else { FIRM },
            ..self
        }
    }
}

impl Stiffness {
    /// Returns the coefficients of one projection, for `projections` in a substep of `h` \[s\].
    pub(crate) fn projection(self, projections: u32, h: f32) -> Projection {
        match self {
            Self::Pbd(k) => Projection {
                factor: fraction_per_projection(k, projections),
                alpha: 0.0,
                diagonal_scale: 1.0,
                accumulates_lambda: false,
                recovery: RECOVERY * h,
                edge_stiffness: FIRM,
            },
            Self::Compliance(compliance) => Projection {
                factor: 1.0,
                alpha: compliance / (h * h),
                diagonal_scale: 1.0,
                accumulates_lambda: compliance > 0.0 && projections > 1,
                recovery: RECOVERY * h,
                edge_stiffness: FIRM,
            },
        }
    }
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "a number between 0 and 1 is rounded to storage"
)]
fn fraction_per_projection(k: f32, projections: u32) -> f32 {
    (1.0 - (1.0 - f64::from(k)).powf(1.0 / f64::from(projections))) as f32
}

/// Coefficients of one projection of a volume constraint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VolumeProjection {
    /// `compressibility / h^2` of a rest volume of 1 m^3, over `1 - lift`.
    pub alpha: f32,
    /// As in [`Volume`].
    pub pressure: f32,
    /// As in [`SolverParams`](crate::SolverParams).
    pub diagonal_scale: f32,
    /// Maximum correction of an old error per projection, as a fraction of the rest volume;
    /// unbounded for a compressible one.
    pub recovery: f32,
    /// Whether heavy pieces press thin ones in the frame. Crushed pieces then recover faster.
    pub is_pressed: bool,
    /// Displacement per projection that carries the weight \[m\].
    pub sink: f32,
    /// As in [`Projection`].
    pub accumulates_lambda: bool,
}

impl VolumeProjection {
    /// The projection of a body without volume constraints.
    pub(crate) const NONE: Self = Self {
        alpha: 0.0,
        pressure: 1.0,
        diagonal_scale: 1.0,
        recovery: 0.0,
        is_pressed: false,
        sink: 0.0,
        accumulates_lambda: false,
    };
}

impl Volume {
    /// Returns the coefficients of one projection, for `iterations` of a substep of `h` \[s\] that
    /// adds `gravity_step` to velocities [m/s].
    pub(crate) fn projection(
        self,
        iterations: u32,
        h: f32,
        gravity_step: [f32; 3],
    ) -> VolumeProjection {
        let [x, y, z] = gravity_step;
        let fall = h * (x * x + y * y + z * z).sqrt();
        let is_rigid = self.compressibility == 0.0;
        VolumeProjection {
            alpha: self.compressibility / (h * h),
            pressure: self.pressure,
            recovery: if is_rigid {
                volume::RECOVERY * h / iterations as f32
            } else {
                FIRM
            },
            sink: volume::LOADS * fall,
            accumulates_lambda: !is_rigid && iterations > 1,
            ..VolumeProjection::NONE
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn n_projections_remove_the_fraction_of_the_stiffness() {
        for (k, n) in [(0.2, 1), (0.2, 10), (0.9, 7), (1.0, 10), (0.0, 3)] {
            let share = f64::from(Stiffness::Pbd(k).projection(n, 0.01).factor);
            let left = (1.0 - share).powi(n.cast_signed());
            assert!((left - (1.0 - f64::from(k))).abs() < 1e-6, "k {k}, n {n}");
        }
    }
}
