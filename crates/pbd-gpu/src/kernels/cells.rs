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
//! force `-k t dC/dt` of implicit Euler. It need not be parallel to the strain, whose frame turns
//! with the nodes; a skew stress cancels its torque.

mod forces;
mod modes;
pub(crate) mod rotation;
mod rows;
mod torque;

use super::block::{Gather, Transpose};
use super::lanes::Lanes;
use super::particle_state::ParticleStates;
use crate::constraints::cells::{CellBlock, NodeId};
use forces::{Forces, load_all, store_all};
use modes::{Matrix, to_modes, to_nodes};
use pulp::Scalar;
use rotation::{matrix, nearest_rotation};
use rows::{Rows, strain};
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
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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

    /// Returns whether all numbers are finite and none is negative.
    #[cfg(feature = "serde")]
    pub(crate) fn is_valid(&self) -> bool {
        let Self {
            scale,
            unit,
            shape,
            volume,
            hourglass,
            square,
            viscosity,
        } = *self;
        let all = [scale, unit, shape, volume, hourglass, square, viscosity];
        all.iter().all(|c| c.is_finite() && *c >= 0.0)
    }
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

/// Symmetric stretches `R^T F` by xx, yy, zz, xy, yz and zx, modes of the positions, and rotations.
type Deformation<'a, S> = (&'a [Lanes<S>; 6], &'a Field<S>, &'a Matrix<S>);

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
    let strain = strain(&f, &r);
    let applied = rows.solve(&mut forces, (&strain, &modes, &r), constants);
    let applied = rows.free_of_torque(&applied, (&strain, &modes, &r));
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
