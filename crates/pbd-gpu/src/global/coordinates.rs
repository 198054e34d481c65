//! Solves for the three coordinates of vertices at once.

use incise_mesh::Vec3;
use incise_sparse::{Cholesky, Scratch};

/// Number of right-hand sides.
pub(super) const COORDINATES: usize = 3;

/// Replaces the entries of `vector` at some vertices by those of `A^-1 vector`.
///
/// `rows` are pairs of row and vertex; the other rows of the right-hand side are zero.
pub(super) fn solve(
    factor: &Cholesky,
    rows: impl Iterator<Item = (usize, usize)> + Clone,
    vector: &mut [Vec3],
    scratch: &mut Scratch,
) {
    scratch.right.fill(0.0);
    for (row, v) in rows.clone() {
        for (k, &x) in vector[v].iter().enumerate() {
            scratch.right[(row, k)] = x;
        }
    }
    factor.solve(scratch);
    for (row, v) in rows {
        vector[v] = Vec3::from_fn(|k, _| scratch.right[(row, k)]);
    }
}
