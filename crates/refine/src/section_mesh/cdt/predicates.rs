//! Exact signs of the two predicates of a Delaunay triangulation.
//!
//! Signs that rounding cannot change are decided here. `robust` decides the others in exact
//! arithmetic.

use robust::{Coord, incircle, orient2d};

/// Bound of the rounding error of the in-circle determinant, relative to `(A + B + C)^2`.
///
/// A, B and C are the squared distances of the triangle's corners from the point. Shewchuk bounds
/// the error by `(10 + 96 e) e P` with `e = 2^-53` and a permanent `P <= A B + B C + C A`, which is
/// at most `(A + B + C)^2 / 3`. So 10 / 3 e is enough; 4 e leaves room for the rounding of the sum.
const INCIRCLE_ERROR: f64 = 2.0 * f64::EPSILON;

/// Returns a number with the exact sign of the orientation, positive where `c` is left of `ab`.
#[inline]
pub(crate) fn orient(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    orient2d(coord(a), coord(b), coord(c))
}

/// Returns whether `p` lies inside the circumcircle of a counterclockwise triangle, exactly.
#[inline]
pub(crate) fn is_in_circle([a, b, c]: [[f64; 2]; 3], p: [f64; 2]) -> bool {
    let [u, v, w] = [a, b, c].map(|q| [q[0] - p[0], q[1] - p[1]]);
    let square = |u: [f64; 2]| u[0] * u[0] + u[1] * u[1];
    let cross = |u: [f64; 2], v: [f64; 2]| u[0] * v[1] - u[1] * v[0];
    let squares = [square(u), square(v), square(w)];
    let [s, t, r] = squares;
    let determinant = s * cross(v, w) + t * cross(w, u) + r * cross(u, v);
    let sum = s + t + r;
    if determinant.abs() > INCIRCLE_ERROR * (sum * sum) {
        determinant > 0.0
    } else {
        is_in_circle_exactly([a, b, c], p)
    }
}

#[cold]
fn is_in_circle_exactly([a, b, c]: [[f64; 2]; 3], p: [f64; 2]) -> bool {
    incircle(coord(a), coord(b), coord(c), coord(p)) > 0.0
}

#[inline]
fn coord([x, y]: [f64; 2]) -> Coord<f64> {
    Coord { x, y }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Points of a small grid are often on a circle; offsets of an ulp take them off it.
        #[test]
        fn signs_are_those_of_exact_arithmetic(
            points in prop::array::uniform4((-4_i8..4, -4_i8..4, -1_i8..2, -1_i8..2)),
            scale in -40..40_i32,
        ) {
            let points = points.map(|(x, y, i, j)| {
                let at = |x: i8, i: i8| {
                    let bits = (f64::from(x) / 3.0 + 2.0).to_bits().wrapping_add_signed(i.into());
                    f64::from_bits(bits) * f64::from(scale).exp2()
                };
                [at(x, i), at(y, j)]
            });
            let [a, b, c, p] = points;
            prop_assert_eq!(is_in_circle([a, b, c], p), is_in_circle_exactly([a, b, c], p));
        }
    }
}
