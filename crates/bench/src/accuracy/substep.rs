//! What a solver's iterations leave of a single substep; metrics e2 to e4.

use super::ladder::Ladder;
use super::scene::{Body, DT};
use incise_bench::{Residuals, State, Stepper};
use incise_mesh::VertexId;
use incise_pbd_gpu::SolverParams;
use nalgebra::Vector3;

/// The residuals of one substep from a state in the middle of the converged motion, by ways that differ in iterations;
/// none where that motion is not known. `params` are those of frames of so many substeps.
pub(super) fn residuals(
    body: &Body,
    ladder: &Ladder,
    params: &[SolverParams],
) -> Option<Vec<Residuals>> {
    let substeps = params.first()?.substeps;
    let motion = ladder.euler(substeps)?;
    let mut body = body.clone();
    body.put(motion.get(motion.len() / 2)?)?;
    let start = State::of(&body.solver, &body.surface);
    let h = DT / substeps as f32;
    let ends: Option<Vec<Vec<Vector3<f64>>>> = params
        .iter()
        .map(|params| {
            let mut body = body.clone();
            let params = SolverParams {
                substeps: 1,
                ..*params
            };
            body.solver.step(&mut body.surface, h, &params).ok()?;
            Some(State::of(&body.solver, &body.surface).x)
        })
        .collect();
    let mut stepper = Stepper::new(&ladder.model).ok()?;
    stepper.residuals(&start, h.into(), &ends?).ok()
}

impl Body {
    /// Puts the body into a state, rounded; none where the solver refuses it.
    fn put(&mut self, state: &State) -> Option<()> {
        for (v, (x, velocity)) in state.x.iter().zip(&state.v).enumerate() {
            let [x, y, z] = incise_mesh::geometry::round(*x);
            let weight = self.surface.positions[v][3];
            self.surface.positions[v] = [x, y, z, weight];
            if weight > 0.0 {
                let velocity = incise_mesh::geometry::round(*velocity);
                (self.solver.set_velocity(VertexId::from_index(v), velocity)).ok()?;
            }
        }
        Some(())
    }
}
