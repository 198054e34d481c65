//! [`FreePieces`]: translations of pieces without a pin, for which the old factor has no use.
//!
//! The old factor still connects the pieces of a cut. It would give a free piece a momentum that
//! belongs to the pins. A translation strains nothing, so that the matrix is known to it: the
//! masses. Translations are solved exactly and the old factor serves for the rest (balancing,
//! Mandel 1993).

use super::matrix::MatrixInput;
use incise_mesh::{Surface, Vec3, index_u32};

/// Piece of a vertex that is in no free piece.
const NO_PIECE: u32 = u32::MAX;

/// A piece without a pin.
#[derive(Debug, Clone, Copy)]
struct Piece {
    mass: f64,
    /// Sum over the vertices of the piece.
    sum: Vec3,
    /// Translation of the piece.
    translation: Vec3,
}

/// The pieces without a pin.
#[derive(Debug, Clone, Default)]
pub(super) struct FreePieces {
    pieces: Vec<Piece>,
    /// Piece and mass \[kg\] of every vertex, shape [vertex slots].
    vertices: Vec<(u32, f64)>,
}

impl FreePieces {
    /// Finds the pieces without a fixed vertex. O(triangles).
    pub(super) fn new(input: &MatrixInput, surface: &Surface) -> Self {
        let topology = surface.topology();
        let mut vertices = vec![(NO_PIECE, 0.0); surface.positions().len()];
        let mut masses = vec![0.0; surface.piece_bound() as usize];
        for t in topology.triangles() {
            let piece = surface.piece(t);
            for v in topology.triangle(t).map(|v| v.index()) {
                if vertices[v].0 == NO_PIECE {
                    let mass = input.mass(v);
                    vertices[v] = (piece, mass);
                    // Not a number in a piece with a fixed vertex.
                    masses[piece as usize] += if mass > 0.0 { mass } else { f64::NAN };
                }
            }
        }
        let mut pieces = Vec::new();
        let numbers: Vec<u32> = (masses.iter())
            .map(|&mass| {
                if mass.is_nan() || mass == 0.0 {
                    return NO_PIECE;
                }
                pieces.push(Piece {
                    mass,
                    sum: Vec3::zeros(),
                    translation: Vec3::zeros(),
                });
                index_u32(pieces.len() - 1)
            })
            .collect();
        for (piece, _) in &mut vertices {
            *piece = numbers.get(*piece as usize).copied().unwrap_or(NO_PIECE);
        }
        Self { pieces, vertices }
    }

    /// Multiplies by the approximate inverse; `apply` multiplies by that of the old factor.
    pub(super) fn apply(&mut self, vector: &mut [Vec3], apply: impl FnOnce(&mut [Vec3])) {
        self.sum(vector, |x, _| x);
        for piece in &mut self.pieces {
            piece.translation = piece.sum / piece.mass;
        }
        self.add(vector, |piece, mass| piece.translation * -mass);
        apply(vector);
        self.sum(vector, |x, mass| x * mass);
        self.add(vector, |piece, _| {
            piece.translation - piece.sum / piece.mass
        });
    }

    /// Sums a term of vector and mass over every piece.
    fn sum(&mut self, vector: &[Vec3], term: impl Fn(Vec3, f64) -> Vec3) {
        for piece in &mut self.pieces {
            piece.sum = Vec3::zeros();
        }
        for (&x, &(piece, mass)) in vector.iter().zip(&self.vertices) {
            if let Some(piece) = self.pieces.get_mut(piece as usize) {
                piece.sum += term(x, mass);
            }
        }
    }

    /// Adds a term of piece and mass to every vertex of a piece.
    fn add(&self, vector: &mut [Vec3], term: impl Fn(&Piece, f64) -> Vec3) {
        for (x, &(piece, mass)) in vector.iter_mut().zip(&self.vertices) {
            if let Some(piece) = self.pieces.get(piece as usize) {
                *x += term(piece, mass);
            }
        }
    }

    /// Returns the memory \[bytes\].
    pub(super) fn bytes(&self) -> usize {
        size_of::<Piece>() * self.pieces.capacity()
            + size_of::<(u32, f64)>() * self.vertices.capacity()
    }
}
