//! Collision with the ground plane, with Coulomb friction.
//!
//! Friction in a substep is bounded by the sum of its normal corrections. A pass that needs less
//! than its bound leaves the rest to the next ones. With a separate bound for each pass, later
//! iterations would move bodies that rest on the ground, because their corrections are small.

use super::particle_state::{ParticleState, ParticleStates};
use incise_mesh::VertexId;
use std::cell::Cell;

/// Moves vertices below `ground` \[m\] onto it and applies friction to their displacement.
///
/// Friction in a substep is at most `friction` times the normal corrections. The fourth component
/// of the velocity holds the remaining bound \[m\]; it is 0 before the first pass.
#[inline(always)]
pub(crate) fn ground(
    particles: ParticleStates<'_>,
    v: &mut [[f32; 4]],
    ground: f32,
    friction: f32,
) {
    for (cell, v) in particles.iter().zip(v) {
        lift(cell, v, ground, friction);
    }
}

/// Does the same as [`ground`] for some of the vertices.
#[inline(never)]
pub(crate) fn ground_of(
    vertices: impl Iterator<Item = VertexId>,
    particles: ParticleStates<'_>,
    v: &mut [[f32; 4]],
    (ground, friction): (f32, f32),
) {
    for vertex in vertices {
        let i = vertex.index();
        lift(&particles.0[i], &mut v[i], ground, friction);
    }
}

#[inline(always)]
fn lift(cell: &Cell<ParticleState>, v: &mut [f32; 4], ground: f32, friction: f32) {
    let ParticleState { x, mut d } = cell.get();
    let depth = ground - (x[1] + d[1]);
    if depth > 0.0 && x[3] > 0.0 {
        d[1] += depth;
        let sideways = (d[0] * d[0] + d[2] * d[2]).sqrt();
        let limit = v[3] + friction * depth;
        let kept;
        (kept, v[3]) = if sideways > limit {
            (1.0 - limit / sideways, 0.0)
        } else {
            (0.0, limit - sideways)
        };
        d[0] *= kept;
        d[2] *= kept;
        cell.set(ParticleState { x, d });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernels::particle_state::on_arrays;

    #[test]
    fn the_lift_is_exact_and_friction_is_limited_by_it() {
        let x = [[0.0, 0.5, 0.0, 1.0]; 3];
        let mut d = [
            [0.3, -0.75, 0.4, 0.0],
            [0.3, -1.5, 0.4, 0.0],
            [0.3, 0.0, 0.4, 0.0],
        ];
        on_arrays(&x, &mut d, |p| ground(p, &mut [[0.0; 4]; 3], 0.0, 0.5));
        let expected = [[0.225, -0.5, 0.3], [0.0, -0.5, 0.0], [0.3, 0.0, 0.4]];
        for (d, expected) in d.iter().zip(expected) {
            for k in 0..3 {
                assert!((d[k] - expected[k]).abs() < 1e-7, "{d:?}");
            }
        }
    }

    #[test]
    fn the_friction_of_a_substep_is_limited_by_all_of_its_lifts() {
        // Lifted by 0.4 m it is held by 0.2 m at most, of which the first pass needs 0.05 m: 0.15 m
        // are left, and 0.01 m for the second lift come to them.
        let x = [[0.0, 0.0, 0.0, 1.0]];
        let mut v = [[0.0; 4]];
        let mut d = [[0.03, -0.4, 0.04, 0.0]];
        on_arrays(&x, &mut d, |p| ground(p, &mut v, 0.0, 0.5));
        assert_eq!(d[0], [0.0; 4], "it is held");
        for (pull, slips) in [(0.1, 0.0), (0.1, 0.04), (0.1, 0.14)] {
            // Pulls after the first one lift by 0.02 m and nothing.
            let sinks = if slips == 0.0 { -0.02 } else { -1e-9 };
            d[0] = [d[0][0] + pull, sinks, 0.0, 0.0];
            on_arrays(&x, &mut d, |p| ground(p, &mut v, 0.0, 0.5));
            assert!((d[0][0] - slips).abs() < 1e-6, "{d:?}, {slips} m are right");
        }
    }

    #[test]
    fn a_pinned_vertex_may_be_below() {
        let mut d = [[0.0, -1.0, 0.0, 0.0]];
        on_arrays(&[[0.0; 4]], &mut d, |p| {
            ground(p, &mut [[0.0; 4]], 0.0, 0.5)
        });
        assert_eq!(d[0][1], -1.0);
    }
}
