//! What a solver's iterations leave of a single substep; metrics e2 to e4.

use super::dual::dual;
use super::ladder::Ladder;
use super::scene::{Body, DT};
use incise_bench::{Residuals, State, Stepper};
use incise_mesh::VertexId;
use incise_pbd_gpu::{SolverParams, StepError, Stiffness};
use serde::Serialize;

/// What is left of a substep, each number over that of its prediction.
#[derive(Debug, Clone, Copy, Default, Serialize)]
pub(super) struct Left {
    #[serde(flatten)]
    pub(super) residuals: Residuals,
    /// As [`dual`] has it; none of stiffnesses of 0 to 1, which know no multipliers.
    pub(super) dual: Option<f64>,
}

/// What is left of one substep from a state in the middle of the converged motion, by ways that differ in iterations;
/// none where that motion is not known. `params` are those of frames of so many substeps.
pub(super) fn left(body: &Body, ladder: &Ladder, params: &[SolverParams]) -> Option<Vec<Left>> {
    let substeps = params.first()?.substeps;
    let motion = ladder.euler(substeps)?;
    let mut body = body.clone();
    body.put(motion.get(motion.len() / 2)?)?;
    let start = State::of(&body.solver, &body.surface);
    let h = DT / substeps as f32;
    let (mut ends, mut duals) = (Vec::new(), Vec::new());
    for params in params {
        let mut body = body.clone();
        body.step_once(h, params).ok()?;
        let end = State::of(&body.solver, &body.surface).x;
        let multipliers = body.multipliers(&ladder.model);
        duals.push(multipliers.and_then(|m| dual(&ladder.model, &start, h.into(), &end, &m)));
        ends.push(end);
    }
    let mut stepper = Stepper::new(&ladder.model).ok()?;
    let residuals = stepper.residuals(&start, h.into(), &ends).ok()?;
    let both = residuals.into_iter().zip(duals);
    Some(
        both.map(|(residuals, dual)| Left { residuals, dual })
            .collect(),
    )
}

impl Body {
    /// Makes one substep of `h` \[s\], and has its multipliers kept.
    pub(super) fn step_once(&mut self, h: f32, params: &SolverParams) -> Result<(), StepError> {
        let mut params = SolverParams {
            substeps: 1,
            ..*params
        };
        let material = self.solver.material();
        let gives_way = |stiffness| matches!(stiffness, Stiffness::Compliance(_));
        if params.iterations == 1
            && gives_way(material.stretch)
            && material.bending.is_none_or(gives_way)
        {
            // A single iteration needs no multipliers and keeps none; the first of two does, and the second is left
            // out with a residual that any motion is below.
            (params.iterations, params.residual) = (2, Some(f32::MAX));
        }
        self.solver.step(&mut self.surface, h, &params)?;
        Ok(())
    }

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
