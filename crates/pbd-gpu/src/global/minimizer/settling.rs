//! Settling: the global step of a body that has taken sweeps before.
//!
//! Sweeps leave strains of other kinds than the global step, which would turn them into motion. So
//! a substep moves vertices relative to rigid pieces with no more energy than the start of its
//! iterations, or slowly.

use super::Minimizer;
use crate::global::pieces::PieceMotions;
use crate::kernels::particle_state::ParticleStates;

/// Maximum time for which a body settles \[s\].
pub(crate) const SETTLING_TIME: f32 = 3.0;

/// Time for which a body takes sweeps before it settles, once its iterations have found no way
/// \[s\].
///
/// Collapsed triangles bar it: hinges on them are far stiffer than the matrix, and each sweep
/// projects them one by one.
pub(crate) const BLOCKED_TIME: f32 = 0.25;

/// Maximum elastic energy of a body that need not settle, relative to its kinetic energy and the
/// work of its weight over its size.
pub(crate) const MAX_ELASTIC: f64 = 0.1;

/// Mean strain of edges whose energy is always allowed.
pub(crate) const FREE_STRAIN: f64 = 1e-4;

/// Root mean square of relative velocities that are always allowed [sizes/s].
const SLACK: f64 = 0.2;

impl Minimizer {
    /// Returns the relative motion of a substep that has begun, half of masses times squared
    /// displacements \[kg m^2\].
    ///
    /// The body has a size of `size` \[m\], the substep takes `h` \[s\].
    pub(in crate::global) fn relative_motion(&self, size: f64, h: f32) -> f64 {
        let half_mass = self.masses.iter().sum::<f64>() / 2.0;
        let motion = self.kinetic(&self.current.displacements, &self.rigid);
        motion.max(half_mass * (SLACK * size * f64::from(h)).powi(2))
    }

    /// Shortens displacements relative to rigid pieces down to the motion `most` \[kg m^2\].
    ///
    /// The pieces themselves move as predicted, since inner forces change neither their momentum
    /// nor their angular momentum about pins.
    pub(in crate::global) fn settle(
        &mut self,
        particles: ParticleStates<'_>,
        pieces: &mut PieceMotions,
        most: f64,
    ) {
        let Self {
            start,
            masses,
            rigid: predicted,
            direction: rigid,
            current,
            ..
        } = self;
        let displacements = &mut current.displacements;
        pieces.find_rigid((start, masses), (displacements, true), rigid);
        let moved = displacements.iter().zip(&*rigid).zip(&*masses);
        let motion = moved.map(|((d, rigid), mass)| mass * (d - rigid).norm_squared() / 2.0);
        let motion: f64 = motion.sum();
        let share = if motion > most {
            (most / motion).sqrt()
        } else {
            1.0
        };
        let vertices = displacements.iter_mut().zip(masses).zip(rigid);
        for (((d, mass), rigid), predicted) in vertices.zip(predicted) {
            if *mass > 0.0 {
                *d = *predicted + (*d - *rigid) * share;
            }
        }
        self.store(particles);
    }
}
