//! Reference motions: converged implicit steps of decreasing size and their extrapolation.

use super::error::distance;
use super::scene::{Body, DT, Scene, Scheme};
use incise_reference::{Model, ReferenceError, State, Stepper};
use nalgebra::Vector3;
use rayon::prelude::*;
use std::time::Instant;

/// Numbers of substeps whose converged second-order steps give floors of errors.
pub(super) const FLOOR_SUBSTEPS: [u32; 4] = [1, 2, 4, 8];

/// The state at the end of every frame.
pub(super) type Trajectory = Vec<State>;

/// The motion with a number of steps a frame.
type Level = (u32, Result<Trajectory, ReferenceError>);

/// Motions of a scene by converged steps of several sizes.
pub(super) struct Convergence {
    pub(super) model: Model,
    /// Implicit Euler, the solver's integrator.
    euler: Vec<Level>,
    /// Second-order backward differentiation (BDF2): the fine motions, and those of the floors.
    second: Vec<Level>,
    /// Steps a frame of the fine motions.
    steps: [u32; 3],
    /// Time of all motions together \[s\].
    pub(super) seconds: f64,
}

/// The limit of small steps, extrapolated.
pub(super) struct Exact {
    pub(super) states: Trajectory,
    /// Estimated error, as [`distance`] measures it.
    pub(super) uncertainty: f64,
}

/// An integrator of the reference.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Formula {
    ImplicitEuler,
    Bdf2,
}

impl Convergence {
    /// Computes the motions of a scene with the given steps a frame, the fine ones and those of
    /// the floors.
    pub(super) fn compute(
        scene: &Scene,
        body: &Body,
        substeps: &[u32],
    ) -> Result<Self, ReferenceError> {
        let begin = Instant::now();
        let model = Model::of(&body.solver, &body.surface, &scene.params(1, 1))?;
        let start = State::of(&body.solver, &body.surface);
        let floors = FLOOR_SUBSTEPS.into_iter();
        let floors = floors.filter(|n| !scene.fine.contains(n));
        let second = scene.fine.into_iter().chain(floors);
        let second = second.map(|n| (Formula::Bdf2, n));
        let near = substeps
            .iter()
            .filter(|&&n| n <= scene.max_reference_substeps);
        let euler = near.map(|&n| (Formula::ImplicitEuler, n));
        let mut tasks: Vec<(Formula, u32)> = second.chain(euler).collect();
        // Longest first, for balance.
        tasks.sort_by_key(|task| std::cmp::Reverse(task.1));
        let done = tasks.into_par_iter().map(|(formula, n)| {
            let moved = trajectory(&model, &start, formula, n, scene.frames);
            (formula, (n, moved))
        });
        let done: Vec<(Formula, Level)> = done.collect();
        let (second, euler): (Vec<_>, Vec<_>) =
            done.into_iter().partition(|task| task.0 == Formula::Bdf2);
        let levels = |tasks: Vec<(Formula, Level)>| tasks.into_iter().map(|task| task.1).collect();
        Ok(Self {
            euler: levels(euler),
            second: levels(second),
            steps: scene.fine,
            model,
            seconds: begin.elapsed().as_secs_f64(),
        })
    }

    /// Returns the converged motion with a scheme's integrator; none if it was not computed.
    pub(super) fn known(&self, scheme: Scheme, substeps: u32) -> Option<&[State]> {
        let levels = match scheme {
            Scheme::Second | Scheme::GlobalSecond => &self.second,
            _ => &self.euler,
        };
        let states = level(levels, substeps).ok()?;
        (!states.is_empty()).then_some(states)
    }

    /// Returns the Richardson extrapolation of the two finest motions.
    pub(super) fn exact(&self) -> Result<Exact, ReferenceError> {
        let [coarse, middle, fine] = self.steps.map(|n| level(&self.second, n));
        let (coarse, middle, fine) = (coarse?, middle?, fine?);
        let before = extrapolate(coarse, middle);
        let states = extrapolate(middle, fine);
        // Of third order at least, so the error is a seventh of the change.
        let uncertainty = distance(&self.model, &before, &states) / 7.0;
        Ok(Exact {
            states,
            uncertainty,
        })
    }

    /// Returns the error of converged second-order steps; none if they were not computed.
    pub(super) fn floor(&self, exact: &Exact, substeps: u32) -> Option<f64> {
        let states = self.known(Scheme::Second, substeps)?;
        Some(distance(&self.model, states, &exact.states))
    }
}

fn level(levels: &[Level], substeps: u32) -> Result<&[State], ReferenceError> {
    match levels.iter().find(|level| level.0 == substeps) {
        Some((_, Ok(states))) => Ok(states),
        Some((_, Err(error))) => Err(*error),
        None => Ok(&[]),
    }
}

/// Removes the second-order error: `4/3 fine - 1/3 coarse`, with half the step for `fine`.
fn extrapolate(coarse: &[State], fine: &[State]) -> Trajectory {
    let both = coarse.iter().zip(fine);
    both.map(|(coarse, fine)| combine(fine, coarse, 4.0 / 3.0))
        .collect()
}

/// Returns `part * one + (1 - part) * other`.
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

/// Returns the converged motion with `n` steps a frame.
fn trajectory(
    model: &Model,
    start: &State,
    formula: Formula,
    n: u32,
    frames: u32,
) -> Result<Trajectory, ReferenceError> {
    // The solver's substep with its rounding.
    let h = f64::from(DT / n as f32);
    let mut stepper = Stepper::new(model)?;
    let mut state = start.clone();
    let mut before: Option<State> = None;
    let mut out = Vec::new();
    for _ in 0..frames {
        for _ in 0..n {
            let now = state.clone();
            if let Some(before) = before.filter(|_| formula == Formula::Bdf2) {
                // (3 x' - 4 x + x0) / 2h = v' and the same of v: an implicit Euler step of 2h/3
                // from (4 x - x0) / 3.
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
