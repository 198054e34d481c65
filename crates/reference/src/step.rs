//! Steps of the reference by Newton's method.

use super::error::ReferenceError;
use super::matrix::System;
use super::model::{Constraints, Model, Plane, State};
use super::objective::Objective;
use nalgebra::Vector3;

/// Final Newton decrement, relative to the first.
const DONE: f64 = 1e-12;

/// Smallest share of the predicted decrease in a line search (Armijo).
const DECREASE: f64 = 1e-4;

/// Relative decrement below which Hessians are not projected: near the solution their sum is
/// positive and convergence is quadratic.
const NEAR: f64 = 1e-2;

/// Largest relative decrement after a step with an old factor; a new one costs as much as ten such
/// steps.
const KEPT: f64 = 0.3;

/// Largest step with an old factor, relative to the mean rest length.
const NEARBY: f64 = 0.01;

/// Largest relative constraint error after a round of multipliers; slower constraints are
/// stiffened.
const SLOW: f64 = 0.1;

/// Largest number of Newton steps.
const MOST_NEWTON: usize = 2000;

/// Largest number of halvings in a line search.
const MOST_HALVINGS: usize = 60;

/// A Newton direction and its decrement.
type Step = (Vec<Vector3<f64>>, f64);

/// Steps one model through time.
pub struct Stepper<'a> {
    model: &'a Model,
    system: System,
    /// Time step of the last factored matrix.
    factored: Option<f64>,
    /// Longest step with that factor \[m\].
    reach: f64,
}

impl std::fmt::Debug for Stepper<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Stepper").finish_non_exhaustive()
    }
}

/// Cost and multipliers of a step.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct StepReport {
    /// Number of Newton steps.
    pub newton_steps: usize,
    /// Decrement before the last Newton step over the first; 0 if the first is 0.
    pub decrement: f64,
    /// Multipliers of edges \[N\], negative in tension, shape \[edges\].
    pub stretch: Vec<f64>,
    /// Multipliers of hinges [N m], shape \[hinges\].
    pub bending: Vec<f64>,
    /// Forces of the plane \[N\], shape \[vertices\]; empty without plane.
    pub plane: Vec<f64>,
    /// Overpressure of pieces \[Pa\], shape \[pieces\].
    pub pressure: Vec<f64>,
}

/// The end of a step, with its objective.
struct Solved<'a> {
    objective: Objective<'a>,
    x: Vec<Vector3<f64>>,
    report: StepReport,
}

impl<'a> Stepper<'a> {
    /// Analyzes the pattern of a model.
    ///
    /// # Errors
    /// [`ReferenceError`] for arrays that do not fit or numbers out of range.
    pub fn new(model: &'a Model) -> Result<Self, ReferenceError> {
        check(model)?;
        let system = System::new(model)?;
        let rest = &model.stretch.rest;
        Ok(Self {
            model,
            system,
            factored: None,
            reach: NEARBY * rest.iter().sum::<f64>() / rest.len().max(1) as f64,
        })
    }

    /// Steps by `h` \[s\]; vertices without mass move to their targets in `held` \[m\], or stay.
    ///
    /// # Errors
    /// [`ReferenceError::NotConverged`], [`ReferenceError::BadNumber`] or
    /// [`ReferenceError::NotHeld`]; the state does not change then.
    pub fn step(
        &mut self,
        state: &mut State,
        h: f64,
        held: &[(usize, Vector3<f64>)],
    ) -> Result<StepReport, ReferenceError> {
        let Solved {
            objective,
            x,
            report,
        } = self.solve(state, h, held)?;
        for ((at, v), to) in state.x.iter_mut().zip(&mut state.v).zip(x) {
            *v = (to - *at) / h;
            *at = to;
        }
        Ok(StepReport {
            stretch: objective.stretch.lambda,
            bending: objective.bending.lambda,
            plane: objective.plane.lambda,
            pressure: (objective.volume.lambda.iter())
                .zip(&self.model.volumes.pieces)
                .map(|(lambda, piece)| lambda * piece.scale())
                .collect(),
            ..report
        })
    }

    /// Solves a step.
    fn solve(
        &mut self,
        state: &State,
        h: f64,
        held: &[(usize, Vector3<f64>)],
    ) -> Result<Solved<'a>, ReferenceError> {
        let model = self.model;
        let fits = state.x.len() == model.mass.len() && state.v.len() == model.mass.len();
        let all = || state.x.iter().chain(&state.v).flat_map(|p| p.iter());
        if !(fits && all().all(|c| c.is_finite())) {
            return Err(ReferenceError::BadNumber { name: "the state" });
        }
        if !(h.is_finite() && h > 0.0) {
            return Err(ReferenceError::BadNumber {
                name: "the time step",
            });
        }
        let kept = 1.0 / (1.0 + model.damping * h);
        let mut goal: Vec<Vector3<f64>> = Vec::with_capacity(state.x.len());
        for ((x, v), &mass) in state.x.iter().zip(&state.v).zip(&model.mass) {
            let free = if mass > 0.0 { kept } else { 0.0 };
            goal.push(x + (v + model.gravity * h) * (free * h));
        }
        for &(vertex, to) in held {
            if model.mass.get(vertex).is_none_or(|&mass| mass > 0.0) {
                return Err(ReferenceError::NotHeld { vertex });
            }
            goal[vertex] = to;
        }
        let mut x = goal.clone();
        let mut objective = Objective::new(model, h, &state.x, goal);
        self.factored = self.factored.filter(|&of| of == h);
        let mut report = StepReport::default();
        let mut first = 0.0_f64;
        let mut before = f64::INFINITY;
        loop {
            self.minimize(&objective, &mut x, &mut first, &mut report)?;
            let lack = objective.update(&x);
            if lack <= objective.rounding.max(DONE * first) {
                break;
            }
            if lack > SLOW * before {
                objective.stiffen(&x);
            }
            before = lack;
        }
        Ok(Solved {
            objective,
            x,
            report,
        })
    }

    /// Moves `x` to the minimum.
    fn minimize(
        &mut self,
        objective: &Objective<'_>,
        x: &mut [Vector3<f64>],
        first: &mut f64,
        report: &mut StepReport,
    ) -> Result<(), ReferenceError> {
        let mut before = f64::INFINITY;
        loop {
            // The last step is a full Newton step, which squares the error.
            let most = KEPT * before;
            let least = objective.rounding.max(DONE * *first);
            let kept = self.kept_direction(objective, x);
            let (direction, decrement) = match kept {
                Some(kept) if least < kept.1 && kept.1 <= most => kept,
                _ => self.direction(objective, x, before <= NEAR * *first)?,
            };
            *first = first.max(decrement);
            report.decrement = if *first > 0.0 {
                decrement / *first
            } else {
                0.0
            };
            if report.newton_steps == MOST_NEWTON {
                return Err(ReferenceError::NotConverged {
                    newton_steps: MOST_NEWTON,
                    decrement: report.decrement,
                });
            }
            report.newton_steps += 1;
            let done = decrement <= objective.rounding.max(DONE * *first);
            let share = if done {
                1.0
            } else {
                share_of(objective, x, &direction, decrement)
            };
            if share < 1.0 {
                self.factored = None;
            }
            for (x, way) in x.iter_mut().zip(&direction) {
                *x += way * share;
            }
            if done {
                return Ok(());
            }
            before = decrement;
        }
    }

    /// Returns a step from `x` with the last factor; none without one or for a long step.
    fn kept_direction(&mut self, objective: &Objective<'_>, x: &[Vector3<f64>]) -> Option<Step> {
        self.factored?;
        let step = self.along(&objective.gradient(x))?;
        let is_short = step.0.iter().all(|way| way.norm() <= self.reach);
        is_short.then_some(step)
    }

    /// Returns the Newton step from `x`.
    ///
    /// `near` the solution Hessians are not projected if their sum is positive.
    fn direction(
        &mut self,
        objective: &Objective<'_>,
        x: &[Vector3<f64>],
        near: bool,
    ) -> Result<Step, ReferenceError> {
        self.factored = None;
        let tries: &[bool] = if near { &[false, true] } else { &[true] };
        for &positive in tries {
            let gradient = objective.derivatives(x, &mut self.system, positive);
            if self.system.factor()
                && let Some(step) = self.along(&gradient)
            {
                self.factored = Some(objective.h);
                return Ok(step);
            }
        }
        let unknowns = 3 * self.model.mass.iter().filter(|&&m| m > 0.0).count();
        Err(ReferenceError::NotFactored { unknowns })
    }

    /// Returns the step of the last factor for a gradient.
    fn along(&mut self, gradient: &[Vector3<f64>]) -> Option<Step> {
        let down: Vec<Vector3<f64>> = gradient.iter().map(|g| -g).collect();
        let direction = self.system.solve(&down)?;
        let square: f64 = (direction.iter().zip(&down)).map(|(d, g)| d.dot(g)).sum();
        Some((direction, square.max(0.0).sqrt()))
    }
}

/// Returns the largest power of 1/2 that decreases the objective enough along a direction.
fn share_of(
    objective: &Objective<'_>,
    x: &[Vector3<f64>],
    direction: &[Vector3<f64>],
    decrement: f64,
) -> f64 {
    let here = objective.value(x);
    // Rounding of the sum and of the positions (Cauchy's inequality over all terms).
    let rounding = 4.0 * objective.rounding;
    let slack = 64.0 * f64::EPSILON * here + rounding * ((2.0 * here).sqrt() + rounding);
    let mut share = 1.0;
    for _ in 0..MOST_HALVINGS {
        let there: Vec<Vector3<f64>> = (x.iter().zip(direction))
            .map(|(x, way)| x + way * share)
            .collect();
        let promised = DECREASE * share * decrement * decrement;
        if objective.value(&there) <= here - promised + slack {
            break;
        }
        share /= 2.0;
    }
    share
}

/// Checks the arrays of a model.
fn check(model: &Model) -> Result<(), ReferenceError> {
    let good = |value: f64| value.is_finite() && value >= 0.0;
    let bad = |name| Err(ReferenceError::BadNumber { name });
    if !model.mass.iter().all(|&m| good(m)) {
        return bad("a mass");
    }
    if !(good(model.damping) && model.gravity.iter().all(|g| g.is_finite())) {
        return bad("gravity or damping");
    }
    let is_bad = |plane: Plane| {
        let square = plane.normal.norm_squared();
        !((square - 1.0).abs() < 1e-6 && plane.offset.is_finite())
    };
    if model.plane.is_some_and(is_bad) {
        return bad("the plane");
    }
    let volumes = &model.volumes;
    if !good(volumes.compressibility) {
        return bad("a compressibility");
    }
    if !volumes.pressure.is_finite() {
        return bad("a pressure");
    }
    let vertices = model.mass.len();
    for (constraint, piece) in volumes.pieces.iter().enumerate() {
        let mut all = piece.triangles().iter().flatten();
        if let Some(&vertex) = all.find(|&&v| v >= vertices) {
            return Err(ReferenceError::VertexOutOfRange {
                constraint,
                vertex,
                vertices,
            });
        }
    }
    check_kind(&model.stretch, vertices)?;
    check_kind(&model.bending, vertices)
}

fn check_kind<const N: usize>(
    constraints: &Constraints<N>,
    vertices: usize,
) -> Result<(), ReferenceError> {
    let Constraints {
        rest, compliance, ..
    } = constraints;
    let bad = |name| Err(ReferenceError::BadNumber { name });
    if !(compliance.is_finite() && *compliance >= 0.0) {
        return bad("a compliance");
    }
    if rest.len() != constraints.vertices.len() || !rest.iter().all(|r| r.is_finite()) {
        return bad("a rest value");
    }
    for (constraint, of) in constraints.vertices.iter().enumerate() {
        if let Some(&vertex) = of.iter().find(|&&v| v >= vertices) {
            return Err(ReferenceError::VertexOutOfRange {
                constraint,
                vertex,
                vertices,
            });
        }
    }
    Ok(())
}
