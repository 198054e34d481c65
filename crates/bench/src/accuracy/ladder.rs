//! What runs are measured against: converged implicit steps of ever smaller size, and what they tend to.

use super::error::distance;
use super::scene::{Body, DT, Scene};
use incise_bench::{Model, ReferenceError, State, Stepper};
use rayon::prelude::*;
use std::time::Instant;

/// Steps of a frame that total errors are told from: [`Ladder::exact`] has a step 64 times smaller than a frame's and
/// its half, and their double to tell what is left.
const FINE: [u32; 3] = [32, 64, 128];

/// A state for every frame's end.
pub(super) type Trajectory = Vec<State>;

/// Motions of one scene by converged implicit Euler.
pub(super) struct Ladder {
    pub(super) model: Model,
    /// Steps of a frame, ascending, and what came of them.
    rungs: Vec<(u32, Result<Trajectory, ReferenceError>)>,
    /// How long they took together \[s\].
    pub(super) seconds: f64,
}

/// What smaller and smaller steps tend to.
pub(super) struct Exact {
    pub(super) states: Trajectory,
    /// About how far off it is itself, in the measure of [`distance`].
    pub(super) uncertainty: f64,
}

impl Ladder {
    /// Moves a scene's body by steps of every number a frame in `substeps`, and by the fine ones.
    pub(super) fn climb(
        scene: &Scene,
        body: &Body,
        substeps: &[u32],
    ) -> Result<Self, ReferenceError> {
        let begin = Instant::now();
        let model = Model::of(&body.solver, &body.surface, &scene.params(1, 1))?;
        let start = State::of(&body.solver, &body.surface);
        let mut numbers = [substeps, &FINE].concat();
        numbers.sort_unstable();
        numbers.dedup();
        // The long ones first: they are the last to end.
        let rungs = numbers.par_iter().rev().map(|&n| {
            let moved = trajectory(&model, &start, n, scene.frames);
            (n, moved)
        });
        let mut rungs: Vec<_> = rungs.collect();
        rungs.reverse();
        Ok(Self {
            model,
            rungs,
            seconds: begin.elapsed().as_secs_f64(),
        })
    }

    /// The motion by so many steps a frame.
    pub(super) fn rung(&self, substeps: u32) -> Result<&[State], ReferenceError> {
        let at = |n: &(u32, _)| n.0 == substeps;
        match self.rungs.iter().find(|n| at(n)) {
            Some((_, Ok(states))) => Ok(states),
            Some((_, Err(error))) => Err(*error),
            None => Ok(&[]),
        }
    }

    /// What the motion tends to: Richardson's extrapolation of the two finest.
    pub(super) fn exact(&self) -> Result<Exact, ReferenceError> {
        let [coarse, middle, fine] = FINE.map(|n| self.rung(n));
        let (coarse, middle, fine) = (coarse?, middle?, fine?);
        let before = extrapolate(coarse, middle);
        let states = extrapolate(middle, fine);
        // Of second order, as the extrapolation is: its own error is a third of the change.
        let uncertainty = distance(&self.model, &before, &states) / 3.0;
        Ok(Exact {
            states,
            uncertainty,
        })
    }
}

/// Where half the step would lead twice, less where the step leads once.
fn extrapolate(coarse: &[State], fine: &[State]) -> Trajectory {
    let both = coarse.iter().zip(fine);
    both.map(|(coarse, fine)| {
        let x = coarse.x.iter().zip(&fine.x).map(|(c, f)| f * 2.0 - c);
        let v = coarse.v.iter().zip(&fine.v).map(|(c, f)| f * 2.0 - c);
        State {
            x: x.collect(),
            v: v.collect(),
        }
    })
    .collect()
}

/// The converged motion by `n` steps a frame.
fn trajectory(
    model: &Model,
    start: &State,
    n: u32,
    frames: u32,
) -> Result<Trajectory, ReferenceError> {
    // The solver's own substep, rounded as it rounds it.
    let h = f64::from(DT / n as f32);
    let mut stepper = Stepper::new(model)?;
    let mut state = start.clone();
    let mut out = Vec::new();
    for _ in 0..frames {
        for _ in 0..n {
            stepper.step(&mut state, h, &[])?;
        }
        out.push(state.clone());
    }
    Ok(out)
}
