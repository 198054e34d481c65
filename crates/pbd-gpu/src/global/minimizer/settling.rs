//! Settling: the global step of a body that has taken sweeps before.
//!
//! Sweeps leave strains of other kinds than the global step, which would turn them into motion. So
//! a substep moves vertices relative to rigid pieces with no more kinetic energy than the start of
//! its iterations, or than at [`SLACK`].

use super::Minimizer;
use super::energy_bound::kinetic;
use crate::global::pieces::PieceMotions;
use crate::kernels::particle_state::ParticleStates;

/// Maximum time for which a body settles \[s\].
pub(crate) const SETTLING_TIME: f32 = 3.0;

/// Maximum time of sweeps after a failed line search \[s\].
///
/// Sweeps project the hinges of collapsed triangles one by one; the matrix is far too soft for
/// them.
pub(crate) const FAILED_SEARCH_TIME: f32 = 0.25;

/// Maximum elastic energy of a body that need not settle.
///
/// It is relative to its kinetic energy and the work of its weight over its size.
pub(crate) const MAX_ELASTIC: f64 = 0.1;

/// Mean strain of edges whose energy is always allowed.
pub(crate) const FREE_STRAIN: f64 = 1e-4;

/// Root mean square of relative velocities that are always allowed [sizes/s].
const SLACK: f64 = 0.2;

impl Minimizer {
    /// Returns the bound of [`Self::settle`] for a substep that has begun \[kg m^2\].
    ///
    /// It is the kinetic term of the objective at the start of iterations, or that of [`SLACK`].
    /// The body has a size of `size` \[m\], the substep takes `h` \[s\].
    pub(in crate::global) fn max_relative_kinetic(&self, size: f64, h: f32) -> f64 {
        let half_mass = self.masses.iter().sum::<f64>() / 2.0;
        let kinetic = kinetic(&self.masses, &self.current.displacements, &self.rigid);
        kinetic.max(half_mass * (SLACK * size * f64::from(h)).powi(2))
    }

    /// Shortens displacements relative to rigid pieces down to a kinetic term \[kg m^2\].
    ///
    /// The pieces themselves move as predicted, since inner forces change neither their momentum
    /// nor their angular momentum about pins.
    pub(in crate::global) fn settle(
        &mut self,
        particles: ParticleStates<'_>,
        pieces: &mut PieceMotions,
        max_kinetic: f64,
    ) {
        let Self {
            start,
            masses,
            rigid: predicted_rigid,
            direction: current_rigid,
            current,
            ..
        } = self;
        let displacements = &mut current.displacements;
        pieces.find_rigid((start, masses), (displacements, true), current_rigid);
        let kinetic = kinetic(masses, displacements, current_rigid);
        let share = if kinetic > max_kinetic {
            (max_kinetic / kinetic).sqrt()
        } else {
            1.0
        };
        let vertices = displacements.iter_mut().zip(masses).zip(current_rigid);
        for (((d, mass), rigid), predicted) in vertices.zip(predicted_rigid) {
            if *mass > 0.0 {
                *d = *predicted + (*d - *rigid) * share;
            }
        }
        self.store(particles);
    }
}
