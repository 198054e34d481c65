//! A polynomial arctangent with the same bits on every CPU and GPU.

use super::block::Gather;
use super::lanes::Lanes;
use pulp::Simd;
use std::f32::consts::{FRAC_PI_2, PI};

/// Minimax coefficients of `atan(t) / t` in `t^2` on 0 to 1; the error is 4e-8 rad before rounding.
pub(crate) const COEFFICIENTS: [f32; 8] = [
    0.999_999_34,
    -0.333_298_6,
    0.199_465_66,
    -0.139_086_3,
    0.096_421_97,
    -0.055_912_33,
    0.021_862_96,
    -0.004_054_567_5,
];

/// Returns the angle of the point `(x, y)` \[rad\], -pi to pi, and 0 at the origin.
///
/// The error is below 1e-6 rad.
#[inline(always)]
pub(crate) fn arctangent2<G: Gather<L>, const L: usize>(
    gather: G,
    y: Lanes<G::S>,
    x: Lanes<G::S>,
) -> Lanes<G::S> {
    let zero = x.zero();
    if gather.all(y.abs().le(x)) {
        // Angles of at most 45 degrees, as between most triangles of a smooth surface.
        let t = x.gt(zero).or_zero(y / x);
        return t * series(t * t);
    }
    let (ax, ay) = (x.abs(), y.abs());
    let steep = ay.gt(ax);
    let (small, large) = (steep.select(ax, ay), steep.select(ay, ax));
    let t = large.gt(zero).or_zero(small / large);
    let p = series(t * t) * t;
    let p = steep.select(FRAC_PI_2 - p, p);
    let p = x.lt(zero).select(PI - p, p);
    y.lt(zero).select(-p, p)
}

/// Returns `atan(t) / t` for `s = t^2`.
///
/// Pairs of terms (Estrin's scheme) make the chain of dependent operations short.
#[inline(always)]
fn series<S: Simd>(s: Lanes<S>) -> Lanes<S> {
    let [c0, c1, c2, c3, c4, c5, c6, c7] = COEFFICIENTS;
    let s2 = s * s;
    let low = (c0 + c1 * s) + (c2 + c3 * s) * s2;
    let high = (c4 + c5 * s) + (c6 + c7 * s) * s2;
    low + high * (s2 * s2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernels::block::Transpose;
    use pulp::Scalar;

    fn arctangent2(y: f32, x: f32) -> f32 {
        let lane = |number| Lanes::splat(Scalar, number);
        super::arctangent2::<_, 1>(Transpose(Scalar), lane(y), lane(x)).values
    }

    #[test]
    fn it_is_the_arctangent_at_every_scale() {
        for i in 0..100_000 {
            let angle = f64::from(i).mul_add(1e-5 * std::f64::consts::TAU, -std::f64::consts::PI);
            for scale in [1e-30, 1e-12, 1.0, 1e15] {
                #[expect(clippy::cast_possible_truncation, reason = "rounded to the argument")]
                let (y, x) = ((scale * angle.sin()) as f32, (scale * angle.cos()) as f32);
                let exact = f64::from(y).atan2(f64::from(x));
                let error = (f64::from(arctangent2(y, x)) - exact).abs();
                // pi and -pi are the same angle: the sign of a zero tells them apart in std only.
                let error = error.min((error - std::f64::consts::TAU).abs());
                assert!(error < 1e-6, "error {error} at angle {angle}");
            }
        }
    }

    #[test]
    fn the_axes_and_the_origin_have_their_angles() {
        assert_eq!(arctangent2(0.0, 0.0), 0.0);
        assert_eq!(arctangent2(0.0, 2.0), 0.0);
        assert_eq!(arctangent2(3.0, 0.0), FRAC_PI_2);
        assert_eq!(arctangent2(-3.0, 0.0), -FRAC_PI_2);
        assert_eq!(arctangent2(0.0, -1.0), PI);
    }
}
