//! The ground plane with Coulomb's friction.

use super::displacements::Displacements;

/// Lifts what is below `ground` \[m\] and takes back its sideways displacement, by no more than
/// `friction` times the lift.
#[inline(always)]
pub(crate) fn ground(x: &[[f32; 4]], d: &mut impl Displacements, ground: f32, friction: f32) {
    for (i, x) in x.iter().enumerate() {
        let mut di = d.get(i);
        let depth = ground - (x[1] + di[1]);
        if depth > 0.0 && x[3] > 0.0 {
            di[1] += depth;
            let sideways = (di[0] * di[0] + di[2] * di[2]).sqrt();
            let limit = friction * depth;
            let kept = if sideways > limit {
                1.0 - limit / sideways
            } else {
                0.0
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
        ground(&x, &mut d, 0.0, 0.5);
        let expected = [[0.225, -0.5, 0.3], [0.0, -0.5, 0.0], [0.3, 0.0, 0.4]];
        for (d, expected) in d.iter().zip(expected) {
            for k in 0..3 {
                assert!((d[k] - expected[k]).abs() < 1e-7, "{d:?}");
            }
        }
    }

    #[test]
    fn a_pinned_vertex_may_be_below() {
        let mut d = [[0.0, -1.0, 0.0, 0.0]];
        ground(&[[0.0; 4]], &mut d, 0.0, 0.5);
        assert_eq!(d[0][1], -1.0);
    }
}
