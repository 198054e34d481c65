//! [`Cholesky`]: a factored sparse matrix.

use crate::Entry;
use crate::lower_triangle::sum;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, Mat, Par, Side, Spec};
use std::fmt;

/// Grouping of the columns of a factorization.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Columns {
    /// One after the other: the same bits on every CPU.
    Single,
    /// In dense blocks where these are faster. Bits depend on the CPU's instruction set.
    Blocks,
}

/// A factored symmetric matrix, on one thread.
pub struct Cholesky {
    symbolic: SymbolicCholesky<usize>,
    values: Vec<f64>,
}

/// Right-hand sides of a solve, which become its solutions, and its memory.
pub struct Scratch {
    /// Right-hand sides, one per column.
    pub right: Mat<f64>,
    memory: MemBuffer,
}

impl fmt::Debug for Cholesky {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Cholesky")
            .field("rows", &self.rows())
            .field("entries", &self.entries())
            .finish_non_exhaustive()
    }
}

impl fmt::Debug for Scratch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Scratch")
            .field("right", &self.right)
            .finish_non_exhaustive()
    }
}

impl Cholesky {
    /// Factors the matrix of `rows` rows whose lower triangle is the sum of some entries.
    ///
    /// `None` if it is not positive definite in 64 bits, or if there is not enough memory.
    ///
    /// # Panics
    /// If an entry is above the diagonal or outside the matrix.
    #[must_use]
    pub fn new(rows: usize, lower: &[Entry], columns: Columns) -> Option<Self> {
        let matrix = sum(rows, lower);
        let mut out = Self::analyze(matrix.symbolic(), columns)?;
        out.factor(matrix.as_ref()).then_some(out)
    }

    /// Analyzes the structure of a lower triangle. A matrix is factored by [`Cholesky::factor`].
    ///
    /// `None` if there is not enough memory.
    #[must_use]
    pub fn analyze(lower: SymbolicSparseColMatRef<'_, usize>, columns: Columns) -> Option<Self> {
        let mut params = CholeskySymbolicParams::default();
        if columns == Columns::Single {
            params.supernodal_flop_ratio_threshold = SupernodalThreshold::FORCE_SIMPLICIAL;
        }
        let order = SymmetricOrdering::Amd;
        let symbolic = factorize_symbolic_cholesky(lower, Side::Lower, order, params).ok()?;
        Some(Self {
            values: vec![0.0; symbolic.len_val()],
            symbolic,
        })
    }

    /// Factors a matrix of the analyzed structure for later solves.
    ///
    /// Returns false if it is not positive definite in 64 bits, or if there is not enough memory.
    pub fn factor(&mut self, lower: SparseColMatRef<'_, usize, f64>) -> bool {
        let symbolic = &self.symbolic;
        let request = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Spec::default());
        let Ok(mut memory) = MemBuffer::try_new(request) else {
            return false;
        };
        let factored = symbolic.factorize_numeric_llt(
            &mut self.values,
            lower,
            Side::Lower,
            LltRegularization::default(),
            Par::Seq,
            MemStack::new(&mut memory),
            Spec::default(),
        );
        factored.is_ok()
    }

    /// Allocates zero right-hand sides and the memory of a solve; `None` if there is not enough.
    #[must_use]
    pub fn scratch(&self, columns: usize) -> Option<Scratch> {
        let request = (self.symbolic).solve_in_place_scratch::<f64>(columns, Par::Seq);
        Some(Scratch {
            right: Mat::zeros(self.rows(), columns),
            memory: MemBuffer::try_new(request).ok()?,
        })
    }

    /// Replaces the right-hand sides by the solutions.
    ///
    /// # Panics
    /// If the scratch memory was made for another matrix.
    pub fn solve(&self, scratch: &mut Scratch) {
        let Scratch { right, memory } = scratch;
        LltRef::new(&self.symbolic, &self.values).solve_in_place_with_conj(
            Conj::No,
            right.as_mut(),
            Par::Seq,
            MemStack::new(memory),
        );
    }

    /// Returns the number of rows of the matrix.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.symbolic.nrows()
    }

    /// Returns the number of entries of the factor.
    #[must_use]
    pub fn entries(&self) -> usize {
        self.values.len()
    }

    /// Returns the size of the factor, its structure and a solve of some columns \[bytes\].
    #[must_use]
    pub fn bytes(&self, columns: usize) -> usize {
        let indices = match self.symbolic.raw() {
            SymbolicCholeskyRaw::Simplicial(symbolic) => symbolic.row_idx(),
            SymbolicCholeskyRaw::Supernodal(symbolic) => symbolic.row_idx(),
        };
        let scratch = (self.symbolic).solve_in_place_scratch::<f64>(columns, Par::Seq);
        8 * (self.values.len() + indices.len() + columns * self.rows())
            + scratch.unaligned_bytes_required()
    }
}
