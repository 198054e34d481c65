//! Errors of the first frames after a cut, against converged steps on the same surface.
//!
//! The global step keeps the factor of the uncut body in use for some frames. So each frame is also
//! repeated with a factor of its own, made in that frame.

use super::AccuracyOutput;
use super::convergence::Trajectory;
use super::error::distance;
use super::scene::Scene;
use super::scenes;
use crate::motion::{Body, DT};
use incise_cut::{CutParams, Cutter, Sweep};
use incise_pbd_gpu::{Scheme, SolverParams, StepError};
use incise_reference::{Model, State, Stepper};
use rayon::prelude::*;
use serde::Serialize;
use std::error::Error;
use std::time::Instant;

/// Frames of the global step before the cut, in runs whose errors are measured: all start from the
/// same state.
const FRAMES_BEFORE: u32 = 10;
/// Frames after the cut.
const FRAMES: usize = 20;
/// Runs whose times are taken.
const REPEATS: usize = 7;

/// A scheme with its number of iterations.
struct Way {
    name: &'static str,
    scheme: Scheme,
    iterations: u32,
}

/// The way to step the body before the cut.
const BEFORE: Way = way("before", Scheme::Global, 16);
/// The ways to step the body after the cut; an iteration of the global step takes about as long as
/// ten of sweeps.
const AFTER: [Way; 3] = [
    way("sweeps", Scheme::Sweeps, 80),
    way("global", Scheme::Global, 8),
    way("auto", Scheme::Auto, 8),
];

const fn way(name: &'static str, scheme: Scheme, iterations: u32) -> Way {
    Way {
        name,
        scheme,
        iterations,
    }
}

impl Way {
    fn params(&self, scene: &Scene) -> SolverParams {
        SolverParams {
            scheme: self.scheme,
            ..scene.params(1, self.iterations)
        }
    }
}

/// A frame after the cut by one scheme. Errors are of positions: root mean squares over vertices,
/// weighted by mass, over the mean rest length.
#[derive(Debug, Clone, Serialize)]
struct FrameRow {
    kind: &'static str,
    triangles: usize,
    solver: &'static str,
    iterations: u32,
    /// Number of the frame; the cut is before frame 1.
    frame: usize,
    /// Shortest time of the frame, the first with the update of the solver after the cut.
    ms: f64,
    /// Error to a converged step from the state before the frame.
    step_error: Option<f64>,
    /// The same with a factor made in this frame; none without the global step.
    fresh_error: Option<f64>,
    /// Motion of the converged step, as errors are measured.
    motion: Option<f64>,
    /// Error to converged steps from the state after the cut.
    drift: Option<f64>,
    /// Frames since the constraints of the factor in use were copied; none without one.
    factor_age: Option<u32>,
}

/// States of a run after the cut.
struct Run {
    /// The state after the cut and after each frame.
    states: Trajectory,
    /// The state after each frame with a factor of its own; empty without the global step.
    fresh: Trajectory,
    ages: Vec<Option<u32>>,
}

/// Measures the bodies, prints and writes the rows.
pub(super) fn run(output: &mut AccuracyOutput<'_>) -> Result<(), Box<dyn Error>> {
    for scene in scenes::hung_models() {
        for row in measure(&scene)? {
            output.row(scene.name, &row)?;
        }
        output.table()?;
    }
    Ok(())
}

/// Steps a scene's body before the cut.
fn before_cut(scene: &Scene, frames: u32, way: &Way) -> Result<(Body, Sweep), Box<dyn Error>> {
    let mut body = scene.body()?;
    for _ in 0..frames {
        (body.solver).step(&mut body.surface, DT, &way.params(scene))?;
    }
    let sweep = Sweep::from_plane([0.2, 1.0, 0.2], 0.0, &body.surface.bounds())?;
    Ok((body, sweep))
}

/// Measures all schemes on the body of a scene.
fn measure(scene: &Scene) -> Result<Vec<FrameRow>, Box<dyn Error>> {
    let (mut body, sweep) = before_cut(scene, FRAMES_BEFORE, &BEFORE)?;
    let triangles = body.surface.topology().triangle_count();
    let cut = Cutter::new(&body.surface).cut(&mut body.surface, &sweep, &CutParams::default())?;
    body.solver.apply_delta(&mut body.surface, &cut.delta)?;
    let model = Model::of(&body.solver, &body.surface, &scene.params(1, 1))?;
    let error =
        |a: &State, b: &State| distance(&model, std::slice::from_ref(a), std::slice::from_ref(b));
    let mut runs = Vec::new();
    for way in &AFTER {
        runs.push(follow(&body, &way.params(scene))?);
    }
    let (exact, restarted) = references(&model, &runs);
    let mut rows = Vec::new();
    for ((way, run), restarted) in AFTER.iter().zip(&runs).zip(restarted) {
        let ms = times(scene, way)?;
        for (k, restarted) in restarted.into_iter().enumerate() {
            let to_restarted = |state: &State| Some(error(state, restarted.as_ref()?));
            rows.push(FrameRow {
                kind: "after_cut",
                triangles,
                solver: way.name,
                iterations: way.iterations,
                frame: k + 1,
                ms: ms[k],
                step_error: to_restarted(&run.states[k + 1]),
                fresh_error: run.fresh.get(k).and_then(to_restarted),
                motion: to_restarted(&run.states[k]),
                drift: exact.get(k).map(|exact| error(&run.states[k + 1], exact)),
                factor_age: run.ages[k],
            });
        }
    }
    Ok(rows)
}

/// Steps a copy of the cut body.
fn follow(body: &Body, params: &SolverParams) -> Result<Run, StepError> {
    let mut body = body.clone();
    let mut run = Run {
        states: vec![State::of(&body.solver, &body.surface)],
        fresh: Vec::new(),
        ages: Vec::new(),
    };
    for _ in 0..FRAMES {
        let mut fresh = without_factor(&body)?;
        body.solver.step(&mut body.surface, DT, params)?;
        let is_global = body.solver.stats().global_iterations > 0;
        if is_global {
            fresh.solver.step(&mut fresh.surface, DT, params)?;
            run.fresh.push(State::of(&fresh.solver, &fresh.surface));
        }
        let age = body.solver.global_stats().factor_age;
        run.ages.push(is_global.then_some(age));
        run.states.push(State::of(&body.solver, &body.surface));
    }
    Ok(run)
}

/// Returns a copy of a body in the same state, whose next global step makes a factor.
fn without_factor(body: &Body) -> Result<Body, StepError> {
    let mut copy = body.clone();
    // A frame of sweeps drops the factor. It moves another copy of the surface.
    let mut moved = copy.surface.clone();
    (copy.solver).step(&mut moved, DT, &SolverParams::paper())?;
    for v in copy.surface.topology().vertices() {
        let [x, y, z, _] = body.solver.velocities()[v.index()];
        // Only a velocity that is not finite is refused, and a step has checked it.
        let _ = copy.solver.set_velocity(v, [x, y, z]);
    }
    Ok(copy)
}

/// Returns the converged motion from the cut on, as far as it converges, and for each run the
/// converged step from the state before every frame, where it converges.
fn references(model: &Model, runs: &[Run]) -> (Trajectory, Vec<Vec<Option<State>>>) {
    let step = |state: &State| -> Option<State> {
        let mut state = state.clone();
        let mut stepper = Stepper::new(model).ok()?;
        stepper.step(&mut state, f64::from(DT), &[]).ok()?;
        Some(state)
    };
    let motion = || {
        let states = std::iter::successors(runs[0].states.first().cloned(), step);
        states.skip(1).take(FRAMES).collect()
    };
    let restarted = || {
        // Where a scheme chooses another one, the states are the same.
        let first = |r: usize, k: usize| {
            let is_same = |s: &usize| runs[*s].states[k] == runs[r].states[k];
            (0..r).find(is_same).unwrap_or(r)
        };
        let all = 0..runs.len() * FRAMES;
        let all = all.into_par_iter().map(|i| (i / FRAMES, i % FRAMES));
        let made = all.map(|(r, k)| (first(r, k) == r).then(|| step(&runs[r].states[k])));
        let made: Vec<Option<Option<State>>> = made.collect();
        let of_run = |r: usize| {
            let of_frame = |k: usize| made[first(r, k) * FRAMES + k].clone().flatten();
            (0..FRAMES).map(of_frame).collect()
        };
        (0..runs.len()).map(of_run).collect()
    };
    rayon::join(motion, restarted)
}

/// Returns the shortest time of every frame after a cut \[ms\].
///
/// The frames before the cut use the same scheme.
/// Other programs lengthen the same frame of a few runs, but hardly of all.
fn times(scene: &Scene, way: &Way) -> Result<[f64; FRAMES], Box<dyn Error>> {
    let (body, sweep) = before_cut(scene, 3, way)?;
    let params = way.params(scene);
    let mut shortest = [f64::INFINITY; FRAMES];
    for _ in 0..REPEATS {
        let mut body = body.clone();
        // The copy's scratch memory grows in its first frame.
        (body.solver).step(&mut body.surface, DT, &params)?;
        let cut = CutParams::default();
        let cut = Cutter::new(&body.surface).cut(&mut body.surface, &sweep, &cut)?;
        let mut begin = Instant::now();
        body.solver.apply_delta(&mut body.surface, &cut.delta)?;
        for shortest in &mut shortest {
            (body.solver).step(&mut body.surface, DT, &params)?;
            *shortest = shortest.min(begin.elapsed().as_secs_f64() * 1e3);
            begin = Instant::now();
        }
    }
    Ok(shortest)
}
