//! What runs are measured against: converged implicit steps of ever smaller size, and what they tend to.

use super::error::distance;
use super::scene::{Body, DT, Scene, Scheme};
use incise_bench::{Model, ReferenceError, State, Stepper};
use nalgebra::Vector3;
use rayon::prelude::*;
use std::time::Instant;

/// A state for every frame's end.
pub(super) type Trajectory = Vec<State>;

/// What one number of steps a frame led to.
type Rung = (u32, Result<Trajectory, ReferenceError>);

/// Motions of one scene by converged steps.
pub(super) struct Ladder {
    pub(super) model: Model,
    /// By implicit Euler, as the solver steps.
    euler: Vec<Rung>,
    /// By the second backward difference formula.
    fine: Vec<Rung>,
    /// Their steps a frame.
    steps: [u32; 3],
    /// How long they took together \[s\].
    pub(super) seconds: f64,
}

/// What smaller and smaller steps tend to.
pub(super) struct Exact {
    pub(super) states: Trajectory,
    /// About how far off it is itself, in the measure of [`distance`].
    pub(super) uncertainty: f64,
}

/// How steps are made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Formula {
    ImplicitEuler,
    Bdf2,
}

impl Ladder {
    /// Moves a scene's body by implicit steps of every number a frame in `substeps`, and by fine ones.
    pub(super) fn climb(
        scene: &Scene,
        body: &Body,
        substeps: &[u32],
    ) -> Result<Self, ReferenceError> {
        let begin = Instant::now();
        let model = Model::of(&body.solver, &body.surface, &scene.params(1, 1))?;
        let start = State::of(&body.solver, &body.surface);
        let fine = scene.fine.map(|n| (Formula::Bdf2, n));
        let near = substeps.iter().filter(|&&n| n <= scene.most_rungs);
        let euler = near.map(|&n| (Formula::ImplicitEuler, n));
        let mut tasks: Vec<(Formula, u32)> = fine.into_iter().chain(euler).collect();
        // The long ones first: they are the last to end.
        tasks.sort_by_key(|task| std::cmp::Reverse(task.1));
        let done = tasks.into_par_iter().map(|(formula, n)| {
            let moved = trajectory(&model, &start, formula, n, scene.frames);
            (formula, (n, moved))
        });
        let done: Vec<(Formula, Rung)> = done.collect();
        let (fine, euler): (Vec<_>, Vec<_>) =
            done.into_iter().partition(|task| task.0 == Formula::Bdf2);
        let rungs = |tasks: Vec<(Formula, Rung)>| tasks.into_iter().map(|task| task.1).collect();
        Ok(Self {
            euler: rungs(euler),
            fine: rungs(fine),
            steps: scene.fine,
            model,
            seconds: begin.elapsed().as_secs_f64(),
        })
    }

    /// The motion by so many converged steps a frame, of the order that a scheme has; none where it was not made.
    pub(super) fn known(&self, scheme: Scheme, substeps: u32) -> Option<&[State]> {
        let rungs = match scheme {
            Scheme::Second => &self.fine,
            _ => &self.euler,
        };
        let states = rung(rungs, substeps).ok()?;
        (!states.is_empty()).then_some(states)
    }

    /// The motion by so many steps of implicit Euler a frame; none where it was not made.
    pub(super) fn euler(&self, substeps: u32) -> Option<&[State]> {
        self.known(Scheme::Xpbd, substeps)
    }

    /// What the motion tends to: Richardson's extrapolation of the two finest.
    pub(super) fn exact(&self) -> Result<Exact, ReferenceError> {
        let [coarse, middle, fine] = self.steps.map(|n| rung(&self.fine, n));
        let (coarse, middle, fine) = (coarse?, middle?, fine?);
        let before = extrapolate(coarse, middle);
        let states = extrapolate(middle, fine);
        // Of third order at least: its own error is a seventh of the change.
        let uncertainty = distance(&self.model, &before, &states) / 7.0;
        Ok(Exact {
            states,
            uncertainty,
        })
    }
}

fn rung(rungs: &[Rung], substeps: u32) -> Result<&[State], ReferenceError> {
    match rungs.iter().find(|rung| rung.0 == substeps) {
        Some((_, Ok(states))) => Ok(states),
        Some((_, Err(error))) => Err(*error),
        None => Ok(&[]),
    }
}

/// What the error of second order is taken from: four thirds of where half the step leads, less a third of where the
/// step leads.
fn extrapolate(coarse: &[State], fine: &[State]) -> Trajectory {
    let both = coarse.iter().zip(fine);
    both.map(|(coarse, fine)| combine(fine, coarse, 4.0 / 3.0))
        .collect()
}

/// `part` of one state and the rest of 1 of another.
fn combine(one: &State, other: &State, part: f64) -> State {
    let mix = |a: &[Vector3<f64>], b: &[Vector3<f64>]| {
        let both = a.iter().zip(b);
        both.map(|(a, b)| a * part + b * (1.0 - part)).collect()
    };
    State {
        x: mix(&one.x, &other.x),
        v: mix(&one.v, &other.v),
    }
}

/// The converged motion by `n` steps a frame.
fn trajectory(
    model: &Model,
    start: &State,
    formula: Formula,
    n: u32,
    frames: u32,
) -> Result<Trajectory, ReferenceError> {
    // The solver's own substep, rounded as it rounds it.
    let h = f64::from(DT / n as f32);
    let mut stepper = Stepper::new(model)?;
    let mut state = start.clone();
    let mut before: Option<State> = None;
    let mut out = Vec::new();
    for _ in 0..frames {
        for _ in 0..n {
            let now = state.clone();
            if let Some(before) = before.filter(|_| formula == Formula::Bdf2) {
                // (3 x' - 4 x + x0) / 2h = v' and the same of v: an implicit Euler step of 2h/3 from (4 x - x0) / 3.
                state = combine(&state, &before, 4.0 / 3.0);
                stepper.step(&mut state, h * 2.0 / 3.0, &[])?;
            } else {
                stepper.step(&mut state, h, &[])?;
            }
            before = Some(now);
        }
        out.push(state.clone());
    }
    Ok(out)
}
