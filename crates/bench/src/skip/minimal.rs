//! The solver as it would be if there were nothing but edges: no angles, no ground, no pins, no blade that asks how far
//! anything moved, and one thread. What the shipped one takes beyond it is the price of what a scene does not have.

use incise_mesh::VertexId;
use incise_pbd_gpu::{
    Backend, Batch, Body, Projection, StepConstants, StepError, StepPlan, StepStats,
};
use pulp::{Arch, NullaryFnOnce};

/// Constraints that are gathered, computed and scattered together, as the shipped kernels do it.
const BLOCK: usize = 32;

/// Steps bodies of edges.
#[derive(Debug, Default)]
pub(super) struct Minimal {
    displacements: Vec<[f32; 4]>,
    /// Multipliers by batch, the overflow last; empty while nothing needs them.
    lambda: Vec<Vec<f32>>,
}

impl Backend for Minimal {
    fn execute(
        &mut self,
        plan: &StepPlan,
        constants: &StepConstants,
        body: &mut Body<'_>,
    ) -> Result<StepStats, StepError> {
        self.displacements.resize(body.positions.len(), [0.0; 4]);
        Arch::new().dispatch(Frame {
            iterations: plan.iterations(),
            constants,
            body,
            d: &mut self.displacements,
            lambda: &mut self.lambda,
        })
    }
}

struct Frame<'a, 'b> {
    iterations: u32,
    constants: &'a StepConstants,
    body: &'a mut Body<'b>,
    d: &'a mut [[f32; 4]],
    lambda: &'a mut Vec<Vec<f32>>,
}

impl NullaryFnOnce for Frame<'_, '_> {
    type Output = Result<StepStats, StepError>;

    #[inline(always)]
    fn call(self) -> Self::Output {
        let (constants, d) = (self.constants, self.d);
        let (x, v) = (&mut *self.body.positions, &mut *self.body.velocities);
        let set = &*self.body.stretch;
        let batches = || set.batches().iter().chain([set.overflow()]);
        self.lambda.resize_with(set.batches().len() + 1, Vec::new);
        for substep in 0..constants.substeps {
            predict(d, v, constants);
            if constants.stretch.keeps {
                for (lambda, batch) in self.lambda.iter_mut().zip(batches()) {
                    lambda.clear();
                    lambda.resize(batch.len(), 0.0);
                }
            }
            for _ in 0..self.iterations {
                let (overflow, lambda) = match self.lambda.split_last_mut() {
                    Some(lists) => lists,
                    None => break,
                };
                for (batch, lambda) in set.batches().iter().zip(lambda) {
                    sweep::<BLOCK>(x, d, batch, lambda, constants.stretch);
                }
                sweep::<1>(x, d, set.overflow(), overflow, constants.stretch);
            }
            if !integrate(x, d, v, constants.h) {
                let vertex = VertexId::NULL;
                return Err(StepError::NonFinitePosition { vertex, substep });
            }
        }
        Ok(StepStats::default())
    }
}

#[inline(always)]
fn predict(d: &mut [[f32; 4]], v: &mut [[f32; 4]], constants: &StepConstants) {
    let [gx, gy, gz] = constants.gravity_step;
    let (h, kept) = (constants.h, constants.kept_velocity);
    for (d, v) in d.iter_mut().zip(v) {
        *v = [
            (v[0] + gx) * kept,
            (v[1] + gy) * kept,
            (v[2] + gz) * kept,
            0.0,
        ];
        *d = v.map(|c| c * h);
    }
}

#[inline(always)]
fn sweep<const B: usize>(
    x: &[[f32; 4]],
    d: &mut [[f32; 4]],
    batch: &Batch<2>,
    lambda: &mut [f32],
    projection: Projection,
) {
    let Projection { factor, alpha, .. } = projection;
    let mut edge = [[0.0_f32; 4]; B];
    let mut inv_mass = [[0.0_f32; B]; 2];
    let mut rest = [0.0_f32; B];
    let mut scale = [0.0_f32; B];
    let mut multiplier = [0.0_f32; B];
    let mut kept = lambda.chunks_mut(B);
    for (vertices, lengths) in batch.vertices().chunks(B).zip(batch.rest().chunks(B)) {
        rest[..lengths.len()].copy_from_slice(lengths);
        let kept = kept.next();
        match &kept {
            Some(kept) => multiplier[..kept.len()].copy_from_slice(kept),
            None => multiplier = [0.0; B],
        }
        for (lane, &[a, b]) in vertices.iter().enumerate().take(B) {
            let (a, b) = (a.index(), b.index());
            let (xa, xb, da, db) = (x[a], x[b], d[a], d[b]);
            edge[lane] = [
                (xb[0] - xa[0]) + (db[0] - da[0]),
                (xb[1] - xa[1]) + (db[1] - da[1]),
                (xb[2] - xa[2]) + (db[2] - da[2]),
                0.0,
            ];
            inv_mass[0][lane] = xa[3];
            inv_mass[1][lane] = xb[3];
        }
        for i in 0..B {
            let [ex, ey, ez, _] = edge[i];
            let length = (ex * ex + ey * ey + ez * ez).sqrt();
            let error = (length - rest[i]) + alpha * multiplier[i];
            let under = length * ((inv_mass[0][i] + inv_mass[1][i]) + alpha);
            scale[i] = if under > 0.0 {
                factor * error / under
            } else {
                0.0
            };
            multiplier[i] -= scale[i] * length;
        }
        for (lane, &[a, b]) in vertices.iter().enumerate().take(B) {
            let towards_b = scale[lane] * inv_mass[0][lane];
            let towards_a = scale[lane] * inv_mass[1][lane];
            for (c, e) in d[a.index()].iter_mut().zip(edge[lane]) {
                *c += towards_b * e;
            }
            for (c, e) in d[b.index()].iter_mut().zip(edge[lane]) {
                *c -= towards_a * e;
            }
        }
        if let Some(kept) = kept {
            kept.copy_from_slice(&multiplier[..kept.len()]);
        }
    }
}

/// Whether all positions are numbers still.
#[inline(always)]
fn integrate(x: &mut [[f32; 4]], d: &[[f32; 4]], v: &mut [[f32; 4]], h: f32) -> bool {
    let mut alarm = 0.0;
    for ((x, v), d) in x.iter_mut().zip(v).zip(d) {
        *v = [d[0] / h, d[1] / h, d[2] / h, 0.0];
        for k in 0..3 {
            x[k] += d[k];
        }
        alarm += (x[0] * 0.0 + x[1] * 0.0) + x[2] * 0.0;
    }
    alarm == 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use incise_mesh::{Model, build_model};
    use incise_pbd_gpu::{Material, Solver, SolverParams, Stiffness};

    #[test]
    fn it_does_what_the_shipped_solver_does() {
        for stretch in [Stiffness::Pbd(0.9), Stiffness::Compliance(1e-5)] {
            let material = Material {
                stretch,
                bending: None,
                damping: 0.1,
                ..Material::default()
            };
            let params = SolverParams {
                iterations: 3,
                substeps: 2,
                ..SolverParams::paper()
            };
            let mut surface = build_model(Model::Bunny);
            let mut solver = Solver::new(&mut surface, &material).unwrap();
            crate::motion::start(&mut solver, &surface).unwrap();
            let (mut other, mut other_solver) = (surface.clone(), solver.clone());
            let mut minimal = Minimal::default();
            for frame in 0..20 {
                solver.step(&mut surface, 0.01, &params).unwrap();
                other_solver
                    .step_on(&mut minimal, &mut other, 0.01, &params)
                    .unwrap();
                assert_eq!(surface.positions, other.positions, "frame {frame}");
                assert_eq!(solver.velocities(), other_solver.velocities());
            }
        }
    }
}
