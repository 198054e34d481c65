//! New velocities and positions: Algorithm 1, lines 10 to 13.

use super::displacements::Displacements;
use crate::plan::StepConstants;
use incise_mesh::VertexId;

/// Sets `v = d / h` and adds `d` to `x`. What constraints dragged below the ground after its last pass,
/// or while it was skipped, is put on it. Returns the largest change of a coordinate, none when a
/// position is no longer finite.
#[inline(always)]
pub(crate) fn integrate(
    x: &mut [[f32; 4]],
    d: &mut impl Displacements,
    v: &mut [[f32; 4]],
    constants: &StepConstants,
) -> Option<f32> {
    let (h, ground) = (constants.h, constants.ground);
    // Zero times a number is zero; times infinity or no number it is no number, which stays in the sum.
    let mut alarm = 0.0;
    let mut farthest = 0.0;
    let most = |a: f32, b: f32| if b > a { b } else { a };
    for (i, (x, v)) in x.iter_mut().zip(v).enumerate() {
        let d = d.get(i);
        let floor = if x[3] > 0.0 {
            ground
        } else {
            f32::NEG_INFINITY
        };
        let y = x[1] + d[1];
        *v = [d[0] / h, d[1] / h, d[2] / h, 0.0];
        let y = if y < floor { floor } else { y };
        let across = most(d[0].abs(), d[2].abs());
        farthest = most(farthest, most(across, (y - x[1]).abs()));
        x[0] += d[0];
        x[1] = y;
        x[2] += d[2];
        alarm += (x[0] * 0.0 + x[1] * 0.0) + x[2] * 0.0;
    }
    (alarm == 0.0).then_some(farthest)
}

/// Whether every position is finite. The way of [`integrate`]: no branch an entry.
pub(crate) fn are_finite(x: &[[f32; 4]]) -> bool {
    let alarm: f32 = x
        .iter()
        .map(|x| (x[0] * 0.0 + x[1] * 0.0) + x[2] * 0.0)
        .sum();
    alarm == 0.0
}

/// The first vertex whose position is not finite; null if all are.
pub(crate) fn first_non_finite(x: &[[f32; 4]]) -> VertexId {
    x.iter()
        .position(|p| !p[..3].iter().all(|c| c.is_finite()))
        .map_or(VertexId::NULL, VertexId::from_index)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::{Projection, VolumeProjection};

    #[test]
    fn a_number_that_is_none_is_found() {
        let rigid = Projection {
            factor: 1.0,
            alpha: 0.0,
            own_weight: 1.0,
            old: 0.0,
            keeps: false,
            recovery: 0.0,
            hold: 0.0,
        };
        let constants = StepConstants {
            h: 0.01,
            substeps: 1,
            gravity_step: [0.0; 3],
            kept_velocity: 1.0,
            stretch: rigid,
            bending: rigid,
            struts: rigid,
            volume: VolumeProjection::NONE,
            ground: f32::NEG_INFINITY,
            friction: 0.0,
            residual: None,
        };
        for bad in [f32::NAN, f32::INFINITY] {
            for k in 0..3 {
                let mut x = [[1.0; 4]; 3];
                let mut d = [[0.5, -0.5, 0.0, 0.0]; 3];
                let mut v = [[0.0; 4]; 3];
                let farthest = integrate(&mut x, &mut d, &mut v, &constants);
                assert_eq!(farthest, Some(0.5), "all is well");
                assert_eq!(v[0], [50.0, -50.0, 0.0, 0.0]);
                assert!(are_finite(&x), "all are numbers");
                d[1][k] = bad;
                let farthest = integrate(&mut x, &mut d, &mut v, &constants);
                assert_eq!(farthest, None, "{bad} at {k}");
                assert_eq!(first_non_finite(&x), VertexId(1));
                assert!(!are_finite(&x), "{bad} at {k}");
            }
        }
    }
}
