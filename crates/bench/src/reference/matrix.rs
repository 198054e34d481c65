//! The sparse symmetric matrix of a step: its pattern and order of elimination once a model, its numbers once
//! a step of Newton's method.

use super::error::ReferenceError;
use super::measure::Blocks;
use super::model::Model;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{Argsort, Pair, SparseColMat, SymbolicSparseColMat};
use faer::{Conj, Mat, Par, Side, Spec};
use nalgebra::Vector3;

/// A vertex of an element and a coordinate.
type Place = (usize, usize);

/// The matrix, its factor and room to work in.
pub(super) struct System {
    /// The number of every vertex among those that move.
    numbers: Vec<Option<usize>>,
    moving: usize,
    pattern: SymbolicSparseColMat<usize>,
    sorting: Argsort<usize>,
    /// Entries in the order in which they are added; several may have one place.
    values: Vec<f64>,
    symbolic: SymbolicCholesky<usize>,
    factor: Vec<f64>,
    memory: MemBuffer,
    right: Mat<f64>,
}

impl System {
    /// The pattern of a model.
    pub(super) fn new(model: &Model) -> Result<Self, ReferenceError> {
        let mut numbers = vec![None; model.mass.len()];
        let mut moving = 0;
        for (number, &mass) in numbers.iter_mut().zip(&model.mass) {
            if mass > 0.0 {
                *number = Some(moving);
                moving += 1;
            }
        }
        let mut places: Vec<Pair<usize, usize>> = Vec::new();
        let mut note = |row, col, _: Place, _: Place| places.push(Pair { row, col });
        for &number in &numbers {
            entries([number], &mut note);
        }
        for vertices in &model.stretch.vertices {
            entries(vertices.map(|v| numbers[v]), &mut note);
        }
        for vertices in &model.bending.vertices {
            entries(vertices.map(|v| numbers[v]), &mut note);
        }
        let unknowns = 3 * moving;
        let failed = ReferenceError::NotFactored { unknowns };
        let (pattern, sorting) =
            SymbolicSparseColMat::try_new_from_indices(unknowns, unknowns, &places)
                .map_err(|_| failed)?;
        let symbolic = factorize_symbolic_cholesky(
            pattern.as_ref(),
            Side::Lower,
            SymmetricOrdering::Amd,
            CholeskySymbolicParams::default(),
        )
        .map_err(|_| failed)?;
        let request = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Spec::default());
        let request = request.or(symbolic.solve_in_place_scratch::<f64>(1, Par::Seq));
        let memory = MemBuffer::try_new(request).map_err(|_| failed)?;
        Ok(Self {
            numbers,
            moving,
            values: Vec::with_capacity(places.len()),
            factor: vec![0.0; symbolic.len_val()],
            right: Mat::zeros(unknowns, 1),
            pattern,
            sorting,
            symbolic,
            memory,
        })
    }

    /// Forgets the entries.
    pub(super) fn clear(&mut self) {
        self.values.clear();
    }

    /// Adds the next element's entries; elements come in the order of [`System::new`]: vertices, edges, hinges.
    pub(super) fn add<const N: usize>(&mut self, vertices: [usize; N], blocks: &Blocks<N>) {
        let (numbers, values) = (&self.numbers, &mut self.values);
        entries(vertices.map(|v| numbers[v]), |_, _, (a, i), (b, j)| {
            values.push(blocks[a][b][(i, j)]);
        });
    }

    /// Factors the matrix; false if it is not positive.
    pub(super) fn factor(&mut self) -> bool {
        let Ok(matrix) =
            SparseColMat::new_from_argsort(self.pattern.clone(), &self.sorting, &self.values)
        else {
            return false;
        };
        let llt = self.symbolic.factorize_numeric_llt(
            &mut self.factor,
            matrix.as_ref(),
            Side::Lower,
            LltRegularization::default(),
            Par::Seq,
            MemStack::new(&mut self.memory),
            Spec::default(),
        );
        llt.is_ok()
    }

    /// Solves with the last factor for a right side over all vertices, zeros where nothing moves; none if the numbers are
    /// too large.
    pub(super) fn solve(&mut self, right: &[Vector3<f64>]) -> Option<Vec<Vector3<f64>>> {
        let mut out = vec![Vector3::zeros(); right.len()];
        if self.moving == 0 {
            return Some(out);
        }
        for (number, right) in self.numbers.iter().zip(right) {
            if let Some(number) = number {
                for k in 0..3 {
                    self.right[(3 * number + k, 0)] = right[k];
                }
            }
        }
        let stack = MemStack::new(&mut self.memory);
        let llt = LltRef::new(&self.symbolic, &self.factor);
        llt.solve_in_place_with_conj(Conj::No, self.right.as_mut(), Par::Seq, stack);
        for (number, out) in self.numbers.iter().zip(&mut out) {
            if let Some(number) = number {
                *out = Vector3::from_fn(|k, _| self.right[(3 * number + k, 0)]);
            }
        }
        out.iter()
            .all(|p| p.iter().all(|c| c.is_finite()))
            .then_some(out)
    }

    /// The product of the matrix with a vector over all vertices.
    #[cfg(test)]
    pub(super) fn multiply(&self, by: &[Vector3<f64>], model: &Model) -> Vec<Vector3<f64>> {
        let mut out = vec![Vector3::zeros(); by.len()];
        let vertices: Vec<usize> = (0..by.len()).filter(|&v| model.mass[v] > 0.0).collect();
        let matrix =
            SparseColMat::new_from_argsort(self.pattern.clone(), &self.sorting, &self.values)
                .unwrap();
        for t in matrix.triplet_iter() {
            let (r, c) = (t.row, t.col);
            out[vertices[r / 3]][r % 3] += t.val * by[vertices[c / 3]][c % 3];
            if r != c {
                out[vertices[c / 3]][c % 3] += t.val * by[vertices[r / 3]][r % 3];
            }
        }
        out
    }
}

/// Names the entries of an element that stand in the lower triangle: row and column, and which those are in the
/// element.
fn entries<const N: usize>(
    numbers: [Option<usize>; N],
    mut name: impl FnMut(usize, usize, Place, Place),
) {
    for (a, row) in numbers.iter().enumerate() {
        for (b, column) in numbers.iter().enumerate() {
            let (Some(row), Some(column)) = (row, column) else {
                continue;
            };
            if row < column {
                continue;
            }
            for i in 0..3 {
                let last = if row == column { i } else { 2 };
                for j in 0..=last {
                    name(3 * row + i, 3 * column + j, (a, i), (b, j));
                }
            }
        }
    }
}
