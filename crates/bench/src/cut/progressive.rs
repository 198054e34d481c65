//! `incise-bench cut --progressive`: blades that move on through bodies step by step.
//!
//! A step is one mean edge length. It is timed as a frame of a scene does it, in which nothing else
//! queries the BVH: [`incise_cut::Cutter::advance`], and the update of the solver's constraints.

mod incised_body;
mod strokes;

use super::body::StageTimes;
use super::{CutArguments, CutOutput, Parameters};
use crate::failure::Failure;
use crate::measure::{mean, median};
use crate::workload::{Workload, progressive_workloads};
use incise_cut::CutParams;
use incise_mesh::Surface;
use incised_body::{IncisedBody, Step};
use serde::Serialize;
use std::error::Error;
use strokes::{Planes, StrokeKind, Strokes};

/// Steps that cut, in a row of the default run.
const STEPS: usize = 1000;
/// In a long run, a body with this many times its triangles is replaced by a new one.
const MAX_GROWTH: usize = 3;
/// In a long run, additional triangles of a body before it is replaced.
const MIN_GROWTH: usize = 2000;
/// Consecutive strokes without a cut after which a row is given up.
const MAX_IDLE_STROKES: usize = 1000;

/// Motions of a body in rows.
const STILL: &str = "still";
const TURNING: &str = "turning";

/// The strokes and the motion of a row.
#[derive(Debug, Clone, Copy)]
struct Plan {
    /// Alternating kinds of strokes.
    kinds: &'static [StrokeKind],
    planes: Planes,
    /// The motions of alternating bodies.
    motions: &'static [&'static str],
    /// Steps that cut.
    steps: usize,
    /// Whether a body that has grown is replaced.
    is_long: bool,
}

/// Steps of a blade through one body, stroke after stroke.
#[derive(Debug, Default, Serialize)]
struct Row {
    kind: &'static str,
    source: String,
    /// The kinds of strokes: `drag`, `press` or both in turns.
    strokes: String,
    /// Whether the planes of the strokes are `parallel` or `crossing`.
    planes: Planes,
    /// Whether the body is `still` or `turning`.
    motion: String,
    triangles: usize,
    triangles_at_end: usize,
    /// Number of bodies, one after the other.
    bodies: usize,
    stroke_count: usize,
    /// Steps that cut.
    steps: usize,
    /// Steps without a cut, outside of the body or too short.
    missed: usize,
    /// Triangles of all walls.
    wall_triangles: usize,
    /// Triangles of both walls of a step, median.
    wall_triangles_median: f64,
    ms_median: StageTimes,
    ms_p90: StageTimes,
    ms_p99: StageTimes,
    ms_max: StageTimes,
    /// Mean times of the steps of the first and of the last tenth \[ms\], and their ratio.
    first_ms: f64,
    last_ms: f64,
    growth: f64,
    /// Mean wall triangles of the steps of the first and of the last tenth.
    first_wall_triangles: f64,
    last_wall_triangles: f64,
    /// Time of a call with the blade inside and unmoved, median \[us\].
    us_standing: f64,
    failures: Vec<Failure>,
}

/// Measures all bodies, prints and writes the rows.
///
/// With `--steps`, that many in all are distributed over ten bodies, in crossing planes.
pub(super) fn run(
    arguments: &CutArguments,
    mut output: CutOutput<'_>,
) -> Result<(), Box<dyn Error>> {
    let steps = arguments.steps;
    let parameters = output.parameters;
    let bodies = progressive_workloads(&arguments.models, steps.is_some())?;
    // A solid is moved by its solver only.
    let motions: &'static [&'static str] = match parameters.material.is_solid() {
        true => &[STILL],
        false => &[STILL, TURNING],
    };
    let plans: Vec<Plan> = match steps {
        Some(steps) => vec![Plan {
            kinds: &StrokeKind::ALL,
            planes: Planes::Crossing,
            motions,
            steps: steps.div_ceil(bodies.len().max(1)),
            is_long: true,
        }],
        None => {
            let each = StrokeKind::ALL.iter().flat_map(|kind| {
                motions.chunks(1).map(|motions| Plan {
                    kinds: std::slice::from_ref(kind),
                    planes: Planes::Parallel,
                    motions,
                    steps: STEPS,
                    is_long: false,
                })
            });
            each.collect()
        }
    };
    let (mut steps, mut failures) = (0, 0);
    output.start(bodies.len() * plans.len(), 1);
    for body in &bodies {
        let surface = body.surface()?;
        for plan in &plans {
            output.progress.begin(&body.name);
            let row = Measured::row(body, &surface, plan, &parameters)?;
            steps += row.steps;
            let counts = row.failures.iter().map(|failure| failure.count);
            failures += counts.sum::<usize>();
            output.row(&body.name, &row)?;
            output.progress.step();
        }
    }
    output.table()?;
    let line = format_args!("Failed: {failures} of {} steps.", steps + failures);
    Ok(output.print(line)?)
}

/// Measurements of the strokes through one body, or through copies of it.
#[derive(Debug, Default)]
struct Measured {
    /// Counts and failures; statistics follow at the end.
    row: Row,
    steps: Vec<Step>,
    /// Times of calls with the blade inside and unmoved \[us\].
    standing: Vec<f64>,
}

impl Measured {
    /// Cuts the body until the plan's number of steps is reached, and returns the row.
    ///
    /// A body that is not valid after a stroke counts as a failure and is replaced.
    ///
    /// # Errors
    /// An error of the solver, or a message if strokes no longer meet the body.
    fn row(
        workload: &Workload,
        surface: &Surface,
        plan: &Plan,
        parameters: &Parameters,
    ) -> Result<Row, Box<dyn Error>> {
        let mut all = Self::default();
        let params = parameters.caps.exact();
        let mut path = Strokes::new(plan.planes, parameters.seed);
        let triangles = surface.topology().triangle_count();
        let mut idle = 0;
        let mut body = None;
        while all.steps.len() < plan.steps {
            let own = match &mut body {
                Some(own) => own,
                None => {
                    all.row.bodies += 1;
                    body.insert(IncisedBody::new(
                        surface.clone(),
                        &parameters.material.material(),
                    )?)
                }
            };
            let before = all.steps.len();
            let is_valid = all.stroke(own, plan, &mut path, &params)?;
            idle = match all.steps.len() > before {
                true => 0,
                false => idle + 1,
            };
            if idle > MAX_IDLE_STROKES {
                let name = &workload.name;
                return Err(format!("{name}: no stroke cuts the body any more").into());
            }
            all.row.triangles_at_end = own.surface.topology().triangle_count();
            let limit = MAX_GROWTH * triangles + MIN_GROWTH;
            if !is_valid || plan.is_long && all.row.triangles_at_end > limit {
                body = None;
            }
        }
        Ok(Row {
            kind: "progressive",
            source: workload.source.clone(),
            strokes: plan
                .kinds
                .iter()
                .map(|kind| kind.name())
                .collect::<Vec<_>>()
                .join(", "),
            planes: plan.planes,
            motion: plan.motions.join(", "),
            triangles,
            ..all.into_row()
        })
    }

    /// Moves the blade along the next stroke and lifts it; returns whether the body is valid.
    fn stroke(
        &mut self,
        body: &mut IncisedBody,
        plan: &Plan,
        path: &mut Strokes,
        params: &CutParams,
    ) -> Result<bool, Box<dyn Error>> {
        let kind = plan.kinds[self.row.stroke_count % plan.kinds.len()];
        let is_turning = plan.motions[self.row.bodies % plan.motions.len()] == TURNING;
        let stroke = path.next(kind, &body.surface, body.angle);
        self.row.stroke_count += 1;
        let number = self.row.stroke_count;
        for (i, pose) in stroke.poses(body.step_length).enumerate() {
            match body.advance(&pose, params)? {
                Ok(Some(step)) => self.steps.push(step),
                Ok(None) => self.row.missed += 1,
                Err(error) => {
                    let at = format_args!("stroke {number}, step {i}");
                    Failure::add_error(&mut self.row.failures, &error, at);
                }
            }
            if is_turning {
                body.turn();
            }
            if self.steps.len() == plan.steps {
                break;
            }
        }
        let valid = body.validate();
        if let Err(error) = &valid {
            let first = || format!("stroke {number}: {error}");
            Failure::add(&mut self.row.failures, "InvalidSurface", first);
        } else {
            self.standing.extend(body.standing_time(params)?);
        }
        body.lift_blade();
        Ok(valid.is_ok())
    }

    /// Returns the row with the statistics of all steps.
    fn into_row(self) -> Row {
        let times: Vec<StageTimes> = self.steps.iter().map(|step| step.times).collect();
        let walls = self.steps.iter().map(|step| step.wall_triangles as f64);
        let walls: Vec<f64> = walls.collect();
        let decile = times.len() / 10;
        let ends = [0..decile, times.len() - decile..times.len()];
        let [first_ms, last_ms] = ends.clone().map(|part| {
            let totals: Vec<f64> = times[part].iter().map(StageTimes::total).collect();
            mean(&totals)
        });
        let [first_walls, last_walls] = ends.map(|part| mean(&walls[part]));
        Row {
            steps: times.len(),
            wall_triangles: self.steps.iter().map(|step| step.wall_triangles).sum(),
            wall_triangles_median: median(walls),
            ms_median: StageTimes::percentile(&times, 50),
            ms_p90: StageTimes::percentile(&times, 90),
            ms_p99: StageTimes::percentile(&times, 99),
            ms_max: StageTimes::percentile(&times, 100),
            first_ms,
            last_ms,
            growth: last_ms / first_ms,
            first_wall_triangles: first_walls,
            last_wall_triangles: last_walls,
            us_standing: median(self.standing),
            ..self.row
        }
    }
}
