//! Torque of forces along strains, and the skew stress that cancels it.

use super::forces::symmetric;
use super::modes::Vector;
use crate::kernels::lanes::Lanes;
use pulp::Simd;

/// Returns the entries yz, zx and xy of `A B - B A`, which is skew, of two symmetric matrices.
#[inline(always)]
pub(super) fn commutator<S: Simd>(a: &[Lanes<S>; 6], b: &[Lanes<S>; 6]) -> Vector<S> {
    let mut skew = [a[0].zero(); 3];
    for (k, entry) in skew.iter_mut().enumerate() {
        // Entry 3 + i is that of the axes i and i + 1.
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        let (own, next, before) = (3 + i, 3 + j, 3 + k);
        let along = b[own] * (a[i] - a[j]) + a[own] * (b[j] - b[i]);
        *entry = along + (a[before] * b[next] - a[next] * b[before]);
    }
    skew
}

/// Returns the axial vector of the skew stress that cancels a torque of a stretched cell.
///
/// With the stretch `S`, it is `-(tr S - S)^-1` times the torque. Where two principal stretches
/// cancel, the rotation of a cell is not defined; the determinant, 8 at rest, is at least 1.
#[inline(always)]
pub(super) fn spin_against<S: Simd>(torque: Vector<S>, stretch: &[Lanes<S>; 6]) -> Vector<S> {
    let &[xx, yy, zz, xy, yz, zx] = stretch;
    let [a, b, c] = [yy + zz, zz + xx, xx + yy];
    // Of the matrix with the diagonal a, b and c, and -xy, -yz and -zx beside it.
    let adjugate = [
        b * c - yz * yz,
        c * a - zx * zx,
        a * b - xy * xy,
        c * xy + yz * zx,
        a * yz + zx * xy,
        b * zx + xy * yz,
    ];
    let determinant = (a * adjugate[0] - xy * adjugate[3]) - zx * adjugate[5];
    let one = Lanes::splat(a.simd(), 1.0);
    let scale = one / determinant.gt(one).select(determinant, one);
    let [x, y, z] = symmetric(&adjugate);
    let mut spin = torque;
    for (k, row) in [x, y, z].into_iter().enumerate() {
        let sum = (row[0] * torque[0] + row[1] * torque[1]) + row[2] * torque[2];
        spin[k] = -(scale * sum);
    }
    spin
}
