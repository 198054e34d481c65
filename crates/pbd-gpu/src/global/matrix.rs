//! The matrix of the global step.
//!
//! `A = M + sum of w c c^T` over edges (`c = (1, -1)`), springs and hinges, with `w = 1 / alpha`.
//! The coefficients of a hinge are the lengths of its gradients at rest, with their signs. `A` acts
//! on each coordinate alike, so that one factor with three right-hand sides serves all of them.

use super::EnergySets;
use super::coordinates::COORDINATES;
use super::objective::Compliances;
use crate::constraints::batches::ConstraintSet;
use crate::kernels::bending::FLAT;
use incise_mesh::geometry::to_f64;
use incise_mesh::{Surface, Vec3, VertexId, index_u32};
use incise_sparse::{Cholesky, Columns, Entry};
use std::time::{Duration, Instant};

/// Row of a vertex that the factor does not know.
pub(super) const NO_ROW: u32 = u32::MAX;

/// An element of the matrix: its vertices, coefficients and weight.
type Element<const N: usize> = ([usize; N], [f64; N], f64);

/// A copy of masses, constraints and the rest shape, from which the matrix is assembled.
///
/// It is kept with the factor, so that a loaded body makes the same factor again.
#[derive(Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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

    /// Returns the mass of a vertex \[kg\], 0 of a fixed one.
    pub(super) fn mass(&self, v: usize) -> f64 {
        let w = self.inverse_masses[v];
        if w > 0.0 { 1.0 / f64::from(w) } else { 0.0 }
    }

    /// Returns the elements of edges and springs with a vertex for which `is_in` holds.
    fn lines_at(&self, is_in: impl Fn(usize) -> bool) -> impl Iterator<Item = Element<2>> {
        let by = self.compliances;
        let edges = self.edges.iter().map(move |ends| (ends, by.stretch));
        let springs = self.springs.iter();
        let springs = springs.map(move |ends| (ends, by.interior_springs));
        let all = edges.chain(springs);
        let all = all.map(|(ends, alpha)| (ends.map(VertexId::index), [-1.0, 1.0], 1.0 / alpha));
        all.filter(move |(ends, ..)| ends.iter().any(|&v| is_in(v)))
    }

    /// Returns the elements of hinges with a vertex for which `is_in` holds.
    fn hinges_at(&self, is_in: impl Fn(usize) -> bool) -> impl Iterator<Item = Element<4>> {
        self.hinges.iter().filter_map(move |vertices| {
            let vertices = vertices.map(VertexId::index);
            if !vertices.iter().any(|&v| is_in(v)) {
                return None;
            }
            let coefficients = hinge_coefficients(vertices.map(|v| to_f64(self.rest[v])))?;
            Some((vertices, coefficients, 1.0 / self.compliances.bending))
        })
    }

    /// Calls `add` with all places and values of elements with a vertex for which `is_in` holds.
    ///
    /// Their sum is the matrix without its masses, at least in the rows and columns of these
    /// vertices.
    pub(super) fn for_each_entry(
        &self,
        is_in: impl Fn(usize) -> bool + Copy,
        mut add: impl FnMut(usize, usize, f64),
    ) {
        for (vertices, coefficients, weight) in self.lines_at(is_in) {
            add_products(&vertices, &coefficients, weight, &mut add);
        }
        for (vertices, coefficients, weight) in self.hinges_at(is_in) {
            add_products(&vertices, &coefficients, weight, &mut add);
        }
    }

    /// Returns the product of the matrix with a vector.
    #[cfg(test)]
    pub(super) fn times(&self, vector: &[Vec3]) -> Vec<Vec3> {
        let masses = (0..vector.len()).map(|v| self.mass(v));
        let mut out: Vec<Vec3> = vector.iter().zip(masses).map(|(v, m)| v * m).collect();
        self.for_each_entry(|_| true, |a, b, value| out[a] += vector[b] * value);
        out
    }

    /// Assembles and factors the matrix; `None` if it is not positive definite in 64 bits.
    pub(super) fn factor(&self) -> Option<Factor> {
        let begin = Instant::now();
        let mut rows = vec![NO_ROW; self.inverse_masses.len()];
        let mut entries = Vec::new();
        for (v, row) in rows.iter_mut().enumerate() {
            let mass = self.mass(v);
            if mass > 0.0 {
                *row = index_u32(entries.len());
                push_lower(&mut entries, [*row; 2], mass);
            }
        }
        let count = entries.len();
        self.for_each_entry(
            |_| true,
            |a, b, value| push_lower(&mut entries, [rows[a], rows[b]], value),
        );
        Some(Factor {
            rows,
            cholesky: Cholesky::new(count, &entries, Columns::Blocks)?,
            time: begin.elapsed(),
        })
    }
}

/// Adds an entry of the lower triangle, if both rows exist.
pub(super) fn push_lower(entries: &mut Vec<Entry>, [row, column]: [u32; 2], value: f64) {
    if row >= column && row != NO_ROW {
        entries.push(Entry { row, column, value });
    }
}

/// Calls `add` with all entries of `weight c c^T`.
fn add_products(
    vertices: &[usize],
    coefficients: &[f64],
    weight: f64,
    add: &mut impl FnMut(usize, usize, f64),
) {
    for (&a, c) in vertices.iter().zip(coefficients) {
        for (&b, d) in vertices.iter().zip(coefficients) {
            add(a, b, weight * (c * d));
        }
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

/// Returns the coefficients of a hinge at rest [1/m]; `None` for a sliver without a normal.
///
/// At rest the gradients of a flat hinge are multiples of its normal.
fn hinge_coefficients(points: [Vec3; 4]) -> Option<[f64; 4]> {
    let [e, a, b] = [1, 2, 3].map(|i: usize| points[i] - points[0]);
    let square = e.norm_squared();
    let slope = |side: &Vec3| {
        let doubled_area = e.cross(side).norm();
        let flat = f64::from(FLAT) * (square + side.norm_squared());
        (doubled_area > flat).then(|| square.sqrt() / doubled_area)
    };
    let (c2, c3) = (slope(&a)?, slope(&b)?);
    let c1 = -(c2 * (a.dot(&e) / square) + c3 * (b.dot(&e) / square));
    Some([-(c1 + c2 + c3), c1, c2, c3])
}

/// The factored matrix of a body.
#[derive(Debug)]
pub(super) struct Factor {
    /// Row of every vertex slot, or [`NO_ROW`].
    pub(super) rows: Vec<u32>,
    pub(super) cholesky: Cholesky,
    /// Time of assembly and factorization.
    pub(super) time: Duration,
}

impl Factor {
    /// Returns the size of factor, its structure, rows and scratch memory \[bytes\].
    pub(super) fn bytes(&self) -> usize {
        self.cholesky.bytes(COORDINATES) + 4 * self.rows.len()
    }
}
