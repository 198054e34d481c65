//! The matrix of the global step and its Cholesky factor.
//!
//! `A = M + sum of w c c^T` over edges (`c = (1, -1)`), springs and hinges, with `w = 1 / alpha`.
//! The coefficients of a hinge are the lengths of its gradients at rest, with their signs. `A` acts
//! on each coordinate alike, so that one factor with three right-hand sides serves all of them.

use super::EnergySets;
use super::objective::Compliances;
use crate::constraints::batches::ConstraintSet;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMat, Triplet};
use faer::{Conj, Mat, Par, Side, Spec};
use incise_mesh::geometry::to_f64;
use incise_mesh::{Surface, Vec3, VertexId, index_u32};
use std::fmt;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Row of a vertex that the factor does not know.
pub(super) const NO_ROW: u32 = u32::MAX;

/// An element of the matrix: its vertices, coefficients and weight.
type Element<const N: usize> = ([usize; N], [f64; N], f64);

/// A copy of masses, constraints and the rest shape, from which the matrix is assembled.
///
/// A factor keeps it, so that a loaded body makes the same factor again.
#[derive(Debug)]
pub(super) struct MatrixInput {
    /// Inverse mass [1/kg], 0 of fixed vertices, shape [vertex slots].
    pub(super) inverse_masses: Vec<f32>,
    /// Rest positions \[m\], shape [vertex slots].
    pub(super) rest: Vec<[f32; 3]>,
    pub(super) edges: Vec<[VertexId; 2]>,
    pub(super) springs: Vec<[VertexId; 2]>,
    pub(super) hinges: Vec<[VertexId; 4]>,
    pub(super) compliances: Compliances,
}

impl MatrixInput {
    /// Copies masses, constraints and rest positions.
    pub(super) fn new(sets: &EnergySets<'_>, surface: &Surface, by: Compliances) -> Self {
        Self {
            inverse_masses: surface.positions().iter().map(|p| p[3]).collect(),
            rest: surface.rest_positions().to_vec(),
            edges: vertices_of(Some(sets.stretch)),
            springs: vertices_of(sets.interior_springs),
            hinges: vertices_of(sets.bending),
            compliances: by,
        }
    }

    /// Returns the memory \[bytes\].
    pub(super) fn bytes(&self) -> usize {
        4 * self.inverse_masses.capacity()
            + 12 * self.rest.capacity()
            + 8 * (self.edges.capacity() + self.springs.capacity())
            + 16 * self.hinges.capacity()
    }

    /// Returns the mass of every vertex \[kg\], 0 of fixed vertices.
    fn masses(&self) -> impl Iterator<Item = f64> {
        let mass = |&w: &f32| if w > 0.0 { 1.0 / f64::from(w) } else { 0.0 };
        self.inverse_masses.iter().map(mass)
    }

    /// Returns the elements of edges and springs.
    fn lines(&self) -> impl Iterator<Item = Element<2>> {
        let by = self.compliances;
        let edges = self.edges.iter().map(move |ends| (ends, by.stretch));
        let springs = self.springs.iter();
        let springs = springs.map(move |ends| (ends, by.interior_springs));
        let all = edges.chain(springs);
        all.map(|(ends, alpha)| (ends.map(VertexId::index), [-1.0, 1.0], 1.0 / alpha))
    }

    /// Returns the elements of hinges.
    fn hinges(&self) -> impl Iterator<Item = Element<4>> {
        self.hinges.iter().filter_map(|vertices| {
            let vertices = vertices.map(VertexId::index);
            let coefficients = hinge_coefficients(vertices.map(|v| to_f64(self.rest[v])))?;
            Some((vertices, coefficients, 1.0 / self.compliances.bending))
        })
    }

    /// Returns the diagonal of the matrix \[kg\], shape [vertex slots].
    pub(super) fn diagonal(&self) -> Vec<f64> {
        let mut sum: Vec<f64> = self.masses().collect();
        add_squares(self.lines(), &mut sum);
        add_squares(self.hinges(), &mut sum);
        sum
    }

    /// Returns the product of the matrix with a vector.
    #[cfg(test)]
    pub(super) fn times(&self, vector: &[Vec3]) -> Vec<Vec3> {
        let mut out: Vec<Vec3> = vector
            .iter()
            .zip(self.masses())
            .map(|(v, m)| v * m)
            .collect();
        let mut add = |vertices: &[usize], coefficients: &[f64], weight: f64| {
            let along: Vec3 = vertices
                .iter()
                .zip(coefficients)
                .map(|(&v, &c)| vector[v] * c)
                .sum();
            for (&v, &c) in vertices.iter().zip(coefficients) {
                out[v] += along * (c * weight);
            }
        };
        for (vertices, coefficients, weight) in self.lines() {
            add(&vertices, &coefficients, weight);
        }
        for (vertices, coefficients, weight) in self.hinges() {
            add(&vertices, &coefficients, weight);
        }
        out
    }

    /// Assembles and factors the matrix; `None` if it is not positive definite in 64 bits.
    pub(super) fn factor(self: &Arc<Self>) -> Option<Factor> {
        let begin = Instant::now();
        let mut rows = vec![NO_ROW; self.inverse_masses.len()];
        let mut entries: Vec<Triplet<usize, usize, f64>> = Vec::new();
        let mut count = 0;
        for (row, mass) in rows.iter_mut().zip(self.masses()) {
            if mass > 0.0 {
                *row = index_u32(count);
                entries.push(Triplet::new(count, count, mass));
                count += 1;
            }
        }
        add_entries(self.lines(), &rows, &mut entries);
        add_entries(self.hinges(), &rows, &mut entries);
        let matrix = SparseColMat::try_new_from_triplets(count, count, &entries).ok()?;
        let symbolic = factorize_symbolic_cholesky(
            matrix.symbolic(),
            Side::Lower,
            SymmetricOrdering::Amd,
            CholeskySymbolicParams::default(),
        )
        .ok()?;
        let mut values = vec![0.0; symbolic.len_val()];
        let request = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Spec::default());
        let mut memory = MemBuffer::try_new(request).ok()?;
        symbolic
            .factorize_numeric_llt(
                &mut values,
                matrix.as_ref(),
                Side::Lower,
                LltRegularization::default(),
                Par::Seq,
                MemStack::new(&mut memory),
                Spec::default(),
            )
            .ok()?;
        Some(Factor {
            input: self.clone(),
            rows,
            count,
            symbolic,
            values,
            time: begin.elapsed(),
        })
    }
}

/// Returns the vertices of all constraints of a set, if there is one.
fn vertices_of<const N: usize>(set: Option<&ConstraintSet<N>>) -> Vec<[VertexId; N]> {
    let batches = set.into_iter().flat_map(ConstraintSet::all);
    batches
        .flat_map(|batch| batch.vertices())
        .copied()
        .collect()
}

/// Returns the coefficients of a hinge at rest [1/m]; `None` for a sliver.
///
/// At rest the gradients of a flat hinge are multiples of its normal.
fn hinge_coefficients(points: [Vec3; 4]) -> Option<[f64; 4]> {
    let (_, slopes) = super::objective::hinge(points)?;
    let [e, a, b] = [1, 2, 3].map(|i: usize| points[i] - points[0]);
    let square = e.norm_squared();
    let (c2, c3) = (slopes[2].norm(), slopes[3].norm());
    let c1 = -(c2 * (a.dot(&e) / square) + c3 * (b.dot(&e) / square));
    Some([-(c1 + c2 + c3), c1, c2, c3])
}

/// Adds the diagonal of elements.
fn add_squares<const N: usize>(elements: impl Iterator<Item = Element<N>>, sum: &mut [f64]) {
    for (vertices, coefficients, weight) in elements {
        for (v, c) in vertices.into_iter().zip(coefficients) {
            sum[v] += weight * c * c;
        }
    }
}

/// Adds the lower triangle of elements.
fn add_entries<const N: usize>(
    elements: impl Iterator<Item = Element<N>>,
    rows: &[u32],
    entries: &mut Vec<Triplet<usize, usize, f64>>,
) {
    for (vertices, coefficients, weight) in elements {
        let places = vertices.map(|v| rows[v]);
        for (row, c) in places.into_iter().zip(coefficients) {
            for (column, d) in places.into_iter().zip(coefficients) {
                if row >= column && row != NO_ROW {
                    let value = weight * (c * d);
                    entries.push(Triplet::new(row as usize, column as usize, value));
                }
            }
        }
    }
}

/// The factored matrix of a body.
pub(super) struct Factor {
    pub(super) input: Arc<MatrixInput>,
    /// Row of every vertex slot, or [`NO_ROW`].
    pub(super) rows: Vec<u32>,
    count: usize,
    symbolic: SymbolicCholesky<usize>,
    values: Vec<f64>,
    /// Time of assembly and factorization.
    pub(super) time: Duration,
}

impl fmt::Debug for Factor {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Factor")
            .field("rows", &self.count)
            .field("entries", &self.values.len())
            .finish_non_exhaustive()
    }
}

/// Memory of a solve.
pub(super) struct SolveScratch {
    right: Mat<f64>,
    memory: MemBuffer,
}

impl fmt::Debug for SolveScratch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("SolveScratch")
    }
}

impl Factor {
    /// Returns the number of entries.
    pub(super) fn entries(&self) -> usize {
        self.values.len()
    }

    /// Returns the size of factor, its structure, input, rows and scratch memory \[bytes\].
    pub(super) fn bytes(&self) -> usize {
        let indices = match self.symbolic.raw() {
            SymbolicCholeskyRaw::Simplicial(symbolic) => symbolic.row_idx(),
            SymbolicCholeskyRaw::Supernodal(symbolic) => symbolic.row_idx(),
        };
        let scratch = self.symbolic.solve_in_place_scratch::<f64>(3, Par::Seq);
        8 * (self.values.len() + indices.len() + 3 * self.count)
            + 4 * self.rows.len()
            + self.input.bytes()
            + scratch.unaligned_bytes_required()
    }

    /// Allocates the memory of a solve; `None` if there is not enough.
    pub(super) fn scratch(&self) -> Option<SolveScratch> {
        let request = self.symbolic.solve_in_place_scratch::<f64>(3, Par::Seq);
        Some(SolveScratch {
            right: Mat::zeros(self.count, 3),
            memory: MemBuffer::try_new(request).ok()?,
        })
    }

    /// Replaces the entries of `vector` at the vertices with a row by those of `A^-1 vector`.
    ///
    /// `rows` are the factor's, less those of vertices that have changed since.
    pub(super) fn solve(&self, rows: &[u32], vector: &mut [Vec3], scratch: &mut SolveScratch) {
        let SolveScratch { right, memory } = scratch;
        right.fill(0.0);
        let known = |&(_, &row): &(usize, &u32)| row != NO_ROW;
        for (v, &row) in rows.iter().enumerate().filter(known) {
            for k in 0..3 {
                right[(row as usize, k)] = vector[v][k];
            }
        }
        LltRef::new(&self.symbolic, &self.values).solve_in_place_with_conj(
            Conj::No,
            right.as_mut(),
            Par::Seq,
            MemStack::new(memory),
        );
        for (v, &row) in rows.iter().enumerate().filter(known) {
            vector[v] = Vec3::from_fn(|k, _| right[(row as usize, k)]);
        }
    }
}
