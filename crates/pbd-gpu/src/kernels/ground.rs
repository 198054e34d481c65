//! The ground plane with Coulomb's friction.
//!
//! The push of a substep is all of its lifts, and friction holds by that: what one pass did not need, the next ones have
//! left. A body at rest sinks by gravity before the first pass and by next to nothing before the others. Held by
//! each pass's own lift alone it gave way to the last iterations' pulls, and pieces that lay on the ground crept on for ever
//! (measured: 8 vertices of a ball in six pieces, turning by 0.012 rad/s).

use super::displacements::Displacements;

/// Lifts what is below `ground` \[m\] and takes back its sideways displacement, in a substep by no more than
/// `friction` times its lifts. What is left of that \[m\] waits in the fourth entry of the velocity, which is 0 before
/// the first pass.
#[inline(always)]
pub(crate) fn ground(
    x: &[[f32; 4]],
    d: &mut impl Displacements,
    v: &mut [[f32; 4]],
    ground: f32,
    friction: f32,
) {
    for (i, (x, v)) in x.iter().zip(v).enumerate() {
        let mut di = d.get(i);
        let depth = ground - (x[1] + di[1]);
        if depth > 0.0 && x[3] > 0.0 {
            di[1] += depth;
            let sideways = (di[0] * di[0] + di[2] * di[2]).sqrt();
            let limit = v[3] + friction * depth;
            let kept;
            (kept, v[3]) = if sideways > limit {
                (1.0 - limit / sideways, 0.0)
            } else {
                (0.0, limit - sideways)
            };
            di[0] *= kept;
            di[2] *= kept;
            d.set(i, di);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lift_is_exact_and_friction_is_limited_by_it() {
        let x = [[0.0, 0.5, 0.0, 1.0]; 3];
        let mut d = [
            [0.3, -0.75, 0.4, 0.0],
            [0.3, -1.5, 0.4, 0.0],
            [0.3, 0.0, 0.4, 0.0],
        ];
        ground(&x, &mut d, &mut [[0.0; 4]; 3], 0.0, 0.5);
        let expected = [[0.225, -0.5, 0.3], [0.0, -0.5, 0.0], [0.3, 0.0, 0.4]];
        for (d, expected) in d.iter().zip(expected) {
            for k in 0..3 {
                assert!((d[k] - expected[k]).abs() < 1e-7, "{d:?}");
            }
        }
    }

    #[test]
    fn the_friction_of_a_substep_is_limited_by_all_of_its_lifts() {
        // Lifted by 0.4 m it is held by 0.2 m at most, of which the first pass needs 0.05 m: 0.15 m are left, and
        // 0.01 m for the second lift come to them.
        let x = [[0.0, 0.0, 0.0, 1.0]];
        let mut v = [[0.0; 4]];
        let mut d = [[0.03, -0.4, 0.04, 0.0]];
        ground(&x, &mut d, &mut v, 0.0, 0.5);
        assert_eq!(d[0], [0.0; 4], "it is held");
        for (pull, slips) in [(0.1, 0.0), (0.1, 0.04), (0.1, 0.14)] {
            // Pulls after the first one lift by 0.02 m and nothing.
            let sinks = if slips == 0.0 { -0.02 } else { -1e-9 };
            d[0] = [d[0][0] + pull, sinks, 0.0, 0.0];
            ground(&x, &mut d, &mut v, 0.0, 0.5);
            assert!((d[0][0] - slips).abs() < 1e-6, "{d:?}, {slips} m are right");
        }
    }

    #[test]
    fn a_pinned_vertex_may_be_below() {
        let mut d = [[0.0, -1.0, 0.0, 0.0]];
        ground(&[[0.0; 4]], &mut d, &mut [[0.0; 4]], 0.0, 0.5);
        assert_eq!(d[0][1], -1.0);
    }
}
