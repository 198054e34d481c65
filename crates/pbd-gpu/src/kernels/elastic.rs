//! The elastic energy of a body: an upper bound of the work that its constraints can do.
//!
//! A constraint with `C`, compliance `c` and `w = sum of |grad C|^2 / m` holds `C^2 / 2c`. One that
//! is stiffer than a substep resolves gives back at most `C^2 / (2 w h^2)` in the next one.
//!
//! The energies are summed in fixed point, relative to the largest one. So the sum does not depend
//! on the order of constraints, which GPUs store by patch.

use super::bending::hinge_error;
use super::volume::THIRD;
use crate::constraints::batches::{BendingSet, ConstraintSet, StretchSet};
use crate::constraints::cells::{CellBlock, CellSet, Row};
use crate::kernels::cells::CellConstants;
use crate::step::constants::{Projection, StepConstants};
use incise_mesh::VertexId;

/// Units of the fixed-point sum in the largest energy: the 2^24 steps of a 32-bit number.
pub(crate) const UNITS: f32 = 16_777_216.0;

/// Largest energy below which a body has none: its number of units in 1 is finite above.
pub(crate) const MIN_ENERGY: f32 = UNITS * f32::MIN_POSITIVE;

/// The constraints that store energy.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ElasticSets<'a> {
    pub(crate) stretch: &'a StretchSet,
    pub(crate) bending: Option<&'a BendingSet>,
    pub(crate) interior_springs: Option<&'a StretchSet>,
}

/// Returns the elastic energy of a body \[J\].
///
/// The fourth component of positions is the inverse mass.
pub(crate) fn elastic_energy(
    positions: &[[f32; 4]],
    sets: ElasticSets<'_>,
    constants: &StepConstants,
) -> f32 {
    let kept = 1.0 - constants.lift;
    let edges = |set: &StretchSet, by: Projection, add: &mut dyn FnMut(f32)| {
        for_each(set, |ends, rest| {
            add(of_edge(positions, ends, rest, by, kept))
        });
    };
    let all = |add: &mut dyn FnMut(f32)| {
        edges(sets.stretch, constants.stretch, add);
        if let Some(springs) = sets.interior_springs {
            edges(springs, constants.interior_springs, add);
        }
        if let Some(bending) = sets.bending {
            for_each(bending, |v, rest| {
                let (turn, weight) = hinge_error(v.map(|v| positions[v.index()]), rest);
                add(energy(turn, weight, constants.bending, kept));
            });
        }
    };
    sum_of(all, constants.h)
}

/// Returns the elastic energy of the cells of a solid \[J\].
pub(crate) fn cell_energy(cells: &CellSet, constants: &StepConstants) -> f32 {
    let all = |add: &mut dyn FnMut(f32)| {
        for (block, lane) in cells.iter() {
            add(of_cell(block, lane, &constants.cells));
        }
    };
    sum_of(all, constants.h)
}

/// Returns the sum of energies \[J\], which `all` lists times `2 h^2`, in substeps of `h` \[s\].
fn sum_of(all: impl Fn(&mut dyn FnMut(f32)), h: f32) -> f32 {
    let mut largest = 0.0;
    all(&mut |energy| largest = if energy > largest { energy } else { largest });
    if largest <= MIN_ENERGY {
        return 0.0;
    }
    let scale = UNITS / largest;
    let mut sum = 0_u64;
    all(&mut |energy| sum += u64::from(units(energy * scale)));
    to_f32(sum) * (largest / UNITS) * (0.5 / (h * h))
}

/// Returns the energy of a cell times `2 h^2`.
fn of_cell(block: &CellBlock, lane: usize, by: &CellConstants) -> f32 {
    let force = |row: &Row| by.square * row[lane];
    let [a, b, c, d, e, f] = block.stress.each_ref().map(force);
    let trace = (a + b) + c;
    let squares = (a * a + b * b + c * c) + 2.0 * (d * d + e * e + f * f);
    let mean = THIRD * (trace * trace);
    let shape = squares - mean;
    let shape = if shape > 0.0 { shape } else { 0.0 };
    let of_strain = shape / by.shape + mean / by.volume;
    let of_mode = |h: usize| {
        let [a, b, c] = [0, 1, 2].map(|k: usize| force(&block.hourglass[3 * h + k]));
        (a * a + b * b + c * c) / block.bending[h][lane]
    };
    let of_bending = (of_mode(0) + of_mode(1)) + (of_mode(2) + of_mode(3));
    (of_strain + of_bending / by.hourglass) / block.fraction[lane]
}

/// Returns a sum of units, rounded as GPUs do, which have its halves.
#[expect(clippy::cast_possible_truncation, reason = "the low half")]
fn to_f32(sum: u64) -> f32 {
    (sum >> 32) as f32 * 4_294_967_296.0 + sum as u32 as f32
}

/// Returns a number from 0 to [`UNITS`] as a whole one.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a small positive number"
)]
fn units(energy: f32) -> u32 {
    energy.ceil() as u32
}

fn for_each<const N: usize>(set: &ConstraintSet<N>, mut of: impl FnMut([VertexId; N], f32)) {
    for batch in set.all() {
        for (&vertices, &rest) in batch.vertices().iter().zip(batch.rest()) {
            of(vertices, rest);
        }
    }
}

/// Returns the energy of an edge times `2 h^2`.
fn of_edge(
    positions: &[[f32; 4]],
    [a, b]: [VertexId; 2],
    rest: f32,
    by: Projection,
    kept: f32,
) -> f32 {
    let (a, b) = (positions[a.index()], positions[b.index()]);
    let [x, y, z] = [0, 1, 2].map(|k: usize| b[k] - a[k]);
    let length = (x * x + y * y + z * z).sqrt();
    energy(length - rest, a[3] + b[3], by, kept)
}

/// Returns the energy of an error of a constraint with the weight `w`, times `2 h^2`.
fn energy(error: f32, weight: f32, by: Projection, kept: f32) -> f32 {
    let alpha = by.alpha * kept;
    let denominator = if alpha > weight { alpha } else { weight };
    if weight > 0.0 {
        by.factor * (error * error / denominator)
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::constraints::rest::angle;
    use crate::material::{Material, Stiffness};
    use crate::solver::Solver;
    use crate::step::params::SolverParams;
    use crate::step::prepare::FrameInputs;
    use crate::step::substeps::Substeps;
    use incise_mesh::icosphere;

    const FRAME: FrameInputs = FrameInputs {
        dt: 1.0 / 60.0,
        substeps: Substeps {
            count: 12,
            h: 1.0 / 720.0,
        },
        has_contacts: false,
        contact_rounds: 1,
        reaches_colliders: false,
    };

    #[test]
    fn cells_hold_the_energy_of_a_sum_in_64_bits() {
        for (young_modulus, stretch) in [(1e4, 1.3), (1e6, 1.01), (1e8, 0.9)] {
            let mut surface = icosphere(2, 0.5);
            let material = Material::solid(young_modulus, 0.4, 1000.0);
            let mut solver = Solver::new(&mut surface, &material).unwrap();
            for p in surface.positions_mut() {
                p[0] *= stretch;
            }
            let params = SolverParams::default();
            solver.step(&mut surface, 1.0 / 60.0, &params).unwrap();
            let constants = solver.prepare(FRAME, &params).unwrap();
            let expected = solver.elastic_energy();
            let body = solver.guarded(&surface);
            let found = f64::from(cell_energy(body.cells.unwrap(), &constants));
            // Rounded up to units of 2^-24 of the largest energy.
            let off = found / expected - 1.0;
            assert!((-1e-6..1e-5).contains(&off), "{found} J, not {expected}");
        }
    }

    #[test]
    fn springs_hold_the_square_of_their_error() {
        let mut surface = icosphere(1, 1.0);
        let material = Material {
            stretch: Stiffness::Compliance(1e-2),
            bending: Some(Stiffness::Compliance(10.0)),
            ..Material::default()
        };
        let mut solver = Solver::new(&mut surface, &material).unwrap();
        solver
            .step(&mut surface, 1.0 / 60.0, &SolverParams::default())
            .unwrap();
        for p in surface.positions_mut() {
            p[0] *= 1.1;
        }
        let constants = solver.prepare(FRAME, &SolverParams::default()).unwrap();
        let body = solver.guarded(&surface);
        let found = elastic_energy(body.positions, body.sets, &constants);
        let mut deformed = surface.clone();
        for (rest, p) in deformed
            .rest_positions_mut()
            .iter_mut()
            .zip(surface.positions())
        {
            *rest = [p[0], p[1], p[2]];
        }
        let mut expected = 0.0;
        for batch in solver.stretch().all() {
            for (&[a, b], &rest) in batch.vertices().iter().zip(batch.rest()) {
                let length = (surface.position(a) - surface.position(b)).norm();
                expected += (length - f64::from(rest)).powi(2) / 2e-2;
            }
        }
        let bending = solver.bending().unwrap();
        for batch in bending.all() {
            for (&v, &rest) in batch.vertices().iter().zip(batch.rest()) {
                let turn = f64::from(angle(&deformed, v) - rest);
                expected += turn * turn / 20.0;
            }
        }
        let off = f64::from(found) / expected - 1.0;
        assert!((0.0..0.02).contains(&off), "{found} J, not {expected}");
    }
}
