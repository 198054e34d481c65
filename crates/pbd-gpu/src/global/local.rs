//! [`LocalFactor`]: the matrix of the vertices that an edit has touched.
//!
//! With `L` the touched vertices and `R` the others, the inverse of the matrix is
//!
//! ```text
//! A^-1 = E^T S^-1 E + A_LL^-1,    E = (I, -A_RL A_LL^-1),    S = A_RR - A_RL A_LL^-1 A_LR
//! ```
//!
//! Everything but `S^-1` is known without a factor of the whole matrix. The old factor serves as
//! `S^-1`: it is the same expression with the touched region before the edit, whose stiffness as
//! seen from `R` is similar. New slivers are nearly rigid, and only `A_LL` contains them.

use super::coordinates::{self, COORDINATES};
use super::matrix::{MatrixInput, NO_ROW, push_lower};
use incise_mesh::{Vec3, index_u32};
use incise_sparse::{Cholesky, Columns, Scratch};
use std::sync::Arc;

/// Maximum number of touched vertices: the factor is made in the frame of the edit.
const MAX_VERTICES: usize = 4096;

/// An entry of `A_LR`.
#[derive(Debug, Clone, Copy)]
struct Coupling {
    touched: u32,
    other: u32,
    value: f64,
}

/// The matrix of touched vertices, and its entries in the columns of others.
#[derive(Debug)]
pub(super) struct LocalFactor {
    shared: Arc<Shared>,
    scratch: Scratch,
    /// The right-hand side of the second solve, shape [vertex slots]; 0 except in use.
    right: Vec<Vec3>,
}

/// The part of a local factor that clones share.
#[derive(Debug)]
struct Shared {
    /// The touched vertices, in the order of rows.
    vertices: Vec<u32>,
    cholesky: Cholesky,
    couplings: Vec<Coupling>,
}

impl LocalFactor {
    /// Factors the matrix of the vertices without a row.
    ///
    /// `None` without such vertices, with too many, or if the matrix is not positive definite.
    pub(super) fn new(input: &MatrixInput, rows: &[u32]) -> Option<Self> {
        let is_touched = |v: usize| rows[v] == NO_ROW && input.inverse_masses[v] > 0.0;
        let vertices: Vec<u32> = (0..rows.len())
            .filter(|&v| is_touched(v))
            .map(index_u32)
            .collect();
        if vertices.is_empty() || vertices.len() > MAX_VERTICES {
            return None;
        }
        let mut local = vec![NO_ROW; rows.len()];
        let mut entries = Vec::new();
        for (row, &v) in vertices.iter().enumerate() {
            let row = index_u32(row);
            local[v as usize] = row;
            push_lower(&mut entries, [row; 2], input.mass(v as usize));
        }
        let mut couplings = Vec::new();
        input.for_each_entry(
            |v| local[v] != NO_ROW,
            |a, b, value| {
                push_lower(&mut entries, [local[a], local[b]], value);
                if local[a] != NO_ROW && rows[b] != NO_ROW {
                    couplings.push(Coupling {
                        touched: index_u32(a),
                        other: index_u32(b),
                        value,
                    });
                }
            },
        );
        let cholesky = Cholesky::new(vertices.len(), &entries, Columns::Blocks)?;
        Some(Self {
            scratch: cholesky.scratch(COORDINATES)?,
            right: vec![Vec3::zeros(); rows.len()],
            shared: Arc::new(Shared {
                vertices,
                cholesky,
                couplings,
            }),
        })
    }

    /// Returns a factor that shares the matrix; `None` if there is not enough memory.
    pub(super) fn share(&self) -> Option<Self> {
        Some(Self {
            shared: self.shared.clone(),
            scratch: self.shared.cholesky.scratch(COORDINATES)?,
            right: self.right.clone(),
        })
    }

    /// Multiplies by the approximate inverse; `solve` replaces the entries of other vertices by
    /// those of `S^-1 vector`.
    pub(super) fn apply(&mut self, vector: &mut [Vec3], solve: impl FnOnce(&mut [Vec3])) {
        let Self {
            shared,
            scratch,
            right,
        } = self;
        let touched = shared.vertices.iter().map(|&v| v as usize);
        let rows = touched.clone().enumerate();
        coordinates::solve(&shared.cholesky, rows.clone(), vector, scratch);
        for coupling in &shared.couplings {
            let by = vector[coupling.touched as usize] * coupling.value;
            vector[coupling.other as usize] -= by;
        }
        solve(vector);
        for coupling in &shared.couplings {
            let by = vector[coupling.other as usize] * coupling.value;
            right[coupling.touched as usize] += by;
        }
        coordinates::solve(&shared.cholesky, rows, right, scratch);
        for v in touched {
            vector[v] -= right[v];
            right[v] = Vec3::zeros();
        }
    }

    /// Returns the memory \[bytes\].
    pub(super) fn bytes(&self) -> usize {
        let Shared {
            vertices,
            cholesky,
            couplings,
        } = &*self.shared;
        cholesky.bytes(COORDINATES)
            + 4 * vertices.capacity()
            + size_of::<Coupling>() * couplings.capacity()
            + size_of::<Vec3>() * self.right.capacity()
    }
}
