//! New velocities and positions: Algorithm 1, lines 10 to 13.

use super::particle_state::{ParticleState, ParticleStates};
use incise_mesh::VertexId;
use std::cell::Cell;

/// Sets `v = d / h` and adds `d` to `x`, for substeps of `h` \[s\].
///
/// Completes `corrections`, the displacements by constraints; empty without a lift. Returns the
/// largest change of a coordinate, or `None` if a position is not finite.
#[inline(always)]
pub(crate) fn integrate(
    particles: ParticleStates<'_>,
    v: &mut [[f32; 4]],
    corrections: &[Cell<[f32; 4]>],
    h: f32,
) -> Option<f32> {
    // Zero times an infinity or a NaN is a NaN, which persists in the sum.
    let mut non_finite_sum = 0.0;
    let mut max_change = 0.0;
    let max = |a: f32, b: f32| if b > a { b } else { a };
    for (cell, correction) in particles.iter().zip(corrections) {
        let ParticleState { x, d } = cell.get();
        let free = if x[3] > 0.0 { 1.0 } else { 0.0 };
        let u = correction.get();
        correction.set([
            (u[0] + d[0]) * free,
            (u[1] + d[1]) * free,
            (u[2] + d[2]) * free,
            0.0,
        ]);
    }
    for (cell, v) in particles.iter().zip(v) {
        let ParticleState { mut x, d } = cell.get();
        *v = [d[0] / h, d[1] / h, d[2] / h, 0.0];
        max_change = max(max_change, max(max(d[0].abs(), d[2].abs()), d[1].abs()));
        x[0] += d[0];
        x[1] += d[1];
        x[2] += d[2];
        non_finite_sum += (x[0] * 0.0 + x[1] * 0.0) + x[2] * 0.0;
        cell.set(ParticleState { x, d });
    }
    (non_finite_sum == 0.0).then_some(max_change)
}

/// Returns true if every position is finite, without a branch per component.
pub(crate) fn are_finite(x: &[[f32; 4]]) -> bool {
    let non_finite_sum: f32 = x
        .iter()
        .map(|x| (x[0] * 0.0 + x[1] * 0.0) + x[2] * 0.0)
        .sum();
    non_finite_sum == 0.0
}

/// Returns the first vertex with a position that is not finite, or null.
pub(crate) fn first_non_finite(x: &[[f32; 4]]) -> VertexId {
    x.iter()
        .position(|p| !p[..3].iter().all(|c| c.is_finite()))
        .map_or(VertexId::NULL, VertexId::from_index)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_that_are_not_finite_are_found() {
        for bad in [f32::NAN, f32::INFINITY] {
            for k in 0..3 {
                let mut states = [ParticleState {
                    x: [1.0; 4],
                    d: [0.5, -0.5, 0.0, 0.0],
                }; 3];
                let mut v = [[0.0; 4]; 3];
                let max_change = integrate(ParticleStates::new(&mut states), &mut v, &[], 0.01);
                assert_eq!(max_change, Some(0.5), "finite");
                assert_eq!(v[0], [50.0, -50.0, 0.0, 0.0]);
                assert!(are_finite(&states.map(|state| state.x)), "finite");
                states[1].d[k] = bad;
                let max_change = integrate(ParticleStates::new(&mut states), &mut v, &[], 0.01);
                assert_eq!(max_change, None, "{bad} at {k}");
                let x = states.map(|state| state.x);
                assert_eq!(first_non_finite(&x), VertexId(1));
                assert!(!are_finite(&x), "{bad} at {k}");
            }
        }
    }
}
