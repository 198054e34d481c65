//! Cholesky factorization of a sparse matrix by the envelope of its lower triangle.
//!
//! A row is stored from its first nonzero entry to the diagonal, and fill-in stays within that
//! range (George and Liu, "Computer Solution of Large Sparse Positive Definite Systems", 1981,
//! chapter 4). The reverse Cuthill-McKee order keeps rows short: O(sqrt(n)) entries for a patch of
//! n vertices, so that a factorization takes O(n^2) operations. Sums have a fixed order, so that
//! results are the same bits on every CPU.

use incise_mesh::index_u32;
use std::collections::VecDeque;

/// A row of a least squares problem: unknowns, each once, and their coefficients.
pub(super) type Row = Vec<(u32, f64)>;

/// The matrix `B^T B` of normal equations, or its factor `L` with `L L^T = B^T B`.
pub(super) struct Envelope {
    /// Position of each unknown in the order of elimination.
    positions: Vec<u32>,
    /// Column of the first stored entry of each row.
    first: Vec<usize>,
    /// Start of each row in `values`, and the end of the last one.
    starts: Vec<usize>,
    values: Vec<f64>,
}

impl Envelope {
    /// Builds the matrix of normal equations for the rows of `B`.
    pub(super) fn of_normal_equations(unknowns: usize, rows: &[Row]) -> Self {
        let positions = reverse_cuthill_mckee(&neighbors(unknowns, rows));
        let place = |entry: &(u32, f64)| positions[entry.0 as usize] as usize;
        let mut first: Vec<usize> = (0..unknowns).collect();
        for row in rows {
            let least = row.iter().map(place).min().unwrap_or(0);
            for entry in row {
                let i = place(entry);
                first[i] = first[i].min(least);
            }
        }
        let mut starts = Vec::with_capacity(unknowns + 1);
        let mut end = 0;
        for (i, first) in first.iter().enumerate() {
            starts.push(end);
            end += i + 1 - first;
        }
        starts.push(end);
        let mut values = vec![0.0; end];
        for row in rows {
            for a in row {
                let i = place(a);
                for b in row.iter().filter(|b| place(b) <= i) {
                    values[starts[i] + place(b) - first[i]] += a.1 * b.1;
                }
            }
        }
        Self {
            positions,
            first,
            starts,
            values,
        }
    }

    /// Replaces the matrix by its factor; `None` if it is not positive definite in 64 bits.
    pub(super) fn factor(mut self) -> Option<Self> {
        for i in 0..self.first.len() {
            let (before, row) = self.values.split_at_mut(self.starts[i]);
            let row_first = self.first[i];
            for j in row_first..i {
                let other = &before[self.starts[j]..self.starts[j + 1]];
                let common = row_first.max(self.first[j]);
                let ours = &row[common - row_first..j - row_first];
                let theirs = &other[common - self.first[j]..j - self.first[j]];
                let pivot = other[j - self.first[j]];
                row[j - row_first] = (row[j - row_first] - dot(ours, theirs)) / pivot;
            }
            let (left, diagonal) = row.split_at_mut(i - row_first);
            let square = diagonal[0] - dot(left, left);
            // The comparison is false for NaN.
            if square > 0.0 {
                diagonal[0] = square.sqrt();
            } else {
                return None;
            }
        }
        Some(self)
    }

    /// Solves for one right-hand side per column with the factor.
    pub(super) fn solve<const N: usize>(&self, right: &[[f64; N]]) -> Vec<[f64; N]> {
        let mut x = vec![[0.0; N]; right.len()];
        for (&position, &value) in self.positions.iter().zip(right) {
            x[position as usize] = value;
        }
        for i in 0..x.len() {
            let (left, pivot) = self.row(i);
            for (&a, j) in left.iter().zip(self.first[i]..) {
                let other = x[j];
                subtract(&mut x[i], a, other);
            }
            x[i] = x[i].map(|value| value / pivot);
        }
        for i in (0..x.len()).rev() {
            let (left, pivot) = self.row(i);
            x[i] = x[i].map(|value| value / pivot);
            for (&a, j) in left.iter().zip(self.first[i]..) {
                let other = x[i];
                subtract(&mut x[j], a, other);
            }
        }
        let solution = self.positions.iter().map(|&position| x[position as usize]);
        solution.collect()
    }

    /// Returns the entries of a row left of the diagonal, and the diagonal.
    fn row(&self, i: usize) -> (&[f64], f64) {
        let end = self.starts[i + 1] - 1;
        (&self.values[self.starts[i]..end], self.values[end])
    }
}

fn subtract<const N: usize>(x: &mut [f64; N], factor: f64, other: [f64; N]) {
    for (x, other) in x.iter_mut().zip(other) {
        *x -= factor * other;
    }
}

/// Returns the dot product of two slices of the same length, as four interleaved sums.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let (mut chunks_a, mut chunks_b) = (a.chunks_exact(4), b.chunks_exact(4));
    let mut sums = [0.0; 4];
    for (a, b) in chunks_a.by_ref().zip(chunks_b.by_ref()) {
        for k in 0..4 {
            sums[k] += a[k] * b[k];
        }
    }
    let rest = chunks_a.remainder().iter().zip(chunks_b.remainder());
    rest.fold((sums[0] + sums[1]) + (sums[2] + sums[3]), |sum, (a, b)| {
        sum + a * b
    })
}

/// Returns the unknowns that share a row with each unknown, ascending.
fn neighbors(unknowns: usize, rows: &[Row]) -> Vec<Vec<u32>> {
    let mut out = vec![Vec::new(); unknowns];
    for row in rows {
        for &(i, _) in row {
            let others = row.iter().map(|entry| entry.0).filter(|&j| j != i);
            out[i as usize].extend(others);
        }
    }
    for list in &mut out {
        list.sort_unstable();
        list.dedup();
    }
    out
}

/// Returns the position of each vertex in the reverse Cuthill-McKee order of a graph (1969).
fn reverse_cuthill_mckee(neighbors: &[Vec<u32>]) -> Vec<u32> {
    let count = neighbors.len();
    let mut order: Vec<u32> = Vec::with_capacity(count);
    let mut is_numbered = vec![false; count];
    for start in 0..index_u32(count) {
        if !is_numbered[start as usize] {
            let start = far_vertex(neighbors, start);
            order.extend(breadth_first(neighbors, start, &mut is_numbered));
        }
    }
    let mut positions = vec![0; count];
    for (position, &v) in (0..).zip(order.iter().rev()) {
        positions[v as usize] = position;
    }
    positions
}

/// Returns a vertex at an end of the component of `start`: the last one of two searches.
fn far_vertex(neighbors: &[Vec<u32>], start: u32) -> u32 {
    (0..2).fold(start, |v, _| {
        let order = breadth_first(neighbors, v, &mut vec![false; neighbors.len()]);
        order.last().copied().unwrap_or(v)
    })
}

/// Returns a component in breadth-first order; neighbors follow by degree, then by number.
fn breadth_first(neighbors: &[Vec<u32>], start: u32, is_reached: &mut [bool]) -> Vec<u32> {
    let mut order = Vec::new();
    let mut queue = VecDeque::from([start]);
    is_reached[start as usize] = true;
    while let Some(v) = queue.pop_front() {
        order.push(v);
        let first = queue.len();
        for &other in &neighbors[v as usize] {
            if !is_reached[other as usize] {
                is_reached[other as usize] = true;
                queue.push_back(other);
            }
        }
        queue.make_contiguous()[first..].sort_by_key(|&other| neighbors[other as usize].len());
    }
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Differences of neighbors on a ring with chords, and each unknown itself.
    fn rows(count: u32) -> Vec<Row> {
        let ring = (0..count).map(|i| vec![(i, 1.0), ((i + 1) % count, -0.75)]);
        let chords = (0..count / 2).map(|i| vec![(i, 0.5), (i + count / 2, 0.25)]);
        let own = (0..count).map(|i| vec![(i, 0.125)]);
        ring.chain(chords).chain(own).collect()
    }

    #[test]
    fn the_solution_satisfies_the_normal_equations() {
        let rows = rows(31);
        let known: Vec<[f64; 2]> = (0..31)
            .map(f64::from)
            .map(|i| [i.sin(), 1.0 / (1.0 + i)])
            .collect();
        let mut right = vec![[0.0; 2]; known.len()];
        for row in &rows {
            for k in 0..2 {
                let product: f64 = row.iter().map(|&(j, b)| b * known[j as usize][k]).sum();
                row.iter()
                    .for_each(|&(i, a)| right[i as usize][k] += a * product);
            }
        }
        let factor = Envelope::of_normal_equations(31, &rows).factor().unwrap();
        for (found, known) in factor.solve(&right).iter().zip(&known) {
            for (found, known) in found.iter().zip(known) {
                assert!((found - known).abs() < 1e-12, "{found} and {known}");
            }
        }
    }

    #[test]
    fn a_singular_matrix_has_no_factor() {
        let rows = [vec![(0, 2.0), (1, -2.0)]];
        assert!(Envelope::of_normal_equations(2, &rows).factor().is_none());
        assert!(Envelope::of_normal_equations(1, &[]).factor().is_none());
    }

    #[test]
    fn rows_of_a_grid_are_as_short_as_its_width() {
        let at = |x: u32, y: u32| 30 * (7 * y % 40) + (11 * x) % 30;
        let edge = |a: u32, b: u32| vec![(a, 1.0), (b, -1.0)];
        let rows: Vec<Row> = (0..40)
            .flat_map(|y| (0..30).map(move |x| (x, y)))
            .flat_map(|(x, y)| {
                let right = (x < 29).then(|| edge(at(x, y), at(x + 1, y)));
                let up = (y < 39).then(|| edge(at(x, y), at(x, y + 1)));
                right.into_iter().chain(up)
            })
            .collect();
        let matrix = Envelope::of_normal_equations(1200, &rows);
        let longest = matrix.starts.windows(2).map(|w| w[1] - w[0]).max().unwrap();
        assert!(longest <= 32, "{longest}");
    }
}
