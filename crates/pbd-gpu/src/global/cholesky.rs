//! [`Cholesky`]: a factored sparse matrix, with three right-hand sides.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMat, SymbolicSparseColMat};
use faer::{Conj, Mat, Par, Side, Spec};
use incise_mesh::Vec3;
use std::fmt;

/// A part of an element of the lower triangle of a matrix.
#[derive(Debug, Clone, Copy)]
pub(super) struct Entry {
    pub(super) row: u32,
    pub(super) column: u32,
    pub(super) value: f64,
}

/// A factored sparse matrix.
pub(super) struct Cholesky {
    count: usize,
    symbolic: SymbolicCholesky<usize>,
    values: Vec<f64>,
}

impl fmt::Debug for Cholesky {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Cholesky")
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

impl Cholesky {
    /// Factors the matrix of `count` rows whose lower triangle is the sum of some entries.
    ///
    /// `None` if it is not positive definite in 64 bits.
    pub(super) fn new(count: usize, entries: &[Entry]) -> Option<Self> {
        let matrix = assemble(count, entries);
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
        Some(Self {
            count,
            symbolic,
            values,
        })
    }

    /// Returns the number of entries.
    pub(super) fn entries(&self) -> usize {
        self.values.len()
    }

    /// Returns the size of the factor, its structure and scratch memory \[bytes\].
    pub(super) fn bytes(&self) -> usize {
        let indices = match self.symbolic.raw() {
            SymbolicCholeskyRaw::Simplicial(symbolic) => symbolic.row_idx(),
            SymbolicCholeskyRaw::Supernodal(symbolic) => symbolic.row_idx(),
        };
        let scratch = self.symbolic.solve_in_place_scratch::<f64>(3, Par::Seq);
        8 * (self.values.len() + indices.len() + 3 * self.count)
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

    /// Replaces the entries of `vector` at some vertices by those of `A^-1 vector`.
    ///
    /// `rows` are pairs of row and vertex; the other rows of the right-hand side are zero.
    pub(super) fn solve(
        &self,
        rows: impl Iterator<Item = (usize, usize)> + Clone,
        vector: &mut [Vec3],
        scratch: &mut SolveScratch,
    ) {
        let SolveScratch { right, memory } = scratch;
        right.fill(0.0);
        for (row, v) in rows.clone() {
            for k in 0..3 {
                right[(row, k)] = vector[v][k];
            }
        }
        LltRef::new(&self.symbolic, &self.values).solve_in_place_with_conj(
            Conj::No,
            right.as_mut(),
            Par::Seq,
            MemStack::new(memory),
        );
        for (row, v) in rows {
            vector[v] = Vec3::from_fn(|k, _| right[(row, k)]);
        }
    }
}

/// Adds entries up.
fn assemble(count: usize, entries: &[Entry]) -> SparseColMat<usize, f64> {
    let mut starts = vec![0; count + 1];
    for entry in entries {
        starts[entry.column as usize + 1] += 1;
    }
    for column in 0..count {
        starts[column + 1] += starts[column];
    }
    let mut next = starts.clone();
    let mut by_column = vec![(0, 0.0); entries.len()];
    for entry in entries {
        let place = &mut next[entry.column as usize];
        by_column[*place] = (entry.row, entry.value);
        *place += 1;
    }
    // The place of a row's sum among those of the column; those of other columns are outdated.
    let mut places = vec![usize::MAX; count];
    let mut sums: Vec<(u32, f64)> = Vec::with_capacity(entries.len() / 2);
    for column in 0..count {
        let first = sums.len();
        for &(row, value) in &by_column[starts[column]..starts[column + 1]] {
            let place = &mut places[row as usize];
            match sums.get_mut(*place).filter(|_| *place >= first) {
                Some((_, sum)) => *sum += value,
                None => {
                    *place = sums.len();
                    sums.push((row, value));
                }
            }
        }
        sums[first..].sort_unstable_by_key(|&(row, _)| row);
        starts[column] = first;
    }
    starts[count] = sums.len();
    let rows = sums.iter().map(|&(row, _)| row as usize).collect();
    let structure = SymbolicSparseColMat::new_checked(count, count, starts, None, rows);
    let values = sums.into_iter().map(|(_, value)| value).collect();
    SparseColMat::new(structure, values)
}
