//! Modes of a cell: its eight nodes as a trilinear map.
//!
//! Mode `m` of a vector at the nodes is its sum with signs. The sign of node `i` is the product of
//! `-1` for every axis in `m` at whose lower face the node is. Bits of `m` and `i` are axes. Mode 0
//! is a translation, modes 1, 2 and 4 are the affine maps, the other four bend the cell
//! (hourglass modes).

use crate::kernels::lanes::Lanes;
use pulp::Simd;

/// A vector, one lane per cell.
pub(super) type Vector<S> = [Lanes<S>; 3];

/// A matrix by rows, one lane per cell.
pub(super) type Matrix<S> = [Vector<S>; 3];

/// The hourglass modes: xy, yz, zx and xyz.
pub(super) const HOURGLASS: [usize; 4] = [0b011, 0b110, 0b101, 0b111];

/// Returns all modes of a number at the nodes (a Walsh-Hadamard transform).
#[inline(always)]
pub(super) fn to_modes<S: Simd>(nodes: [Lanes<S>; 8]) -> [Lanes<S>; 8] {
    let mut values = nodes;
    for axis in [0b001, 0b010, 0b100] {
        for low in 0..8 {
            if low & axis == 0 {
                let pair = [values[low], values[low | axis]];
                values[low] = pair[0] + pair[1];
                values[low | axis] = pair[1] - pair[0];
            }
        }
    }
    values
}

/// Returns the number at each node, given the factors of all modes.
#[inline(always)]
pub(super) fn to_nodes<S: Simd>(modes: [Lanes<S>; 8]) -> [Lanes<S>; 8] {
    let mut values = modes;
    for axis in [0b001, 0b010, 0b100] {
        for low in 0..8 {
            if low & axis == 0 {
                let pair = [values[low], values[low | axis]];
                values[low] = pair[0] - pair[1];
                values[low | axis] = pair[0] + pair[1];
            }
        }
    }
    values
}

/// Derivatives of the modes at the centroid of the part in a cell.
#[derive(Debug, Clone, Copy)]
pub(super) struct Derivatives<S: Simd> {
    /// The centroid from the cell's center \[half cells\].
    center: Vector<S>,
    /// Products of its coordinates: xy, yz and zx.
    products: Vector<S>,
    /// One by four cell sizes [1/m].
    scale: f32,
}

impl<S: Simd> Derivatives<S> {
    #[inline(always)]
    pub(super) fn new(center: Vector<S>, scale: f32) -> Self {
        let [x, y, z] = center;
        Self {
            center,
            products: [x * y, y * z, z * x],
            scale,
        }
    }

    /// Returns the gradient of a number with given modes.
    #[inline(always)]
    pub(super) fn gradient(&self, m: &[Lanes<S>; 8]) -> Vector<S> {
        let ([x, y, z], [xy, yz, zx]) = (self.center, self.products);
        [
            self.scale * ((m[1] + y * m[3]) + (z * m[5] + yz * m[7])),
            self.scale * ((m[2] + x * m[3]) + (z * m[6] + zx * m[7])),
            self.scale * ((m[4] + x * m[5]) + (y * m[6] + xy * m[7])),
        ]
    }

    /// Returns the factors of modes whose sum with the modes is `by` times the gradient: the
    /// transpose of [`Self::gradient`].
    #[inline(always)]
    pub(super) fn transposed(&self, by: Vector<S>) -> [Lanes<S>; 8] {
        let ([x, y, z], [xy, yz, zx]) = (self.center, self.products);
        let [a, b, c] = [self.scale * by[0], self.scale * by[1], self.scale * by[2]];
        [
            a.zero(),
            a,
            b,
            y * a + x * b,
            c,
            z * a + x * c,
            z * b + y * c,
            (yz * a + zx * b) + xy * c,
        ]
    }
}

/// Returns the product of a matrix and the transpose of another one.
#[inline(always)]
pub(super) fn product_transposed<S: Simd>(a: Matrix<S>, b: Matrix<S>) -> Matrix<S> {
    let mut c = a;
    for i in 0..3 {
        for j in 0..3 {
            c[i][j] = (a[i][0] * b[j][0] + a[i][1] * b[j][1]) + a[i][2] * b[j][2];
        }
    }
    c
}
