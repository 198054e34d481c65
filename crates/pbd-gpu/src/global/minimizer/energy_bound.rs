//! Bounds of the energy of a substep.
//!
//! At the rigid motion of its pieces a body has the elastic energy of the start. The objective
//! there adds the kinetic energy relative to that motion. A substep that ends with a lower
//! objective has gained no energy. Two things would break this bound: a prediction that strains
//! the body, from which iterations start, and obstacles, which move vertices after them.

use super::{Minimizer, evaluate_at};
use crate::global::objective::Objective;
use crate::global::pieces::PieceMotions;
use crate::kernels::particle_state::{ParticleState, ParticleStates};
use incise_mesh::Vec3;
use incise_mesh::geometry::to_f32;

/// Number of starts between the prediction and the rigid motion, each half as far from the latter.
const MAX_HALVINGS: i32 = 7;

/// Maximum energy by which a prediction may strain a body that turns [energies of the rotation].
///
/// Iterations from the prediction follow a rotation better than those from the bound.
const MAX_STRAIN: f64 = 8.0;

impl Minimizer {
    /// Moves the start of the iterations toward the rigid motion until it is within the bound.
    ///
    /// The prediction goes along tangents, which strains a body that turns. So first its rigid part
    /// moves onto circles.
    pub(super) fn bound_start(
        &mut self,
        particles: ParticleStates<'_>,
        objective: &Objective<'_>,
        (pieces, rotation): (&mut PieceMotions, f64),
    ) {
        if self.current.value <= self.kinetic(&self.predicted, &self.rigid) {
            // The objective of the rigid motion is larger by the elastic energy.
            return;
        }
        self.other.displacements.clone_from(&self.rigid);
        self.evaluate_other(objective);
        let bound = self.other.value;
        // False for a value that is not finite.
        let is_bounded = self.current.value <= bound + MAX_STRAIN * rotation;
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

    /// Ends a substep in which obstacles have moved vertices.
    ///
    /// If that has added energy, vertices lose velocity: first that relative to the rigid motion of
    /// their piece, then, if pins and obstacles are `still`, that of the rigid motion. Positions
    /// stay. Returns the maximum part of a displacement along an axis that the start gains \[m\].
    pub(in crate::global) fn bound_end(
        &mut self,
        particles: ParticleStates<'_>,
        objective: &Objective<'_>,
        (pieces, is_still): (&mut PieceMotions, bool),
    ) -> f32 {
        self.load(particles);
        if !self.is_obstructed {
            return 0.0;
        }
        for (cell, mass) in particles.iter().zip(&mut self.masses) {
            *mass = inertia(cell.get());
        }
        self.other.displacements.clone_from(&self.rigid);
        self.evaluate_other(objective);
        let bound = self.other.value;
        let elastic_before = bound - self.kinetic(&self.predicted, &self.rigid);
        // Without masses the objective is the elastic energy.
        let weightless = self.masses.iter().map(|_| (Vec3::zeros(), 0.0));
        let elastic = evaluate_at(
            objective,
            (&self.start, weightless),
            &self.current.displacements,
            &mut self.evaluation,
        );
        let available = self.energy_before() + elastic_before - elastic;
        let body = (&*self.start, &*self.masses);
        let moved = (&*self.current.displacements, false);
        pieces.find_rigid(body, moved, &mut self.rigid);
        let relative = self.kinetic(&self.current.displacements, &self.rigid);
        self.direction.clear();
        self.direction.resize(self.rigid.len(), Vec3::zeros());
        let rigid = self.kinetic(&self.rigid, &self.direction);
        let mut kept = f64::min(relative, bound - elastic);
        let mut rigid_kept = rigid;
        let is_bounded = is_still && !self.has_moving_pins();
        if is_bounded && rigid + f64::max(kept, 0.0) > available {
            kept = f64::min(kept, available - rigid);
            rigid_kept = f64::min(rigid, available);
        }
        let share = |kept: f64, of: f64| {
            let share = (kept.max(0.0) / of).sqrt();
            if share < 1.0 { share } else { 1.0 }
        };
        let shares = [share(kept, relative), share(rigid_kept, rigid)];
        if shares == [1.0; 2] {
            return 0.0;
        }
        self.slow_down(particles, shares)
    }

    /// Takes velocity from vertices, and returns as [`Self::bound_end`].
    ///
    /// Keeps shares of the motion relative to the rigid one and of the rigid one.
    fn slow_down(&self, particles: ParticleStates<'_>, [relative, rigid]: [f64; 2]) -> f32 {
        let mut largest = 0.0;
        let motions = self.current.displacements.iter().zip(&self.rigid);
        for ((cell, (by, of_piece)), &mass) in particles.iter().zip(motions).zip(&self.masses) {
            if mass > 0.0 {
                let ParticleState { mut x, mut d } = cell.get();
                let kept = (by - of_piece) * relative + of_piece * rigid;
                let [kx, ky, kz] = to_f32(kept);
                let lost = [d[0] - kx, d[1] - ky, d[2] - kz];
                x = [x[0] + lost[0], x[1] + lost[1], x[2] + lost[2], x[3]];
                d = [kx, ky, kz, d[3]];
                largest = lost
                    .iter()
                    .fold(largest, |largest, c| f32::max(largest, c.abs()));
                cell.set(ParticleState { x, d });
            }
        }
        largest
    }

    /// Returns the kinetic energy before the substep and the work of gravity in it.
    fn energy_before(&self) -> f64 {
        let motions = self.predicted.iter().zip(&self.current.displacements);
        let terms = motions.zip(&self.masses).map(|((predicted, by), &mass)| {
            let before = predicted - self.fall;
            mass * (before.norm_squared() / 2.0 + self.fall.dot(by))
        });
        terms.sum()
    }

    /// Returns whether a pinned vertex moves to its target.
    fn has_moving_pins(&self) -> bool {
        let mut vertices = self.predicted.iter().zip(&self.masses);
        vertices.any(|(by, &mass)| mass == 0.0 && *by != Vec3::zeros())
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

    /// Returns half of the sum of masses times squared differences, as the objective counts them.
    fn kinetic(&self, from: &[Vec3], to: &[Vec3]) -> f64 {
        let differences = from.iter().zip(to).map(|(a, b)| (a - b).norm_squared());
        let terms = self.masses.iter().zip(differences);
        terms.map(|(&mass, square)| mass * square).sum::<f64>() / 2.0
    }
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
