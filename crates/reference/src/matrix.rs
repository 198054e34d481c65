//! The sparse symmetric matrix of a step: analyzed once per model, factored per Newton step.

use super::error::ReferenceError;
use super::measure::Blocks;
use super::model::Model;
use super::sparse::{self, Scratch};
use super::volume::Piece;
use faer::sparse::{Argsort, Pair, SparseColMat, SymbolicSparseColMat};
use nalgebra::{Cholesky, DMatrix, DVector, Dyn, Vector3};

/// A vertex of an element and a coordinate of it.
type Place = (usize, usize);

/// The matrix, its factor and workspace.
pub(super) struct System {
    /// Index of every vertex among the moving ones.
    numbers: Vec<Option<usize>>,
    moving: usize,
    pattern: SymbolicSparseColMat<usize>,
    sorting: Argsort<usize>,
    /// Entries in the order of addition; several may share a place.
    values: Vec<f64>,
    factor: sparse::Cholesky,
    scratch: Scratch,
    /// Columns whose outer products are added to the sparse matrix, over all vertices; zero where a
    /// vertex is held.
    columns: Vec<Vec<Vector3<f64>>>,
    /// Their part of the last factor.
    low_rank: Option<LowRank>,
}

/// Woodbury's formula for a sparse matrix plus outer products of columns.
struct LowRank {
    columns: Vec<Vec<Vector3<f64>>>,
    /// The inverse of the sparse matrix times the columns.
    solved: Vec<Vec<Vector3<f64>>>,
    /// The factored identity plus the products of these with the columns.
    small: Cholesky<f64, Dyn>,
}

impl System {
    /// Analyzes the pattern of a model.
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
        for side in model.volumes.pieces.iter().flat_map(Piece::sides) {
            entries([side[0], side[1]].map(|v| numbers[v]), &mut note);
        }
        let unknowns = 3 * moving;
        let failed = ReferenceError::NotFactored { unknowns };
        let (pattern, sorting) =
            SymbolicSparseColMat::try_new_from_indices(unknowns, unknowns, &places)
                .map_err(|_| failed)?;
        let factor = sparse::Cholesky::analyze(pattern.as_ref());
        let factor = factor.ok_or(failed)?;
        let scratch = factor.scratch().ok_or(failed)?;
        Ok(Self {
            numbers,
            moving,
            values: Vec::with_capacity(places.len()),
            factor,
            scratch,
            pattern,
            sorting,
            columns: Vec::new(),
            low_rank: None,
        })
    }

    /// Clears the entries.
    pub(super) fn clear(&mut self) {
        self.values.clear();
        self.columns.clear();
    }

    /// Adds the outer product of a column over all vertices, which is dense.
    pub(super) fn add_column(&mut self, mut column: Vec<Vector3<f64>>) {
        for (number, entry) in self.numbers.iter().zip(&mut column) {
            if number.is_none() {
                *entry = Vector3::zeros();
            }
        }
        self.columns.push(column);
    }

    /// Adds the entries of the next element, in the order of [`System::new`]: vertices, edges,
    /// hinges, sides of pieces.
    pub(super) fn add<const N: usize>(&mut self, vertices: [usize; N], blocks: &Blocks<N>) {
        let (numbers, values) = (&self.numbers, &mut self.values);
        entries(vertices.map(|v| numbers[v]), |_, _, (a, i), (b, j)| {
            values.push(blocks[a][b][(i, j)]);
        });
    }

    /// Factors the matrix; returns whether it is positive definite.
    pub(super) fn factor(&mut self) -> bool {
        let Ok(matrix) =
            SparseColMat::new_from_argsort(self.pattern.clone(), &self.sorting, &self.values)
        else {
            return false;
        };
        self.factor.factor(matrix.as_ref()) && self.factor_columns()
    }

    /// Prepares Woodbury's formula for the factored matrix; returns whether the sum is positive
    /// definite.
    fn factor_columns(&mut self) -> bool {
        self.low_rank = None;
        if self.columns.is_empty() {
            return true;
        }
        let columns = std::mem::take(&mut self.columns);
        let solved: Option<Vec<_>> = columns.iter().map(|u| self.solve_sparse(u)).collect();
        let Some(solved) = solved else {
            return false;
        };
        let small = DMatrix::from_fn(columns.len(), columns.len(), |i, j| {
            let one = if i == j { 1.0 } else { 0.0 };
            one + dot(&columns[i], &solved[j])
        });
        let Some(small) = Cholesky::new(small) else {
            return false;
        };
        self.low_rank = Some(LowRank {
            columns,
            solved,
            small,
        });
        true
    }

    /// Solves for a right side over all vertices, zero where a vertex is held; none if the solution
    /// overflows.
    pub(super) fn solve(&mut self, right: &[Vector3<f64>]) -> Option<Vec<Vector3<f64>>> {
        let mut out = self.solve_sparse(right)?;
        if let Some(LowRank {
            columns,
            solved,
            small,
        }) = &self.low_rank
        {
            let along = columns.iter().map(|u| dot(u, &out));
            let shares = small.solve(&DVector::from_iterator(columns.len(), along));
            for (solved, share) in solved.iter().zip(&shares) {
                for (out, solved) in out.iter_mut().zip(solved) {
                    *out -= solved * *share;
                }
            }
        }
        Some(out)
    }

    /// Solves with the sparse matrix alone.
    fn solve_sparse(&mut self, right: &[Vector3<f64>]) -> Option<Vec<Vector3<f64>>> {
        let mut out = vec![Vector3::zeros(); right.len()];
        if self.moving == 0 {
            return Some(out);
        }
        for (number, right) in self.numbers.iter().zip(right) {
            if let Some(number) = number {
                for k in 0..3 {
                    self.scratch.right[(3 * number + k, 0)] = right[k];
                }
            }
        }
        self.factor.solve(&mut self.scratch);
        for (number, out) in self.numbers.iter().zip(&mut out) {
            if let Some(number) = number {
                *out = Vector3::from_fn(|k, _| self.scratch.right[(3 * number + k, 0)]);
            }
        }
        out.iter()
            .all(|p| p.iter().all(|c| c.is_finite()))
            .then_some(out)
    }

    /// Returns the product of the matrix with a vector over all vertices.
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
        for column in &self.columns {
            let along = dot(column, by);
            for (out, column) in out.iter_mut().zip(column) {
                *out += column * along;
            }
        }
        out
    }
}

fn dot(a: &[Vector3<f64>], b: &[Vector3<f64>]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(b)).sum()
}

/// Calls `name` for every entry of an element in the lower triangle, with its row, its column and
/// its place in the element.
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
