//! A polynomial arctangent in 64 bits, with the same bits on every CPU.

use super::lanes::Lanes;
use pulp::Simd;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

/// Tangent of an eighth of pi.
const STEEP: f64 = 0.414_213_562_373_095_03;

/// Chebyshev coefficients of `atan(t) / t` in `t^2` on 0 to [`STEEP`]; the error is below 1e-16.
const COEFFICIENTS: [f64; 11] = [
    1.0,
    -0.333_333_333_333_284_4,
    0.199_999_999_988_551_1,
    -0.142_857_141_809_764_67,
    0.111_111_061_804_559_46,
    -0.090_907_730_748_084_07,
    0.076_899_534_963_068_48,
    -0.066_402_339_304_293_2,
    0.056_883_492_268_085_52,
    -0.043_480_522_157_151_39,
    0.021_135_373_157_677_034,
];

/// Returns the angle of the point `(x, y)` \[rad\], -pi to pi, and 0 at the origin.
#[inline(always)]
pub(super) fn arctangent2<S: Simd>(simd: S, y: Lanes<S>, x: Lanes<S>) -> Lanes<S> {
    let number = |number| Lanes::splat(simd, number);
    let zero = number(0.0);
    let (ax, ay) = (x.abs(), y.abs());
    let is_up = ax.lt(ay);
    let (small, large) = (is_up.select(ax, ay), is_up.select(ay, ax));
    // atan t = pi / 4 + atan((t - 1) / (t + 1))
    let is_steep = (number(STEEP) * large).lt(small);
    let above = is_steep.select(small - large, small);
    let below = is_steep.select(small + large, large);
    let t = zero.lt(below).or_zero(above / below);
    let angle = series(simd, t * t) * t;
    let angle = is_steep.select(number(FRAC_PI_4) + angle, angle);
    let angle = is_up.select(number(FRAC_PI_2) - angle, angle);
    let angle = x.lt(zero).select(number(PI) - angle, angle);
    y.lt(zero).select(-angle, angle)
}

/// Returns `atan(t) / t` for `s = t^2`.
///
/// Pairs of terms (Estrin's scheme) make the chain of dependent operations short.
#[inline(always)]
fn series<S: Simd>(simd: S, s: Lanes<S>) -> Lanes<S> {
    let [c0, c1, c2, c3, c4, c5, c6, c7, c8, c9, c10] = COEFFICIENTS;
    let number = |c| Lanes::splat(simd, c);
    let pair = |a, b| number(a) + number(b) * s;
    let s2 = s * s;
    let s4 = s2 * s2;
    let low = pair(c0, c1) + pair(c2, c3) * s2;
    let middle = pair(c4, c5) + pair(c6, c7) * s2;
    let high = pair(c8, c9) + number(c10) * s2;
    low + (middle + high * s4) * s4
}

#[cfg(test)]
mod tests {
    use super::*;
    use pulp::Scalar;
    use std::f64::consts::TAU;

    fn arctangent2(y: f64, x: f64) -> f64 {
        let lane = |number| Lanes::splat(Scalar, number);
        let [angle] = super::arctangent2(Scalar, lane(y), lane(x)).to_array();
        angle
    }

    #[test]
    fn it_is_the_arctangent_at_every_scale() {
        for i in 0..100_000 {
            let angle = f64::from(i).mul_add(1e-5 * TAU, -PI);
            for scale in [1e-150, 1e-12, 1.0, 1e150] {
                let (y, x) = (scale * angle.sin(), scale * angle.cos());
                let error = (arctangent2(y, x) - y.atan2(x)).abs();
                // pi and -pi are the same angle: the sign of a zero tells them apart in std only.
                let error = error.min((error - TAU).abs());
                assert!(error < 1e-15, "error {error} at angle {angle}");
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
