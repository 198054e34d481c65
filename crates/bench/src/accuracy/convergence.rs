//! Reference motions: converged implicit steps of decreasing size and their extrapolation.

use super::error::{ErrorMeasure, distance};
use super::scene::Scene;
use crate::motion::{Body, DT};
use incise_pbd_gpu::Integrator;
use incise_reference::{ReferenceError, State, Stepper};
use nalgebra::Vector3;
use rayon::prelude::*;
use std::time::Instant;

/// Numbers of substeps whose converged second-order steps give floors of errors.
pub(super) const FLOOR_SUBSTEPS: [u32; 4] = [1, 2, 4, 8];

/// The state at the end of every frame.
pub(super) type Trajectory = Vec<State>;

/// The motion by an integrator with a number of steps a frame.
struct Level {
    integrator: Integrator,
    steps: u32,
    states: Result<Trajectory, ReferenceError>,
}

/// Motions of a scene by converged steps of several sizes.
pub(super) struct Convergence {
    pub(super) measure: ErrorMeasure,
    /// By implicit Euler, the solver's integrator, and by second-order backward differentiation
    /// (BDF2): the fine motions, and those of the floors.
    levels: Vec<Level>,
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

impl Convergence {
    /// Computes the motions of a scene with the given steps a frame, the fine ones and those of
    /// the floors.
    pub(super) fn compute(
        scene: &Scene,
        body: &Body,
        substeps: &[u32],
    ) -> Result<Self, ReferenceError> {
        let begin = Instant::now();
        let measure = ErrorMeasure::new(scene, body)?;
        let floors = FLOOR_SUBSTEPS.into_iter();
        let floors = floors.filter(|n| !scene.fine.contains(n));
        let second = scene.fine.into_iter().chain(floors);
        let near = substeps.iter().copied();
        let near = near.filter(|&n| n <= scene.max_reference_substeps);
        let second = second.map(|n| (Integrator::Bdf2, n));
        let first = near.map(|n| (Integrator::Euler, n));
        let mut tasks: Vec<(Integrator, u32)> = second.chain(first).collect();
        // Longest first, for balance.
        tasks.sort_by_key(|task| std::cmp::Reverse(task.1));
        let levels = tasks.into_par_iter().map(|(integrator, steps)| Level {
            integrator,
            steps,
            states: trajectory(&measure, integrator, steps, scene.frames),
        });
        Ok(Self {
            levels: levels.collect(),
            steps: scene.fine,
            measure,
            seconds: begin.elapsed().as_secs_f64(),
        })
    }

    /// Returns the converged motion with an integrator; none if it was not computed.
    pub(super) fn known(&self, integrator: Integrator, substeps: u32) -> Option<&[State]> {
        let states = self.level(integrator, substeps).ok()?;
        (!states.is_empty()).then_some(states)
    }

    /// Returns the Richardson extrapolation of the two finest motions.
    pub(super) fn exact(&self) -> Result<Exact, ReferenceError> {
        let [coarse, middle, fine] = self.steps.map(|n| self.level(Integrator::Bdf2, n));
        let (coarse, middle, fine) = (coarse?, middle?, fine?);
        let before = extrapolate(coarse, middle);
        let states = extrapolate(middle, fine);
        // Of third order at least, so the error is a seventh of the change.
        let uncertainty = distance(&self.measure.model, &before, &states) / 7.0;
        Ok(Exact {
            states,
            uncertainty,
        })
    }

    /// Returns the error of converged second-order steps; none if they were not computed.
    pub(super) fn floor(&self, exact: &Exact, substeps: u32) -> Option<f64> {
        let states = self.known(Integrator::Bdf2, substeps)?;
        Some(distance(&self.measure.model, states, &exact.states))
    }

    fn level(&self, integrator: Integrator, steps: u32) -> Result<&[State], ReferenceError> {
        let mut levels = self.levels.iter();
        match levels.find(|level| level.integrator == integrator && level.steps == steps) {
            Some(level) => level.states.as_deref().map_err(|error| *error),
            None => Ok(&[]),
        }
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
    measure: &ErrorMeasure,
    integrator: Integrator,
    n: u32,
    frames: u32,
) -> Result<Trajectory, ReferenceError> {
    // The solver's substep with its rounding.
    let h = f64::from(DT / n as f32);
    let mut stepper = Stepper::new(&measure.model)?;
    let mut state = measure.start.clone();
    let mut before: Option<State> = None;
    let mut out = Vec::new();
    for _ in 0..frames {
        for _ in 0..n {
            let now = state.clone();
            if let Some(before) = before.filter(|_| integrator == Integrator::Bdf2) {
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
