//! The rows of cells: stiffness, repeated share and viscosity, and their impulses on the modes.

use super::forces::{Forces, load, load_all, symmetric};
use super::modes::{Derivatives, HOURGLASS, Matrix, Vector, to_nodes};
use super::torque::{commutator, spin_against};
use super::{CellConstants, Deformation, Field, RESOLVED};
use crate::constraints::cells::CellBlock;
use crate::kernels::block::Gather;
use crate::kernels::lanes::Lanes;
use pulp::Simd;

/// The rows of cells: their gradients, inverse masses and stiffnesses relative to a full cell.
pub(super) struct Rows<S: Simd> {
    pub(super) derivatives: Derivatives<S>,
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
    pub(super) fn load<G: Gather<L, S = S>, const L: usize>(
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
    pub(super) fn solve(
        &self,
        forces: &mut Forces<S>,
        (strain, modes, r): Deformation<'_, S>,
        constants: &CellConstants,
    ) -> Forces<S> {
        let one = Lanes::splat(self.fraction.simd(), 1.0);
        let unit = Lanes::splat(self.fraction.simd(), constants.unit);
        let shape = constants.shape * self.fraction;
        let volume = constants.volume * self.fraction;
        let bending = constants.hourglass * self.fraction;
        let rest = one - self.kept;
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
        let coupled = self.stress_impulses(&symmetric(&applied.stress), r);
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
            let mode = in_frame(mode, r);
            for (k, mode) in mode.into_iter().enumerate() {
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
    pub(super) fn repeated(&self, forces: &Forces<S>, r: &Matrix<S>) -> Field<S> {
        let mut repeated = *forces;
        repeated.scale(self.kept);
        let modes = self.impulses(&repeated, r);
        [to_nodes(modes[0]), to_nodes(modes[1]), to_nodes(modes[2])]
    }

    /// Returns the impulses of forces on the modes, along the axes of space.
    #[inline(always)]
    fn impulses(&self, forces: &Forces<S>, r: &Matrix<S>) -> Field<S> {
        let mut modes = self.stress_impulses(&symmetric(&forces.stress), r);
        add_hourglass(&mut modes, &forces.hourglass, r);
        modes
    }

    /// Returns the impulses of forces on the modes, along the axes of space, without torque.
    ///
    /// A force along a strain, such as a viscous one, need not be parallel to it. Then the rotation
    /// that belongs to the strain turns with the nodes, and the forces are those of
    /// [`Self::impulses`] and a skew part of the stress, which cancels their torque.
    #[inline(always)]
    pub(super) fn free_of_torque(
        &self,
        forces: &Forces<S>,
        (strain, modes, r): Deformation<'_, S>,
    ) -> Field<S> {
        let mut torque = commutator(strain, &forces.stress);
        for (h, m) in HOURGLASS.into_iter().enumerate() {
            let mode = in_frame([modes[0][m], modes[1][m], modes[2][m]], r);
            let force = forces.hourglass[h];
            for (k, sum) in torque.iter_mut().enumerate() {
                let (i, j) = ((k + 1) % 3, (k + 2) % 3);
                *sum = *sum + 0.125 * (mode[i] * force[j] - mode[j] * force[i]);
            }
        }
        let spin = spin_against(torque, strain);
        let mut stress = symmetric(&forces.stress);
        for (k, spin) in spin.into_iter().enumerate() {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            stress[j][i] = stress[j][i] + spin;
            stress[i][j] = stress[i][j] - spin;
        }
        let mut impulses = self.stress_impulses(&stress, r);
        add_hourglass(&mut impulses, &forces.hourglass, r);
        impulses
    }

    /// Returns the impulses of stresses on the modes, along the axes of space.
    #[inline(always)]
    fn stress_impulses(&self, stress: &Matrix<S>, r: &Matrix<S>) -> Field<S> {
        let [x, y, z] = stress;
        let mut modes = [[x[0].zero(); 8]; 3];
        for (k, a) in r.iter().enumerate() {
            modes[k] = self.derivatives.transposed([
                (a[0] * x[0] + a[1] * y[0]) + a[2] * z[0],
                (a[0] * x[1] + a[1] * y[1]) + a[2] * z[1],
                (a[0] * x[2] + a[1] * y[2]) + a[2] * z[2],
            ]);
        }
        modes
    }
}

/// Adds the impulses of the forces of hourglass modes to those on all modes.
#[inline(always)]
fn add_hourglass<S: Simd>(modes: &mut Field<S>, forces: &[Vector<S>; 4], r: &Matrix<S>) {
    for (h, m) in HOURGLASS.into_iter().enumerate() {
        let [a, b, c] = forces[h];
        for k in 0..3 {
            let force = (r[k][0] * a + r[k][1] * b) + r[k][2] * c;
            modes[k][m] = modes[k][m] + 0.125 * force;
        }
    }
}

/// Returns a vector in the frame of a cell.
#[inline(always)]
fn in_frame<S: Simd>(v: Vector<S>, r: &Matrix<S>) -> Vector<S> {
    [
        (r[0][0] * v[0] + r[1][0] * v[1]) + r[2][0] * v[2],
        (r[0][1] * v[0] + r[1][1] * v[1]) + r[2][1] * v[2],
        (r[0][2] * v[0] + r[1][2] * v[1]) + r[2][2] * v[2],
    ]
}

/// Returns the symmetric part of `R^T F` by xx, yy, zz, xy, yz and zx.
#[inline(always)]
pub(super) fn strain<S: Simd>(f: &Matrix<S>, r: &Matrix<S>) -> [Lanes<S>; 6] {
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
