//! Preconditioned conjugate gradients for three right-hand sides at once.
//!
//! The preconditioner is a modified incomplete Cholesky factorization `C D^-1 C^T` with the
//! matrix's off-diagonal entries (Gustafsson 1978). It nearly keeps row sums, so smooth errors
//! vanish at once and the number of steps grows with the square root of the usual number. `C` is
//! the lower triangle with the pivots `D` on its diagonal. The iteration uses `C^-1 A C^-T`, whose
//! product takes two triangular solves (Eisenstat 1981).

use incise_mesh::index_u32;

/// Tolerance of the residual relative to that of zero, in the norm of the preconditioner.
const TOLERANCE: f64 = 2e-4;

/// Share of the dropped fill-in that is added to the diagonal; all of it would be less stable.
const DIAGONAL_SHARE: f64 = 0.97;

/// Pivots below this share of the matrix's diagonal entry are reset to that entry.
const MIN_PIVOT: f64 = 0.2;

/// Maximum number of steps, ten times what a mesh of a million triangles takes.
const MAX_STEPS: usize = 1000;

/// A symmetric matrix with a positive diagonal and negative other entries, and three right sides.
#[derive(Debug, Clone, Default)]
pub(super) struct System {
    /// End of each row in `entries`.
    ends: Vec<u32>,
    /// Start of each row's entries right of the diagonal.
    middles: Vec<u32>,
    /// Column and negated value of each entry, ascending in each row.
    entries: Vec<(u32, f32)>,
    diagonal: Vec<f64>,
    right: Vec<[f64; 3]>,
}

impl System {
    pub(super) fn clear(&mut self) {
        self.ends.clear();
        self.middles.clear();
        self.entries.clear();
        self.diagonal.clear();
        self.right.clear();
    }

    /// Adds a negated entry to the next row.
    pub(super) fn add(&mut self, column: u32, weight: f32) {
        self.entries.push((column, weight));
    }

    /// Completes the next row.
    pub(super) fn finish_row(&mut self, diagonal: f64, right: [f64; 3]) {
        let row = index_u32(self.diagonal.len());
        let start = self.ends.last().copied().unwrap_or(0);
        let entries = &mut self.entries[start as usize..];
        entries.sort_unstable_by_key(|entry| entry.0);
        let left = entries.partition_point(|entry| entry.0 < row);
        self.middles.push(start + index_u32(left));
        self.ends.push(index_u32(self.entries.len()));
        self.diagonal.push(diagonal);
        self.right.push(right);
    }

    /// Returns the entries left and right of the diagonal.
    #[inline]
    fn row(&self, i: usize) -> [&[(u32, f32)]; 2] {
        let start = if i == 0 { 0 } else { self.ends[i - 1] } as usize;
        let (middle, end) = (self.middles[i] as usize, self.ends[i] as usize);
        [&self.entries[start..middle], &self.entries[middle..end]]
    }
}

/// Scratch memory of the solver.
#[derive(Debug, Clone, Default)]
pub(super) struct ConjugateGradient {
    pivots: Vec<f64>,
    /// Sum of each row's entries right of the diagonal.
    upper: Vec<f64>,
    residual: Vec<[f64; 3]>,
    direction: Vec<[f64; 3]>,
    /// The direction in the unknowns of the system, `C^-T` times `direction`.
    step: Vec<[f64; 3]>,
    product: Vec<[f64; 3]>,
}

impl ConjugateGradient {
    /// Solves for `x`, starting at its current value, and returns the number of steps.
    pub(super) fn solve(&mut self, system: &System, x: &mut [[f64; 3]]) -> usize {
        self.factor(system);
        let n = x.len();
        self.product.clear();
        self.product.extend_from_slice(&system.right);
        solve_lower(system, &self.pivots, &mut self.product);
        let goal = self.squared_norm(&self.product);
        let goal = goal.map(|square| square * TOLERANCE * TOLERANCE);
        self.residual.clear();
        for i in 0..n {
            let (b, product) = (system.right[i], multiply(system, i, x));
            self.residual.push([0, 1, 2].map(|k| b[k] - product[k]));
        }
        solve_lower(system, &self.pivots, &mut self.residual);
        self.direction.clear();
        self.direction.resize(n, [0.0; 3]);
        self.step.resize(n, [0.0; 3]);
        let mut square = self.squared_norm(&self.residual);
        let mut beta = [0.0; 3];
        for step in 0..MAX_STEPS {
            // A converged coordinate stays as it is; NaN counts as converged.
            let is_active = [0, 1, 2].map(|k| square[k] > goal[k]);
            if is_active == [false; 3] {
                return step;
            }
            self.update_direction(beta);
            self.step.copy_from_slice(&self.direction);
            solve_upper(system, &self.pivots, &mut self.step);
            for i in 0..n {
                let excess = system.diagonal[i] - 2.0 * self.pivots[i];
                let (d, delta) = (self.direction[i], self.step[i]);
                self.product[i] = [0, 1, 2].map(|k| d[k] + excess * delta[k]);
            }
            solve_lower(system, &self.pivots, &mut self.product);
            let mut along = [0.0; 3];
            for i in 0..n {
                let (d, delta) = (self.direction[i], self.step[i]);
                let product = &mut self.product[i];
                *product = [0, 1, 2].map(|k| product[k] + delta[k]);
                along = [0, 1, 2].map(|k| along[k] + d[k] * product[k]);
            }
            let part = |k: usize| {
                if is_active[k] {
                    square[k] / along[k]
                } else {
                    0.0
                }
            };
            let length = [0, 1, 2].map(part);
            for (i, x) in x.iter_mut().enumerate() {
                let (delta, product) = (self.step[i], self.product[i]);
                *x = [0, 1, 2].map(|k| x[k] + length[k] * delta[k]);
                let residual = &mut self.residual[i];
                *residual = [0, 1, 2].map(|k| residual[k] - length[k] * product[k]);
            }
            let new = self.squared_norm(&self.residual);
            beta = [0, 1, 2].map(|k| {
                if is_active[k] {
                    new[k] / square[k]
                } else {
                    0.0
                }
            });
            square = new;
        }
        MAX_STEPS
    }

    /// Computes the pivots of the incomplete factorization.
    fn factor(&mut self, system: &System) {
        self.pivots.clear();
        self.upper.clear();
        for (i, &own) in system.diagonal.iter().enumerate() {
            let [left, right] = system.row(i);
            let mut pivot = own;
            for &(k, weight) in left {
                let (k, weight) = (k as usize, f64::from(weight));
                // The elimination of row k adds fill-in, of which this is dropped.
                let dropped = self.upper[k] - weight;
                pivot -= weight / self.pivots[k] * (weight + DIAGONAL_SHARE * dropped);
            }
            let is_stable = pivot > MIN_PIVOT * own;
            self.pivots.push(if is_stable { pivot } else { own });
            self.upper
                .push(right.iter().map(|entry| f64::from(entry.1)).sum());
        }
    }

    /// Sets the next direction to the preconditioned residual plus `beta` times the last one.
    fn update_direction(&mut self, beta: [f64; 3]) {
        let known = self.residual.iter().zip(&self.pivots);
        for (d, (r, pivot)) in self.direction.iter_mut().zip(known) {
            *d = [0, 1, 2].map(|k| pivot * r[k] + beta[k] * d[k]);
        }
    }

    /// Returns the squared norm of a residual in the norm of the preconditioner.
    fn squared_norm(&self, residual: &[[f64; 3]]) -> [f64; 3] {
        let pairs = residual.iter().zip(&self.pivots);
        pairs.fold([0.0; 3], |sum, (r, pivot)| {
            [0, 1, 2].map(|k| sum[k] + pivot * r[k] * r[k])
        })
    }
}

/// Replaces `x` by `C^-1 x`.
fn solve_lower(system: &System, pivots: &[f64], x: &mut [[f64; 3]]) {
    for i in 0..x.len() {
        let sum = add_products(x[i], system.row(i)[0], x);
        x[i] = sum.map(|x| x / pivots[i]);
    }
}

/// Replaces `x` by `C^-T x`.
fn solve_upper(system: &System, pivots: &[f64], x: &mut [[f64; 3]]) {
    for i in (0..x.len()).rev() {
        let sum = add_products(x[i], system.row(i)[1], x);
        x[i] = sum.map(|x| x / pivots[i]);
    }
}

/// Returns row `i` of the matrix times `x`.
fn multiply(system: &System, i: usize, x: &[[f64; 3]]) -> [f64; 3] {
    let own = x[i].map(|x| x * -system.diagonal[i]);
    let [left, right] = system.row(i);
    add_products(add_products(own, left, x), right, x).map(|x| -x)
}

/// Adds the products of entries and `x` to a sum.
#[inline]
fn add_products(mut sum: [f64; 3], entries: &[(u32, f32)], x: &[[f64; 3]]) -> [f64; 3] {
    for &(j, weight) in entries {
        let (other, weight) = (x[j as usize], f64::from(weight));
        sum = [0, 1, 2].map(|k| sum[k] + weight * other[k]);
    }
    sum
}
