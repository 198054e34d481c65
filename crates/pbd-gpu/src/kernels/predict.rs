//! Prediction: Algorithm 1, lines 5 to 8, with `d = p - x`.

use super::particle_state::{ParticleState, ParticleStates};
use crate::step::constants::StepConstants;

/// Sets the predicted displacement of every vertex.
#[inline(always)]
pub(crate) fn predict(
    particles: ParticleStates<'_>,
    v: &mut [[f32; 4]],
    constants: &StepConstants,
) {
    let [gx, gy, gz] = constants.gravity_step;
    let (h, kept) = (constants.h, constants.velocity_factor);
    for (cell, v) in particles.iter().zip(v) {
        let x = cell.get().x;
        let free = if x[3] > 0.0 { 1.0 } else { 0.0 };
        let kept = kept * free;
        *v = [
            (v[0] + gx) * kept,
            (v[1] + gy) * kept,
            (v[2] + gz) * kept,
            0.0,
        ];
        let d = [v[0] * h, v[1] * h, v[2] * h, 0.0];
        cell.set(ParticleState { x, d });
    }
}
