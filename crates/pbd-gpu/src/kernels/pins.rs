//! Moves pinned vertices toward their targets.

use super::particle_state::ParticleStates;
use crate::particles::Pin;

/// Moves every pinned vertex so that it reaches its target with the last of `substeps_left`.
#[inline(always)]
pub(crate) fn pins(particles: ParticleStates<'_>, pins: &[Pin], substeps_left: u32) {
    let share = 1.0 / substeps_left as f32;
    for pin in pins {
        let i = pin.vertex.index();
        let x = particles.get(i).x;
        let way = |k: usize| (pin.target[k] - x[k]) * share;
        particles.set_d(i, [way(0), way(1), way(2), 0.0]);
    }
}
