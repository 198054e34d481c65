//! Constraint functions with their derivatives, and the Hessian of their energy.

use nalgebra::{Matrix3, SMatrix, Vector3};

/// A constraint function of `N` points: value, gradient and Hessian.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measure<const N: usize> {
    /// The value: \[m\] for edges, \[rad\] for hinges.
    pub value: f64,
    /// The gradient by every point.
    pub gradient: [Vector3<f64>; N],
    /// The Hessian by every two points.
    pub hessian: [[Matrix3<f64>; N]; N],
}

/// A measure without Hessian.
#[derive(Debug, Clone, Copy)]
pub(super) struct Slope<const N: usize> {
    pub(super) value: f64,
    pub(super) gradient: [Vector3<f64>; N],
}

/// A symmetric matrix of 3x3 blocks.
pub(super) type Blocks<const N: usize> = [[Matrix3<f64>; N]; N];

/// A kind of constraint.
pub(super) trait Kind<const N: usize> {
    /// Returns the measure at points; none where it is not defined.
    fn measure(points: &[Vector3<f64>; N]) -> Option<Measure<N>>;

    /// Returns value and gradient without the expensive Hessian.
    fn slope(points: &[Vector3<f64>; N]) -> Option<Slope<N>>;

    /// Returns the value minus the rest value.
    fn error(value: f64, rest: f64) -> f64;

    /// Projects the Hessian of an energy of this kind to the nearest positive semidefinite matrix.
    fn clamp(hessian: &mut Blocks<N>);
}

/// Returns the Hessian of `(C - shift)^2 / 2`; `off` is `C - shift`.
pub(super) fn energy_hessian<const N: usize>(measure: &Measure<N>, off: f64) -> Blocks<N> {
    let Measure {
        gradient, hessian, ..
    } = measure;
    std::array::from_fn(|a| {
        std::array::from_fn(|b| gradient[a] * gradient[b].transpose() + hessian[a][b] * off)
    })
}

/// Projects a 6 x 6 matrix to a positive semidefinite one.
pub(super) fn clamp_3(matrix: &Matrix3<f64>) -> Matrix3<f64> {
    let eigen = matrix.symmetric_eigen();
    let positive = eigen.eigenvalues.map(|value| value.max(0.0));
    eigen.eigenvectors * Matrix3::from_diagonal(&positive) * eigen.eigenvectors.transpose()
}

/// Projects a 12 x 12 matrix to a positive semidefinite one.
pub(super) fn clamp_12(blocks: &mut Blocks<4>) {
    let mut matrix = SMatrix::<f64, 12, 12>::zeros();
    for (a, row) in blocks.iter().enumerate() {
        for (b, block) in row.iter().enumerate() {
            matrix.fixed_view_mut::<3, 3>(3 * a, 3 * b).copy_from(block);
        }
    }
    let eigen = matrix.symmetric_eigen();
    let positive = eigen.eigenvalues.map(|value| value.max(0.0));
    let scaled = eigen.eigenvectors * SMatrix::from_diagonal(&positive);
    let clamped = scaled * eigen.eigenvectors.transpose();
    for (a, row) in blocks.iter_mut().enumerate() {
        for (b, block) in row.iter_mut().enumerate() {
            *block = clamped.fixed_view::<3, 3>(3 * a, 3 * b).into_owned();
        }
    }
}
