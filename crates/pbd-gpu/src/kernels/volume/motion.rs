//! Motion of pieces from round to round, which Nesterov's method accelerates.
//!
//! A round passes on a part of an impulse that is proportional to the mass of the lighter piece. So
//! beneath a heavy piece the motion of whole pieces converges last. A piece therefore adds
//! `(k - 1) / (k + 2)` of its mean displacement since the last round in round `k` (Nesterov 1983;
//! for contacts Mazhar et al. 2015, "Using Nesterov's method to accelerate multibody dynamics with
//! friction and contact"). Then `n` rounds do as much as `n^2 / 4` without.
//!
//! Contacts do not take back too large a step. Each one is therefore small relative to the fall in
//! a substep, which suffices for weights but throws nothing. Single vertices do not add theirs:
//! light ones between a contact and a volume would be thrown.

use super::tree::{total_of, tree};
use super::{CHUNK, RingVertex};
use crate::kernels::particle_state::ParticleStates;

/// Maximum step of a piece in a round, relative to the displacement that carries its weight.
pub(crate) const STEP: f32 = 0.125;

/// Sum of mass times displacement \[kg m\], and mass \[kg\].
type Motion = [f32; 4];

/// A round of contacts and volumes in an iteration.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Round {
    /// Its number, from 0.
    pub(crate) number: u32,
    /// Number of rounds of the iteration.
    pub(crate) count: u32,
}

impl Round {
    /// Returns whether the iteration has other rounds.
    pub(super) fn has_others(self) -> bool {
        self.count > 1
    }

    /// Moves a piece on by a part of its mean displacement since the last round, and stores the
    /// displacement before that. `sink` carries its weight \[m\].
    pub(super) fn proceed(
        self,
        particles: ParticleStates<'_>,
        (spokes, sink): (&[RingVertex], f32),
        displacement: &mut [f32; 3],
        partial: &mut Vec<Motion>,
    ) {
        let [x, y, z, mass] = sum(particles, spokes, partial);
        let mean = [x, y, z].map(|c| if mass > 0.0 { c / mass } else { 0.0 });
        let before = std::mem::replace(displacement, mean);
        let moved = [0, 1, 2].map(|k: usize| mean[k] - before[k]);
        let number = self.number as f32;
        let factor = if self.number > 1 {
            (number - 1.0) / (number + 2.0)
        } else {
            0.0
        };
        let square = moved[0] * moved[0] + moved[1] * moved[1] + moved[2] * moved[2];
        let (length, most) = (factor * square.sqrt(), STEP * sink);
        let factor = if length > most {
            factor * (most / length)
        } else {
            factor
        };
        let [x, y, z] = moved.map(|c| factor * c);
        for spoke in spokes {
            let v = spoke.vertex.index();
            if particles.get(v).x[3] > 0.0 {
                particles.add_d(v, [x, y, z, 0.0]);
            }
        }
    }
}

/// Returns the sums of a piece, in which pinned vertices have no mass.
fn sum(particles: ParticleStates<'_>, spokes: &[RingVertex], partial: &mut Vec<Motion>) -> Motion {
    let add = |a: f32, b: f32| a + b;
    partial.clear();
    partial.extend(spokes.chunks(CHUNK).map(|spokes| {
        let mut columns = [[0.0; CHUNK]; 4];
        for (i, spoke) in spokes.iter().enumerate() {
            let state = particles.get(spoke.vertex.index());
            let w = state.x[3];
            let mass = if w > 0.0 { 1.0 / w } else { 0.0 };
            let [x, y, z, _] = state.d;
            let leaf = [mass * x, mass * y, mass * z, mass];
            for (column, number) in columns.iter_mut().zip(leaf) {
                column[i] = number;
            }
        }
        tree(&mut columns, spokes.len(), add)
    }));
    total_of(partial, add)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::constraints::volumes::VolumeSet;
    use crate::kernels::particle_state::ParticleState;
    use incise_models::{Model, build_model};

    /// A piece of two chunks, with one pinned vertex, that is pushed in every round.
    #[test]
    fn a_piece_moves_on_as_a_whole() {
        let surface = build_model(Model::Sphere768);
        let mut set = VolumeSet::default();
        set.update(&surface);
        let count = set.spokes.len();
        assert!(count > CHUNK);
        let inverse_mass = |i: usize| match i {
            5 => 0.0,
            _ => 1.0 + 0.01 * i as f32,
        };
        let mut states: Vec<_> = (0..count)
            .map(|i| ParticleState {
                x: [0.0, 0.0, 0.0, inverse_mass(i)],
                d: [0.0; 4],
            })
            .collect();
        let mean = |states: &[ParticleState]| {
            let free = states.iter().filter(|state| state.x[3] > 0.0);
            free.fold((0.0, 0.0), |(sum, mass), state| {
                let m = 1.0 / f64::from(state.x[3]);
                (sum + m * f64::from(state.d[0]), mass + m)
            })
        };
        let (mut partial, mut stored, mut last) = (Vec::new(), [0.0; 3], 0.0);
        let factors = [0.0, 0.0, 0.25, 0.4, 0.5, 4.0 / 7.0];
        for (number, factor) in (0..).zip(factors) {
            let push = |i: usize| 0.1 + 0.001 * ((i * (number as usize + 3)) % 17) as f32;
            let free = states.iter_mut().enumerate().filter(|(i, _)| *i != 5);
            free.for_each(|(i, state)| state.d[0] += push(i));
            let before = states.clone();
            let (sum, mass) = mean(&before);
            let round = Round { number, count: 9 };
            let particles = ParticleStates::new(&mut states);
            // The last step is limited.
            let sink = if number == 5 { 0.08 } else { 1e3 };
            let spokes = (&*set.spokes, sink);
            round.proceed(particles, spokes, &mut stored, &mut partial);
            let expected = f64::min(factor * (sum / mass - last), f64::from(sink * STEP));
            last = sum / mass;
            for (i, (state, before)) in states.iter().zip(&before).enumerate() {
                let moved = f64::from(state.d[0] - before.d[0]);
                let expected = if i == 5 { 0.0 } else { expected };
                assert!((moved - expected).abs() < 2e-7, "{moved}, round {number}");
            }
        }
    }
}
