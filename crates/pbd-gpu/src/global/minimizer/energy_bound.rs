//! Bound of the energy of a substep.
//!
//! At the rigid motion of its pieces a body has the elastic energy of the start. The objective
//! there adds the kinetic energy relative to that motion. A substep that ends with a lower
//! objective has gained no energy. A prediction that strains the body may have far more, so that
//! iterations would not return below the bound.

use super::Minimizer;
use crate::global::objective::Objective;
use crate::global::pieces::PieceMotions;
use crate::kernels::particle_state::{ParticleState, ParticleStates};
use incise_mesh::Vec3;

/// Number of starts between the prediction and the rigid motion, each half as far from the latter.
const MAX_HALVINGS: i32 = 7;

/// Maximum energy by which a prediction may strain a body that turns [energies of the rotation].
///
/// Iterations from the prediction follow a rotation better than those from the bound.
pub(super) const MAX_STRAIN: f64 = 8.0;

/// [`MAX_STRAIN`] for substeps of one iteration, which turns the body less than the prediction.
pub(super) const MAX_STRAIN_ALONE: f64 = 100.0;

impl Minimizer {
    /// Moves the start of the iterations toward the rigid motion until it is within the bound.
    ///
    /// The prediction goes along tangents, which strains a body that turns. So first its rigid part
    /// moves onto circles.
    pub(super) fn bound_start(
        &mut self,
        particles: ParticleStates<'_>,
        objective: &Objective<'_>,
        (pieces, max_strain): (&mut PieceMotions, f64),
    ) {
        if self.current.value <= kinetic(&self.masses, &self.predicted, &self.rigid) {
            // The objective of the rigid motion is larger by the elastic energy.
            return;
        }
        self.other.displacements.clone_from(&self.rigid);
        self.evaluate_other(objective);
        let bound = self.other.value;
        // False for a value that is not finite.
        let is_bounded = self.current.value <= bound + max_strain;
        if is_bounded {
            return;
        }
        self.find_rigid(pieces, false);
        let way = self.current.displacements.iter().zip(&self.rigid);
        self.direction.clear();
        self.direction.extend(way.map(|(to, from)| to - from));
        self.find_rigid(pieces, true);
        for halvings in 0..=MAX_HALVINGS {
            let share = if halvings < MAX_HALVINGS {
                0.5_f64.powi(halvings)
            } else {
                0.0
            };
            let way = self.rigid.iter().zip(&self.direction);
            self.other.displacements.clear();
            (self.other.displacements).extend(way.map(|(from, by)| from + by * share));
            self.evaluate_other(objective);
            if self.other.value <= bound {
                break;
            }
        }
        std::mem::swap(&mut self.current, &mut self.other);
        self.store(particles);
    }

    /// Finds the rigid motion of the prediction and returns the energy of its rotation.
    ///
    /// It goes along tangents or with `turns` on circles. Pinned vertices move to their targets.
    pub(super) fn find_rigid(&mut self, pieces: &mut PieceMotions, turns: bool) -> f64 {
        let body = (&*self.start, &*self.masses);
        let rotation = pieces.find_rigid(body, (&self.predicted, turns), &mut self.rigid);
        let vertices = self.rigid.iter_mut().zip(&self.predicted);
        for ((rigid, predicted), &mass) in vertices.zip(&self.masses) {
            if mass == 0.0 {
                *rigid = *predicted;
            }
        }
        rotation
    }
}

/// Returns half of the sum of masses times squared differences, as the objective counts them.
pub(super) fn kinetic(masses: &[f64], from: &[Vec3], to: &[Vec3]) -> f64 {
    let differences = from.iter().zip(to).map(|(a, b)| (a - b).norm_squared());
    let terms = masses.iter().zip(differences);
    terms.map(|(&mass, square)| mass * square).sum::<f64>() / 2.0
}

/// Returns the mass of a vertex \[kg\], 0 if it is fixed.
pub(super) fn inertia(state: ParticleState) -> f64 {
    let inverse = state.x[3];
    if inverse > 0.0 {
        1.0 / f64::from(inverse)
    } else {
        0.0
    }
}
