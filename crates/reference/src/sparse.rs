//! Cholesky factorization of sparse symmetric matrices, by `faer`.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, Mat, Par, Side, Spec};

/// A factored symmetric matrix, on one thread. Bits depend on the CPU's instruction set.
pub(super) struct Cholesky {
    symbolic: SymbolicCholesky<usize>,
    values: Vec<f64>,
}

/// The right-hand side of a solve, which becomes its solution, and its memory.
pub(super) struct Scratch {
    /// The right-hand side, in column 0.
    pub(super) right: Mat<f64>,
    memory: MemBuffer,
}

impl Cholesky {
    /// Analyzes the structure of a lower triangle. A matrix is factored by [`Cholesky::factor`].
    ///
    /// `None` if there is not enough memory.
    pub(super) fn analyze(lower: SymbolicSparseColMatRef<'_, usize>) -> Option<Self> {
        let (order, params) = (SymmetricOrdering::Amd, CholeskySymbolicParams::default());
        let symbolic = factorize_symbolic_cholesky(lower, Side::Lower, order, params).ok()?;
        Some(Self {
            values: vec![0.0; symbolic.len_val()],
            symbolic,
        })
    }

    /// Factors a matrix of the analyzed structure for later solves.
    ///
    /// Returns false if it is not positive definite in 64 bits, or if there is not enough memory.
    pub(super) fn factor(&mut self, lower: SparseColMatRef<'_, usize, f64>) -> bool {
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

    /// Allocates a right-hand side of zeros and the memory of a solve; `None` if there is not
    /// enough.
    pub(super) fn scratch(&self) -> Option<Scratch> {
        let request = (self.symbolic).solve_in_place_scratch::<f64>(1, Par::Seq);
        Some(Scratch {
            right: Mat::zeros(self.symbolic.nrows(), 1),
            memory: MemBuffer::try_new(request).ok()?,
        })
    }

    /// Replaces the right-hand side by the solution.
    ///
    /// # Panics
    /// If the scratch memory was made for another matrix.
    pub(super) fn solve(&self, scratch: &mut Scratch) {
        let Scratch { right, memory } = scratch;
        LltRef::new(&self.symbolic, &self.values).solve_in_place_with_conj(
            Conj::No,
            right.as_mut(),
            Par::Seq,
            MemStack::new(memory),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use faer::sparse::{SparseColMat, Triplet};

    /// Returns the lower triangle of the second difference on `count` points, plus `diagonal` in
    /// every row.
    fn second_difference(count: usize, diagonal: f64) -> SparseColMat<usize, f64> {
        let own = (0..count).map(|row| Triplet::new(row, row, 2.0 + diagonal));
        let beside = (1..count).map(|row| Triplet::new(row, row - 1, -1.0));
        let all: Vec<_> = own.chain(beside).collect();
        SparseColMat::try_new_from_triplets(count, count, &all).unwrap()
    }

    /// Factors a lower triangle; `None` if that fails.
    fn factored(lower: &SparseColMat<usize, f64>) -> Option<Cholesky> {
        let mut factor = Cholesky::analyze(lower.symbolic()).unwrap();
        factor.factor(lower.as_ref()).then_some(factor)
    }

    /// A load of 2 in every row bends the line between fixed ends to the parabola `i (n + 1 - i)`.
    #[test]
    fn a_uniform_load_gives_a_parabola() {
        let count = 300;
        let factor = factored(&second_difference(count, 0.0)).unwrap();
        assert!(
            factor.values.len() >= 2 * count - 1,
            "the factor has the band"
        );
        let mut scratch = factor.scratch().unwrap();
        for row in 0..count {
            scratch.right[(row, 0)] = 2.0;
        }
        factor.solve(&mut scratch);
        for row in 0..count {
            let expected = ((row + 1) * (count - row)) as f64;
            let found = scratch.right[(row, 0)];
            let error = (found - expected).abs() / expected;
            assert!(error < 1e-11, "row {row} is {found}, not {expected}");
        }
    }

    #[test]
    fn a_matrix_that_is_not_positive_definite_has_no_factor() {
        for diagonal in [-0.5, f64::NAN] {
            let lower = second_difference(300, diagonal);
            assert!(factored(&lower).is_none(), "{diagonal}");
        }
    }

    #[test]
    fn an_empty_matrix_has_a_factor() {
        let factor = factored(&second_difference(0, 0.0)).unwrap();
        let mut scratch = factor.scratch().unwrap();
        factor.solve(&mut scratch);
        assert_eq!(scratch.right.nrows(), 0);
    }
}
