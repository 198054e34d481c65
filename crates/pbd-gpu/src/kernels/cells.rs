//! Elasticity of the cells of a solid: isotropic stress and bending (corotated, XPBD).
//!
//! A cell has six rows for its strain and twelve for its hourglass modes, in the frame of the
//! nearest rotation `R` of `F`, its gradient at the centroid of the part in the cell. The strain is
//! `R^T F - 1`, which is symmetric, and its compliance the inverse of Hooke's law by the volume of
//! the part. All rows share a bound of the largest eigenvalue of `sum w g g^T` as their inverse
//! mass. So the block is isotropic and exerts no torque; for a full cell of equal masses it is
//! exact. Hourglass modes follow, with the strain solved.
//!
//! **Repeated forces.** The prediction of a substep repeats the forces of the last one, see
//! [`super::predict`], up to [`RESOLVED`]. Rows solve for their change. So one projection of each
//! cell is in equilibrium at rest, and a spinning body keeps its angular momentum: a force at the
//! positions where it was found exerts no torque.
//!
//! **Viscosity.** A row of stiffness `k`, force `f` and inverse mass `w`, of which the share `s` is
//! repeated, changes its force by `-(k C + f + k w (1 - s) f) / (1 + (1 + t / h) k w)`. The nodes
//! get this change times `1 + t / h`, and what was not repeated: the elastic force and the viscous
//! force `-k t dC/dt` of implicit Euler.

mod modes;
mod rotation;

use super::block::{Gather, Transpose};
use super::lanes::Lanes;
use super::particle_state::ParticleStates;
use crate::constraints::cells::{CellBlock, NodeId, Row};
use modes::{Derivatives, HOURGLASS, Matrix, Vector, to_modes, to_nodes};
use pulp::{Scalar, Simd};
use rotation::{matrix, nearest_rotation};
use std::cell::Cell;

/// Largest ratio `(h omega)^2 = k w` of a cell whose forces the prediction repeats.
///
/// Where all cells deform alike, neighbors undo half of the change that a cell makes, and its force
/// follows its strain after `(1 + t / h) k w / 2` substeps. The viscosity is that of `1 + t / h`
/// substeps, one of them numerical. So such a motion decays for `k w < 2`, and would grow beyond. A
/// stiffer cell repeats the share of its forces that gives this ratio, and has that share of the
/// viscosity.
pub(crate) const RESOLVED: f32 = 2.0;

/// Coefficients of the cells of a body in a substep of `h` \[s\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct CellConstants {
    /// One by four cell sizes [1/m].
    pub(crate) scale: f32,
    /// The gradient of a cell at rest along an axis: 1, with the rounding of the scale.
    pub(crate) unit: f32,
    /// Stiffness of a full cell against a change of shape, `2 mu V h^2` [J s²].
    pub(crate) shape: f32,
    /// Stiffness of a full cell against a change of volume, `(2 mu + 3 lambda) V h^2` [J s²].
    pub(crate) volume: f32,
    /// Stiffness of the hourglass modes of a full cell, times `h^2` \[kg\].
    pub(crate) hourglass: f32,
    /// `h^2` \[s²\].
    pub(crate) square: f32,
    /// Relaxation time by `h`.
    pub(crate) viscosity: f32,
}

impl CellConstants {
    /// The coefficients of a body without cells.
    pub(crate) const NONE: Self = Self {
        scale: 0.0,
        unit: 1.0,
        shape: 0.0,
        volume: 0.0,
        hourglass: 0.0,
        square: 1.0,
        viscosity: 0.0,
    };
}

/// Cells of a block that share no node, one per lane.
#[derive(Debug)]
pub(crate) struct Lane<'a> {
    pub(crate) block: &'a mut CellBlock,
    /// The first cell of the lanes.
    pub(crate) first: usize,
    /// Number of cells, at most that of the lanes.
    pub(crate) count: usize,
}

/// A vector at each node or of each mode, by axis.
type Field<S> = [[Lanes<S>; 8]; 3];

/// Deformation gradients, modes of the positions, and rotations.
type Deformation<'a, S> = (&'a Matrix<S>, &'a Field<S>, &'a Matrix<S>);

/// Forces of the rows of cells in their frames: stress times volume by xx, yy, zz, xy, yz and zx,
/// and those of the hourglass modes.
#[derive(Clone, Copy)]
struct Forces<S: Simd> {
    stress: [Lanes<S>; 6],
    hourglass: [Vector<S>; 4],
}

/// Projects cells, and adds their forces to those of nodes \[N\], shape [particles], which the next
/// prediction repeats.
#[inline(always)]
pub(crate) fn project<G: Gather<L>, const L: usize>(
    gather: G,
    particles: ParticleStates<'_>,
    node_forces: &[Cell<[f32; 4]>],
    cells: Lane<'_>,
    constants: &CellConstants,
) {
    let Lane {
        block,
        first,
        count,
    } = cells;
    let nodes = nodes::<L>(block, first, count);
    let (x, w) = positions(gather, particles, &nodes);
    let rows = Rows::load(gather, block, first, constants);
    let modes = [to_modes(x[0]), to_modes(x[1]), to_modes(x[2])];
    let f = [
        rows.derivatives.gradient(&modes[0]),
        rows.derivatives.gradient(&modes[1]),
        rows.derivatives.gradient(&modes[2]),
    ];
    let (q, r) = nearest_rotation(gather, f, load_all(gather, &block.rotation, first));
    let mut forces = Forces::load(gather, block, first);
    let square = Lanes::splat(gather.simd(), constants.square);
    let per_square = Lanes::splat(gather.simd(), 1.0 / constants.square);
    forces.scale(square);
    let applied = rows.solve(&mut forces, (&f, &modes, &r), constants);
    let applied = rows.impulses(&applied, &r);
    let applied = [
        to_nodes(applied[0]),
        to_nodes(applied[1]),
        to_nodes(applied[2]),
    ];
    forces.scale(per_square);
    let repeated = rows.repeated(&forces, &r);
    for i in 0..8 {
        let applied = gather.to_rows([
            w[i] * applied[0][i],
            w[i] * applied[1][i],
            w[i] * applied[2][i],
        ]);
        let repeated = gather.to_rows([repeated[0][i], repeated[1][i], repeated[2][i]]);
        for lane in 0..count {
            let node = nodes[lane][i];
            gather.add_d(particles, node, applied[lane]);
            gather.add_row(&node_forces[node.index()], repeated[lane]);
        }
    }
    store_all::<G::S, L, 4>(&mut block.rotation, first, count, q);
    forces.store::<L>(block, first, count);
}

/// Adds the forces of one cell that a prediction repeats to those of the nodes that `is_changed`
/// holds for \[N\].
pub(crate) fn add_forces(
    node_forces: &mut [[f32; 4]],
    block: &CellBlock,
    lane: usize,
    constants: &CellConstants,
    is_changed: impl Fn(NodeId) -> bool,
) {
    let gather = Transpose(Scalar);
    let rows = Rows::load::<_, 1>(gather, block, lane, constants);
    let forces = Forces::load::<_, 1>(gather, block, lane);
    let r = matrix(load_all::<_, 1, 4>(gather, &block.rotation, lane));
    let repeated = rows.repeated(&forces, &r);
    for (k, at_nodes) in repeated.into_iter().enumerate() {
        for (&node, force) in block.nodes[lane].iter().zip(at_nodes) {
            if is_changed(node) {
                let [force] = force.to_array::<1>();
                node_forces[node.index()][k] += force;
            }
        }
    }
}

/// The rows of cells: their gradients, inverse masses and stiffnesses relative to a full cell.
struct Rows<S: Simd> {
    derivatives: Derivatives<S>,
    fraction: Lanes<S>,
    bending: [Lanes<S>; 4],
    strain_weight: Lanes<S>,
    mode_weights: [Lanes<S>; 8],
    /// Share of the forces that the next prediction repeats.
    kept: Lanes<S>,
    /// Factor of changes of forces, by viscosity.
    viscous: Lanes<S>,
}

impl<S: Simd> Rows<S> {
    #[inline(always)]
    fn load<G: Gather<L, S = S>, const L: usize>(
        gather: G,
        block: &CellBlock,
        first: usize,
        constants: &CellConstants,
    ) -> Self {
        let center = load_all(gather, &block.center, first);
        let fraction = load(gather, &block.fraction, first);
        let strain_weight = load(gather, &block.strain_weight, first);
        let ratio = (constants.volume * fraction) * strain_weight;
        let one = Lanes::splat(ratio.simd(), 1.0);
        let resolved = Lanes::splat(ratio.simd(), RESOLVED);
        let kept = ratio.gt(resolved).select(resolved / ratio, one);
        Self {
            derivatives: Derivatives::new(center, constants.scale),
            fraction,
            bending: load_all(gather, &block.bending, first),
            strain_weight,
            mode_weights: load_all(gather, &block.mode_weights, first),
            kept,
            viscous: one + constants.viscosity * kept,
        }
    }

    /// Solves the rows for the elastic forces, of which a share acts already, and returns the
    /// impulses that are to be applied.
    #[inline(always)]
    fn solve(
        &self,
        forces: &mut Forces<S>,
        (f, modes, r): Deformation<'_, S>,
        constants: &CellConstants,
    ) -> Forces<S> {
        let one = Lanes::splat(self.fraction.simd(), 1.0);
        let unit = Lanes::splat(self.fraction.simd(), constants.unit);
        let shape = constants.shape * self.fraction;
        let volume = constants.volume * self.fraction;
        let bending = constants.hourglass * self.fraction;
        let rest = one - self.kept;
        let strain = strain(f, r);
        let [xx, yy, zz] = [strain[0] - unit, strain[1] - unit, strain[2] - unit];
        let stress = forces.stress;
        let third = 1.0 / 3.0;
        let trace = third * ((xx + yy) + zz);
        let pressure = third * ((stress[0] + stress[1]) + stress[2]);
        let weight = self.strain_weight;
        let viscous = self.viscous * weight;
        let (by_volume, by_shape) = (
            one + rest * (volume * weight),
            one + rest * (shape * weight),
        );
        let mean = (volume * trace + by_volume * pressure) / (one + volume * viscous);
        let divisor = one + shape * viscous;
        let mut applied = *forces;
        for (k, strain) in [xx, yy, zz].into_iter().enumerate() {
            let off = shape * (strain - trace) + by_shape * (stress[k] - pressure);
            let change = -(off / divisor + mean);
            applied.stress[k] = rest * stress[k] + self.viscous * change;
            forces.stress[k] = stress[k] + change;
        }
        for k in 3..6 {
            let change = -((shape * strain[k] + by_shape * stress[k]) / divisor);
            applied.stress[k] = rest * stress[k] + self.viscous * change;
            forces.stress[k] = stress[k] + change;
        }
        let coupled = self.stress_impulses(&applied.stress, r);
        let weights = &self.mode_weights;
        for (h, m) in HOURGLASS.into_iter().enumerate() {
            let stiffness = bending * self.bending[h];
            let mut bound = weights[0];
            for n in HOURGLASS {
                if n != m {
                    bound = bound + weights[m ^ n].abs();
                }
            }
            let weight = 0.125 * (stiffness * bound);
            let (by_weight, divisor) = (one + rest * weight, one + self.viscous * weight);
            let mut mode = [modes[0][m], modes[1][m], modes[2][m]];
            for k in 0..3 {
                let mut moved = weights[m ^ 1] * coupled[k][1];
                for n in 2..8 {
                    moved = moved + weights[m ^ n] * coupled[k][n];
                }
                mode[k] = 0.125 * mode[k] + moved;
            }
            let in_frame = [
                (r[0][0] * mode[0] + r[1][0] * mode[1]) + r[2][0] * mode[2],
                (r[0][1] * mode[0] + r[1][1] * mode[1]) + r[2][1] * mode[2],
                (r[0][2] * mode[0] + r[1][2] * mode[1]) + r[2][2] * mode[2],
            ];
            for (k, mode) in in_frame.into_iter().enumerate() {
                let force = forces.hourglass[h][k];
                let change = -((stiffness * mode + by_weight * force) / divisor);
                applied.hourglass[h][k] = rest * force + self.viscous * change;
                forces.hourglass[h][k] = force + change;
            }
        }
        applied
    }

    /// Returns the forces at the nodes that the next prediction repeats, by axis.
    #[inline(always)]
    fn repeated(&self, forces: &Forces<S>, r: &Matrix<S>) -> Field<S> {
        let mut repeated = *forces;
        repeated.scale(self.kept);
        let modes = self.impulses(&repeated, r);
        [to_nodes(modes[0]), to_nodes(modes[1]), to_nodes(modes[2])]
    }

    /// Returns the impulses of forces on the modes, along the axes of space.
    #[inline(always)]
    fn impulses(&self, forces: &Forces<S>, r: &Matrix<S>) -> Field<S> {
        let mut modes = self.stress_impulses(&forces.stress, r);
        for (h, m) in HOURGLASS.into_iter().enumerate() {
            let [a, b, c] = forces.hourglass[h];
            for k in 0..3 {
                let force = (r[k][0] * a + r[k][1] * b) + r[k][2] * c;
                modes[k][m] = modes[k][m] + 0.125 * force;
            }
        }
        modes
    }

    /// Returns the impulses of stresses on the modes, along the axes of space.
    #[inline(always)]
    fn stress_impulses(&self, stress: &[Lanes<S>; 6], r: &Matrix<S>) -> Field<S> {
        let &[xx, yy, zz, xy, yz, zx] = stress;
        let [a, b, c] = r;
        [
            self.derivatives.transposed([
                (a[0] * xx + a[1] * xy) + a[2] * zx,
                (a[0] * xy + a[1] * yy) + a[2] * yz,
                (a[0] * zx + a[1] * yz) + a[2] * zz,
            ]),
            self.derivatives.transposed([
                (b[0] * xx + b[1] * xy) + b[2] * zx,
                (b[0] * xy + b[1] * yy) + b[2] * yz,
                (b[0] * zx + b[1] * yz) + b[2] * zz,
            ]),
            self.derivatives.transposed([
                (c[0] * xx + c[1] * xy) + c[2] * zx,
                (c[0] * xy + c[1] * yy) + c[2] * yz,
                (c[0] * zx + c[1] * yz) + c[2] * zz,
            ]),
        ]
    }
}

/// Returns the symmetric part of `R^T F` by xx, yy, zz, xy, yz and zx.
#[inline(always)]
fn strain<S: Simd>(f: &Matrix<S>, r: &Matrix<S>) -> [Lanes<S>; 6] {
    [
        entry(f, r, 0, 0),
        entry(f, r, 1, 1),
        entry(f, r, 2, 2),
        0.5 * (entry(f, r, 0, 1) + entry(f, r, 1, 0)),
        0.5 * (entry(f, r, 1, 2) + entry(f, r, 2, 1)),
        0.5 * (entry(f, r, 2, 0) + entry(f, r, 0, 2)),
    ]
}

/// Returns an entry of `R^T F`.
#[inline(always)]
fn entry<S: Simd>(f: &Matrix<S>, r: &Matrix<S>, i: usize, j: usize) -> Lanes<S> {
    (r[0][i] * f[0][j] + r[1][i] * f[1][j]) + r[2][i] * f[2][j]
}

impl<S: Simd> Forces<S> {
    #[inline(always)]
    fn load<G: Gather<L, S = S>, const L: usize>(
        gather: G,
        block: &CellBlock,
        first: usize,
    ) -> Self {
        let h: [Lanes<S>; 12] = load_all(gather, &block.hourglass, first);
        Self {
            stress: load_all(gather, &block.stress, first),
            hourglass: [
                [h[0], h[1], h[2]],
                [h[3], h[4], h[5]],
                [h[6], h[7], h[8]],
                [h[9], h[10], h[11]],
            ],
        }
    }

    #[inline(always)]
    fn store<const L: usize>(&self, block: &mut CellBlock, first: usize, count: usize) {
        store_all::<S, L, 6>(&mut block.stress, first, count, self.stress);
        for h in 0..4 {
            for k in 0..3 {
                let force = self.hourglass[h][k];
                store::<S, L>(&mut block.hourglass[3 * h + k], first, count, force);
            }
        }
    }

    #[inline(always)]
    fn scale(&mut self, by: Lanes<S>) {
        for force in &mut self.stress {
            *force = by * *force;
        }
        for force in self.hourglass.as_flattened_mut() {
            *force = by * *force;
        }
    }
}

/// Returns the positions of the nodes from the first one \[m\], by axis, and their inverse masses.
#[inline(always)]
fn positions<G: Gather<L>, const L: usize>(
    gather: G,
    particles: ParticleStates<'_>,
    nodes: &[[NodeId; 8]; L],
) -> (Field<G::S>, [Lanes<G::S>; 8]) {
    let zero = Lanes::splat(gather.simd(), 0.0);
    let mut x = [[zero; 8]; 3];
    let mut w = [gather.inverse_masses(particles, nodes); 8];
    for i in 1..8 {
        let row = gather.differences(particles, nodes, i);
        for k in 0..3 {
            x[k][i] = row[k];
        }
        w[i] = row[3];
    }
    (x, w)
}

/// Returns the nodes of the cells in the lanes; the last cell is repeated.
#[inline(always)]
fn nodes<const L: usize>(block: &CellBlock, first: usize, count: usize) -> [[NodeId; 8]; L] {
    let mut nodes = [block.nodes[first + count - 1]; L];
    nodes[..count].copy_from_slice(&block.nodes[first..first + count]);
    nodes
}

/// Returns a number of the cells in the lanes.
#[inline(always)]
fn load<G: Gather<L>, const L: usize>(gather: G, row: &Row, first: usize) -> Lanes<G::S> {
    let mut numbers = [0.0; L];
    numbers.copy_from_slice(&row[first..first + L]);
    Lanes::from_array(gather.simd(), numbers)
}

/// Returns several numbers of the cells in the lanes.
#[inline(always)]
fn load_all<G: Gather<L>, const L: usize, const N: usize>(
    gather: G,
    rows: &[Row; N],
    first: usize,
) -> [Lanes<G::S>; N] {
    let mut lanes = [Lanes::splat(gather.simd(), 0.0); N];
    for i in 0..N {
        lanes[i] = load(gather, &rows[i], first);
    }
    lanes
}

/// Stores a number of the first `count` cells in the lanes.
#[inline(always)]
fn store<S: Simd, const L: usize>(row: &mut Row, first: usize, count: usize, lanes: Lanes<S>) {
    let lanes: [f32; L] = lanes.to_array();
    row[first..first + count].copy_from_slice(&lanes[..count]);
}

/// Stores several numbers of the first `count` cells in the lanes.
#[inline(always)]
fn store_all<S: Simd, const L: usize, const N: usize>(
    rows: &mut [Row; N],
    first: usize,
    count: usize,
    lanes: [Lanes<S>; N],
) {
    for i in 0..N {
        store::<S, L>(&mut rows[i], first, count, lanes[i]);
    }
}
