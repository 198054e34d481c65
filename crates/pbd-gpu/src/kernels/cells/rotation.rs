//! The rotation nearest to a deformation gradient, from that of the last substep.
//!
//! Newton's method for the polar decomposition `F = R S`: the turn `o` of an iteration solves
//! `(tr S - S) o = a` with the axial vector `a` of `F R^T`, `S` the symmetric part of it. Where
//! that matrix is not positive, the step of Mueller et al. 2016, "A Robust Method to Extract the
//! Rotational Part of Deformations", turns toward `F` instead. The result is never a reflection.

use super::modes::{Matrix, Vector, product_transposed};
use crate::kernels::block::Gather;
use crate::kernels::lanes::{Lanes, Mask};
use pulp::Simd;

/// Maximum number of iterations.
pub(crate) const MAX_ITERATIONS: usize = 10;

/// Squared turn \[rad²\] below which a rotation has converged: five roundings of 32-bit numbers.
///
/// A rotation that lags behind brakes a spinning body: its error by the substep is a speed.
pub(crate) const CONVERGED: f32 = 1e-13;

/// Squared turn \[rad²\] after which a rotation has converged: the next one is about its square.
pub(crate) const LAST_TURN: f32 = 3e-8;

/// Minimum of a minor of `tr S - S`, which is 2, 4 and 8 at rest, for a step of Newton's method.
pub(crate) const MIN_MINORS: [f32; 3] = [0.1, 0.01, 0.01];

/// Largest squared turn of an iteration \[rad²\].
pub(crate) const MAX_TURN: f32 = 1.0;

/// Keeps the step of Mueller finite where a cell is flat.
pub(crate) const FLAT: f32 = 1e-9;

/// Returns the matrix of a unit quaternion.
#[inline(always)]
pub(super) fn matrix<S: Simd>([w, x, y, z]: [Lanes<S>; 4]) -> Matrix<S> {
    let one = Lanes::splat(w.simd(), 1.0);
    [
        [
            one - 2.0 * (y * y + z * z),
            2.0 * (x * y - w * z),
            2.0 * (x * z + w * y),
        ],
        [
            2.0 * (x * y + w * z),
            one - 2.0 * (x * x + z * z),
            2.0 * (y * z - w * x),
        ],
        [
            2.0 * (x * z - w * y),
            2.0 * (y * z + w * x),
            one - 2.0 * (x * x + y * y),
        ],
    ]
}

/// Returns the quaternion of the rotation nearest to `f`, from the last one, and its matrix.
///
/// A lane that has converged keeps its value, so that it does not depend on the other lanes.
#[inline(always)]
pub(super) fn nearest_rotation<G: Gather<L>, const L: usize>(
    gather: G,
    f: Matrix<G::S>,
    mut q: [Lanes<G::S>; 4],
) -> ([Lanes<G::S>; 4], Matrix<G::S>) {
    let simd = gather.simd();
    let [converged, last_turn] = [Lanes::splat(simd, CONVERGED), Lanes::splat(simd, LAST_TURN)];
    let (max_turn, half) = (Lanes::splat(simd, MAX_TURN), Lanes::splat(simd, 0.5));
    let mut r = matrix(q);
    let mut done = half.lt(half);
    for _ in 0..MAX_ITERATIONS {
        let turn = turn(f, r);
        let [x, y, z] = turn;
        let square = (x * x + y * y) + z * z;
        done = done.or(square.lt(converged));
        if gather.all(done) {
            break;
        }
        let by = square.gt(max_turn).select(half / square.sqrt(), half);
        let turned = turned(q, [by * x, by * y, by * z]);
        for k in 0..4 {
            q[k] = done.select(q[k], turned[k]);
        }
        r = matrix(q);
        done = done.or(square.lt(last_turn));
        if gather.all(done) {
            break;
        }
    }
    (q, r)
}

/// Returns the next turn from a rotation toward a deformation gradient \[rad\].
#[inline(always)]
fn turn<S: Simd>(f: Matrix<S>, r: Matrix<S>) -> Vector<S> {
    let y = product_transposed(f, r);
    let axial = [y[2][1] - y[1][2], y[0][2] - y[2][0], y[1][0] - y[0][1]];
    let [a, b, c] = [y[1][1] + y[2][2], y[0][0] + y[2][2], y[0][0] + y[1][1]];
    let [ab, bc, ca] = [
        -0.5 * (y[0][1] + y[1][0]),
        -0.5 * (y[1][2] + y[2][1]),
        -0.5 * (y[2][0] + y[0][2]),
    ];
    // Cofactors of the symmetric matrix [[a, ab, ca], [ab, b, bc], [ca, bc, c]].
    let first = [b * c - bc * bc, bc * ca - ab * c, ab * bc - b * ca];
    let (second, mixed, third) = (a * c - ca * ca, ab * ca - a * bc, a * b - ab * ab);
    let determinant = (a * first[0] + ab * first[1]) + ca * first[2];
    let simd = a.simd();
    let [min_a, min_second, min_third] = [
        Lanes::splat(simd, MIN_MINORS[0]),
        Lanes::splat(simd, MIN_MINORS[1]),
        Lanes::splat(simd, MIN_MINORS[2]),
    ];
    let is_positive: Mask<S> =
        a.gt(min_a) & first[0].gt(min_second) & third.gt(min_second) & determinant.gt(min_third);
    let one = Lanes::splat(simd, 1.0);
    let inverse = is_positive.select(one / determinant, one);
    let along = ((y[0][0] + y[1][1]) + y[2][2]).abs() + Lanes::splat(simd, FLAT);
    let [x, y_axis, z] = axial;
    let newton = [
        (first[0] * x + first[1] * y_axis) + first[2] * z,
        (first[1] * x + second * y_axis) + mixed * z,
        (first[2] * x + mixed * y_axis) + third * z,
    ];
    [
        is_positive.select(inverse * newton[0], x / along),
        is_positive.select(inverse * newton[1], y_axis / along),
        is_positive.select(inverse * newton[2], z / along),
    ]
}

/// Returns a quaternion turned by twice a vector \[rad\], with length 1.
#[inline(always)]
fn turned<S: Simd>([w, x, y, z]: [Lanes<S>; 4], [a, b, c]: Vector<S>) -> [Lanes<S>; 4] {
    let q = [
        w - ((a * x + b * y) + c * z),
        (x + a * w) + (b * z - c * y),
        (y + b * w) + (c * x - a * z),
        (z + c * w) + (a * y - b * x),
    ];
    let square = (q[0] * q[0] + q[1] * q[1]) + (q[2] * q[2] + q[3] * q[3]);
    let length = square.sqrt();
    [q[0] / length, q[1] / length, q[2] / length, q[3] / length]
}
