//! Prediction: Algorithm 1, lines 5 to 8, with `d = p - x` and a lift.
//!
//! The lift repeats a share `b` of the internal displacement `u` of the last substep, which is by
//! constraints without contacts, colliders and attachments: `d = h v + b u`. Compliances are
//! divided by `1 - b`, so that forces stay the same.
//! An iteration reduces a mode of a body to `m`, an eigenvalue in \[0, 1\] of the product of
//! projections. Its factor `g` per substep obeys `g^3 = m ((2 + b) g^2 - (1 + 2 b) g + b)`, which
//! has no root beyond 1 for all `m` exactly if `b <= 1/2`.

use super::particle_state::{ParticleState, ParticleStates};
use crate::step::constants::StepConstants;
use std::cell::Cell;

/// Adds the displacements by the last forces of cells on nodes \[N\] to the predicted ones, and
/// clears the forces. `square` is that of the substep [s²].
#[inline(always)]
pub(crate) fn repeat_forces(particles: ParticleStates<'_>, forces: &[Cell<[f32; 4]>], square: f32) {
    for (cell, force) in particles.iter().zip(forces) {
        let ParticleState { x, mut d } = cell.get();
        let by = square * x[3];
        let force = force.replace([0.0; 4]);
        for k in 0..3 {
            d[k] += by * force[k];
        }
        cell.set(ParticleState { x, d });
    }
}

/// Sets the predicted displacement of every vertex.
///
/// `corrections`, empty without a lift, hold the internal displacement of the last substep \[m\].
/// They change to the negative displacement without the lift, to which
/// [`integrate`](super::integrate::integrate) adds the final one.
#[inline(always)]
pub(crate) fn predict(
    particles: ParticleStates<'_>,
    v: &mut [[f32; 4]],
    corrections: &[Cell<[f32; 4]>],
    constants: &StepConstants,
) {
    let [gx, gy, gz] = constants.gravity_step;
    let h = constants.h;
    for (cell, v) in particles.iter().zip(v) {
        let x = cell.get().x;
        let free = if x[3] > 0.0 { 1.0 } else { 0.0 };
        *v = [
            (v[0] + gx) * free,
            (v[1] + gy) * free,
            (v[2] + gz) * free,
            0.0,
        ];
        let d = [v[0] * h, v[1] * h, v[2] * h, 0.0];
        cell.set(ParticleState { x, d });
    }
    let lift = constants.lift;
    for (cell, correction) in particles.iter().zip(corrections) {
        let ParticleState { x, d } = cell.get();
        let lift = if x[3] > 0.0 { lift } else { 0.0 };
        let last = correction.replace([-d[0], -d[1], -d[2], 0.0]);
        let d = [
            d[0] + lift * last[0],
            d[1] + lift * last[1],
            d[2] + lift * last[2],
            0.0,
        ];
        cell.set(ParticleState { x, d });
    }
}
