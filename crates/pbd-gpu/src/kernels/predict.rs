//! Prediction: Algorithm 1, lines 5 to 8, with `d = p - x`.

use super::displacements::Displacements;
use crate::step::constants::StepConstants;

/// Sets the predicted displacement of every vertex.
///
/// Returns the minimum predicted height of the movable vertices \[m\], or infinity without any.
#[inline(always)]
pub(crate) fn predict(
    x: &[[f32; 4]],
    d: &mut impl Displacements,
    v: &mut [[f32; 4]],
    constants: &StepConstants,
) -> f32 {
    let [gx, gy, gz] = constants.gravity_step;
    let (h, kept) = (constants.h, constants.velocity_factor);
    let mut lowest = f32::INFINITY;
    for (i, (x, v)) in x.iter().zip(v).enumerate() {
        let free = if x[3] > 0.0 { 1.0 } else { 0.0 };
        let kept = kept * free;
        *v = [
            (v[0] + gx) * kept,
            (v[1] + gy) * kept,
            (v[2] + gz) * kept,
            0.0,
        ];
        let di = [v[0] * h, v[1] * h, v[2] * h, 0.0];
        d.set(i, di);
        let height = if x[3] > 0.0 {
            x[1] + di[1]
        } else {
            f32::INFINITY
        };
        lowest = if height < lowest { height } else { lowest };
    }
    lowest
}
