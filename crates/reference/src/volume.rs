//! Volume constraint of a closed piece.
//!
//! The constraint function is `(V - pressure rest) / sqrt(|rest|)`, so that the compliance of every
//! piece is the compressibility, whatever its size. Its gradient is dense: the second derivatives
//! of its energy are a sparse part and one of rank one a piece.

use super::error::ReferenceError;
use super::measure::Blocks;
use nalgebra::{Matrix3, Vector3};
use std::collections::HashMap;

/// Volume constraints of all pieces.
#[derive(Debug, Clone, PartialEq)]
pub struct Volumes {
    /// Closed pieces.
    pub pieces: Vec<Piece>,
    /// Relative volume change per pascal [1/Pa]. 0 is rigid.
    pub compressibility: f64,
    /// Target volume over rest volume.
    pub pressure: f64,
}

impl Default for Volumes {
    /// No pieces.
    fn default() -> Self {
        Self {
            pieces: Vec::new(),
            compressibility: 0.0,
            pressure: 1.0,
        }
    }
}

/// A closed piece.
#[derive(Debug, Clone, PartialEq)]
pub struct Piece {
    triangles: Vec<[usize; 3]>,
    /// The ends of every edge in the direction of one triangle, the third corner of that triangle,
    /// and that of the other.
    sides: Vec<[usize; 4]>,
    rest: f64,
}

impl Piece {
    /// Returns a piece of triangles with a rest volume [m^3].
    ///
    /// # Errors
    /// [`ReferenceError::Open`] unless every edge has two triangles that run along it in opposite
    /// directions, [`ReferenceError::BadNumber`] without a rest volume.
    pub fn new(triangles: Vec<[usize; 3]>, rest: f64) -> Result<Self, ReferenceError> {
        if !rest.is_normal() {
            return Err(ReferenceError::BadNumber {
                name: "a rest volume",
            });
        }
        let runs = |&[a, b, c]: &[usize; 3]| [[a, b, c], [b, c, a], [c, a, b]];
        let mut across: HashMap<[usize; 2], usize> = HashMap::new();
        for [from, to, third] in triangles.iter().flat_map(runs) {
            if across.insert([from, to], third).is_some() {
                return Err(ReferenceError::Open { from, to });
            }
        }
        let mut sides = Vec::new();
        for [from, to, third] in triangles.iter().flat_map(runs) {
            let Some(&other) = across.get(&[to, from]) else {
                return Err(ReferenceError::Open { from, to });
            };
            if from < to {
                sides.push([from, to, third, other]);
            }
        }
        Ok(Self {
            triangles,
            sides,
            rest,
        })
    }

    /// Returns the rest volume [m^3]; negative for a cavity.
    #[must_use]
    pub fn rest(&self) -> f64 {
        self.rest
    }

    /// Returns the volume with vertices at `x` [m^3].
    #[must_use]
    pub fn volume(&self, x: &[Vector3<f64>]) -> f64 {
        self.cones(x)
            .map(|(_, arm, normal)| arm.dot(&normal))
            .sum::<f64>()
            / 6.0
    }

    /// Returns the rounding error of the constraint function, in units of a rounding.
    pub(super) fn roughness(&self, x: &[Vector3<f64>]) -> f64 {
        let (mut squares, mut sum) = (0.0, 0.0);
        for (_, arm, normal) in self.cones(x) {
            squares += arm.norm_squared() * normal.norm_squared();
            sum += arm.dot(&normal).abs() / 6.0;
        }
        let added = sum * sum * self.triangles.len() as f64;
        (squares + added).sqrt() * self.scale()
    }

    /// Returns the Hessian of the volume by the two ends of every side \[m\].
    pub(super) fn twist(side: [usize; 4], x: &[Vector3<f64>]) -> Matrix3<f64> {
        let [_, _, third, other] = side;
        (x[other] - x[third]).cross_matrix() / 6.0
    }

    pub(super) fn triangles(&self) -> &[[usize; 3]] {
        &self.triangles
    }

    pub(super) fn sides(&self) -> &[[usize; 4]] {
        &self.sides
    }

    /// Returns the factor from volume to constraint function [m^-1.5].
    pub(super) fn scale(&self) -> f64 {
        self.rest.abs().sqrt().recip()
    }

    /// Returns the constraint function at `x` [m^1.5].
    pub(super) fn error(&self, x: &[Vector3<f64>], pressure: f64) -> f64 {
        (self.volume(x) - pressure * self.rest) * self.scale()
    }

    /// Returns the gradient of the constraint function by all vertices of the model [m^0.5].
    ///
    /// Every corner has a sixth of its triangle's doubled normal; the other terms cancel in a
    /// closed piece.
    pub(super) fn gradient(&self, x: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        let mut out = vec![Vector3::zeros(); x.len()];
        let share = self.scale() / 6.0;
        for (corners, _, normal) in self.cones(x) {
            corners.iter().for_each(|&v| out[v] += normal * share);
        }
        out
    }

    /// Returns the sum of `|grad C|^2 / m` over free vertices.
    pub(super) fn weight(&self, x: &[Vector3<f64>], mass: &[f64]) -> f64 {
        let each = self.gradient(x).into_iter().zip(mass);
        each.filter(|(_, m)| **m > 0.0)
            .map(|(g, m)| g.norm_squared() / m)
            .sum()
    }

    /// Returns triangles with their corners relative to the piece's first vertex and their doubled
    /// area normals.
    fn cones<'a>(
        &'a self,
        x: &'a [Vector3<f64>],
    ) -> impl Iterator<Item = ([usize; 3], Vector3<f64>, Vector3<f64>)> + 'a {
        let apex = self
            .triangles
            .first()
            .map_or_else(Vector3::zeros, |t| x[t[0]]);
        self.triangles.iter().map(move |&t| {
            let [a, b, c] = t.map(|v| x[v]);
            (t, a - apex, (b - a).cross(&(c - a)))
        })
    }
}

/// Returns a side's part of the Hessian, `off` times a skew matrix, projected to a positive
/// semidefinite one if `positive`. Its eigenvalues have a closed form: plus and minus the length of
/// the skew matrix's vector, twice each.
pub(super) fn side_blocks(twist: &Matrix3<f64>, off: f64, positive: bool) -> Blocks<2> {
    let twist = twist * off;
    if !positive {
        return [
            [Matrix3::zeros(), twist],
            [twist.transpose(), Matrix3::zeros()],
        ];
    }
    let axis = Vector3::new(twist[(2, 1)], twist[(0, 2)], twist[(1, 0)]);
    let length = axis.norm();
    let along = if length > 0.0 {
        axis / length
    } else {
        Vector3::zeros()
    };
    let across = (Matrix3::identity() - along * along.transpose()) * (length / 2.0);
    let half = twist / 2.0;
    [[across, half], [half.transpose(), across]]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A skew tetrahedron.
    pub(crate) fn tetrahedron() -> (Piece, Vec<Vector3<f64>>) {
        let x = vec![
            Vector3::new(0.1, 0.2, -0.3),
            Vector3::new(1.2, 0.1, 0.1),
            Vector3::new(0.3, 1.4, 0.2),
            Vector3::new(0.2, 0.3, 0.9),
        ];
        let triangles = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
        (Piece::new(triangles, 0.5).unwrap(), x)
    }

    #[test]
    fn volumes_have_the_derivatives_of_differences() {
        let (piece, x) = tetrahedron();
        let edges = [1, 2, 3].map(|i| x[i] - x[0]);
        let six = edges[0].dot(&edges[1].cross(&edges[2]));
        assert!((piece.volume(&x) - six / 6.0).abs() < 1e-15);
        assert!((piece.error(&x, 2.0) - (six / 6.0 - 1.0) / 0.5_f64.sqrt()).abs() < 1e-15);
        let gradient = piece.gradient(&x);
        let mut second = vec![vec![Matrix3::zeros(); 4]; 4];
        for &side in piece.sides() {
            let twist = Piece::twist(side, &x) * piece.scale();
            second[side[0]][side[1]] += twist;
            second[side[1]][side[0]] += twist.transpose();
        }
        let step = 1e-5;
        for (v, k) in (0..4).flat_map(|v| (0..3).map(move |k| (v, k))) {
            let moved = |by: f64| {
                let mut x = x.clone();
                x[v][k] += by;
                x
            };
            let (up, down) = (moved(step), moved(-step));
            let slope = (piece.error(&up, 1.0) - piece.error(&down, 1.0)) / (2.0 * step);
            assert!((slope - gradient[v][k]).abs() < 1e-9, "gradient {v} {k}");
            let (up, down) = (piece.gradient(&up), piece.gradient(&down));
            for i in 0..4 {
                let slope = (up[i] - down[i]) / (2.0 * step);
                let off = (slope - second[i][v].column(k)).amax();
                assert!(off < 1e-9, "second derivative {i}, {v} {k}: {off:e}");
            }
        }
    }

    #[test]
    fn a_motion_changes_no_volume_and_gradients_neither_push_nor_turn() {
        let (piece, x) = tetrahedron();
        let turn = nalgebra::Rotation3::from_euler_angles(0.4, 1.1, -0.3);
        let shift = Vector3::new(300.0, -100.0, 200.0);
        let moved: Vec<_> = x.iter().map(|p| turn * p + shift).collect();
        assert!((piece.volume(&moved) - piece.volume(&x)).abs() < 1e-13);
        let gradient = piece.gradient(&x);
        let force: Vector3<f64> = gradient.iter().sum();
        let torque: Vector3<f64> = x.iter().zip(&gradient).map(|(x, g)| x.cross(g)).sum();
        assert!(force.norm() < 1e-14 && torque.norm() < 1e-14);
    }

    #[test]
    fn sides_lose_their_negative_eigenvalues_and_nothing_else() {
        let (piece, x) = tetrahedron();
        let spectrum = |blocks: &Blocks<2>| {
            let matrix =
                nalgebra::DMatrix::from_fn(6, 6, |r, c| blocks[r / 3][c / 3][(r % 3, c % 3)]);
            let eigen = matrix.clone().symmetric_eigen();
            let positive = eigen.eigenvalues.map(|value| value.max(0.0));
            let clamped = &eigen.eigenvectors
                * nalgebra::DMatrix::from_diagonal(&positive)
                * eigen.eigenvectors.transpose();
            (matrix, clamped)
        };
        for off in [0.7, -2.0, 0.0] {
            let twist = Piece::twist(piece.sides()[0], &x);
            let (_, expected) = spectrum(&side_blocks(&twist, off, false));
            let (found, _) = spectrum(&side_blocks(&twist, off, true));
            assert!((found - expected).amax() < 1e-14, "off by {off}");
        }
    }

    #[test]
    fn pieces_are_closed_and_have_a_volume() {
        let open = Piece::new(vec![[0, 2, 1], [0, 1, 3], [1, 2, 3]], 1.0);
        assert_eq!(open, Err(ReferenceError::Open { from: 0, to: 2 }));
        let turned = Piece::new(vec![[0, 1, 2], [0, 1, 3], [1, 2, 3], [2, 0, 3]], 1.0);
        assert_eq!(turned, Err(ReferenceError::Open { from: 0, to: 1 }));
        let (piece, _) = tetrahedron();
        let flat = Piece::new(piece.triangles, 0.0);
        assert!(matches!(flat, Err(ReferenceError::BadNumber { .. })));
    }
}
