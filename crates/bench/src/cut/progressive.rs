//! `incise-bench cut --progressive`: blades that move on through bodies step by step.
//!
//! A step is one mean edge length. It is timed as a frame of a scene does it: refit of the BVH of a
//! body in motion, [`incise_cut::Cutter::advance`], and the update of the solver's constraints.

mod bodies;
mod incised_body;
pub(crate) mod row;
mod strokes;

use super::CutArguments;
use super::row::{Record, Stamp};
use super::times::Times;
use crate::json::Json;
use crate::statistics::{mean, median};
use crate::text_table::{paragraphs, text_table};
use bodies::NewBody;
use incise_cut::CutParams;
use incised_body::{IncisedBody, Step};
use row::{Failure, Row};
use std::error::Error;
use std::io::Write;
use strokes::{Planes, StrokeKind, Strokes};

/// Steps that cut, in a row of the default run.
const STEPS: usize = 1000;
/// In a long run, a body with this many times its triangles is replaced by a new one.
const MAX_GROWTH: usize = 3;
/// In a long run, additional triangles of a body before it is replaced.
const MIN_GROWTH: usize = 2000;
/// Consecutive strokes without a cut after which a row is given up.
const MAX_IDLE_STROKES: usize = 1000;

/// The strokes and the motion of a row.
#[derive(Debug, Clone, Copy)]
struct Plan {
    /// Alternating kinds of strokes.
    kinds: &'static [StrokeKind],
    planes: Planes,
    /// Whether each of alternating bodies turns.
    motions: &'static [bool],
    /// Steps that cut.
    steps: usize,
    /// Whether a body that has grown is replaced.
    is_long: bool,
}

/// Measures all bodies, prints and writes the records.
///
/// With `--steps`, that many in all are distributed over ten bodies, in crossing planes.
pub(super) fn run(
    arguments: &CutArguments,
    params: &CutParams,
    stamp: &Stamp,
    json: &mut Json,
    out: &mut impl Write,
) -> Result<(), Box<dyn Error>> {
    let (folder, steps) = (arguments.from.models.as_deref(), arguments.steps);
    let bodies = bodies::load(folder, &arguments.only, steps.is_some())?;
    let plans: Vec<Plan> = match steps {
        Some(steps) => vec![Plan {
            kinds: &StrokeKind::ALL,
            planes: Planes::Crossing,
            motions: &[false, true],
            steps: steps.div_ceil(bodies.len().max(1)),
            is_long: true,
        }],
        None => {
            let motions: [&[bool]; 2] = [&[false], &[true]];
            let each = StrokeKind::ALL.iter().flat_map(|kind| {
                motions.map(|motions| Plan {
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
    let mut records = Vec::new();
    let progress = arguments.rows.progress(bodies.len() * plans.len(), 1);
    for body in &bodies {
        for plan in &plans {
            progress.begin(&body.name);
            let measured = Measured::new(body, plan, params, stamp.seed)?;
            let row = measured.into_row(body, plan, stamp);
            records.push(Record::Progressive(Box::new(row)));
            progress.step();
            // An interrupted run keeps its rows; the last write reports a failure.
            let _ = json.write(&records);
        }
    }
    progress.end();
    let rows: Vec<&Row> = records.iter().filter_map(Record::progressive).collect();
    write!(out, "{}", text_table(row::COLUMNS, &rows))?;
    write!(out, "{}", paragraphs(row::LEGEND))?;
    for row in &rows {
        for Failure { kind, count, first } in &row.failures {
            let text = format!("{}: {count} times {kind}, first in {first}.", row.model);
            write!(out, "{}", paragraphs(&text))?;
        }
    }
    let steps: usize = rows.iter().map(|row| row.steps).sum();
    let failures: usize = rows.iter().map(|row| row.failure_count()).sum();
    writeln!(out, "Failed: {failures} of {} steps.", steps + failures)?;
    Ok(json.write(&records)?)
}

/// Measurements of the strokes through one body, or through copies of it.
#[derive(Debug, Default)]
struct Measured {
    steps: Vec<Step>,
    /// Times of calls with the blade inside and unmoved \[us\].
    standing: Vec<f64>,
    failures: Vec<Failure>,
    bodies: usize,
    strokes: usize,
    missed: usize,
    triangles_at_end: usize,
}

impl Measured {
    /// Cuts the body until the plan's number of steps is reached.
    ///
    /// A body that is not valid after a stroke counts as a failure and is replaced.
    ///
    /// # Errors
    /// An error of the solver, or a message if strokes no longer meet the body.
    fn new(
        new: &NewBody,
        plan: &Plan,
        params: &CutParams,
        seed: u64,
    ) -> Result<Self, Box<dyn Error>> {
        let mut all = Self::default();
        let mut path = Strokes::new(plan.planes, seed);
        let triangles = new.surface.topology().triangle_count();
        let mut idle = 0;
        let mut body = None;
        while all.steps.len() < plan.steps {
            let own = match &mut body {
                Some(own) => own,
                None => {
                    all.bodies += 1;
                    body.insert(IncisedBody::new(new.surface.clone())?)
                }
            };
            let before = all.steps.len();
            let is_valid = all.stroke(own, plan, &mut path, params)?;
            idle = if all.steps.len() > before {
                0
            } else {
                idle + 1
            };
            if idle > MAX_IDLE_STROKES {
                return Err(format!("{}: no stroke cuts the body any more", new.name).into());
            }
            all.triangles_at_end = own.surface().topology().triangle_count();
            let limit = MAX_GROWTH * triangles + MIN_GROWTH;
            if !is_valid || plan.is_long && all.triangles_at_end > limit {
                body = None;
            }
        }
        Ok(all)
    }

    /// Moves the blade along the next stroke and lifts it; returns whether the body is valid.
    fn stroke(
        &mut self,
        body: &mut IncisedBody,
        plan: &Plan,
        path: &mut Strokes,
        params: &CutParams,
    ) -> Result<bool, Box<dyn Error>> {
        let kind = plan.kinds[self.strokes % plan.kinds.len()];
        let is_turning = plan.motions[self.bodies % plan.motions.len()];
        let stroke = path.next(kind, body.surface(), body.angle());
        self.strokes += 1;
        let number = self.strokes;
        for (i, pose) in stroke.poses(body.step_length()).enumerate() {
            match body.advance(&pose, params)? {
                Ok(Some(step)) => self.steps.push(step),
                Ok(None) => self.missed += 1,
                Err(error) => {
                    // The name of the variant, without its fields.
                    let kind = format!("{error:?}");
                    let end = kind.find(|c: char| !c.is_alphanumeric());
                    let kind = &kind[..end.unwrap_or(kind.len())];
                    let first = || format!("stroke {number}, step {i}: {error}");
                    Failure::add(&mut self.failures, kind, first);
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
            Failure::add(&mut self.failures, "InvalidSurface", first);
        } else {
            self.standing.extend(body.standing_time(params)?);
        }
        body.lift_blade();
        Ok(valid.is_ok())
    }

    fn into_row(self, body: &NewBody, plan: &Plan, stamp: &Stamp) -> Row {
        let times: Vec<Times> = self.steps.iter().map(|step| step.times).collect();
        let walls = self.steps.iter().map(|step| step.wall_triangles as f64);
        let walls: Vec<f64> = walls.collect();
        let decile = times.len() / 10;
        let ends = [0..decile, times.len() - decile..times.len()];
        let [first_ms, last_ms] = ends.clone().map(|part| {
            let totals: Vec<f64> = times[part].iter().map(|t| t.total).collect();
            mean(&totals)
        });
        let [first_walls, last_walls] = ends.map(|part| mean(&walls[part]));
        let kinds: Vec<&str> = plan.kinds.iter().map(|kind| kind.name()).collect();
        let motion = |turns: &bool| if *turns { "turning" } else { "still" };
        let motions: Vec<&str> = plan.motions.iter().map(motion).collect();
        Row {
            model: body.name.clone(),
            source: body.source.clone(),
            strokes: kinds.join(", "),
            planes: plan.planes.name().to_owned(),
            motion: motions.join(", "),
            triangles: body.surface.topology().triangle_count(),
            triangles_at_end: self.triangles_at_end,
            bodies: self.bodies,
            stroke_count: self.strokes,
            steps: times.len(),
            missed: self.missed,
            wall_triangles: self.steps.iter().map(|step| step.wall_triangles).sum(),
            wall_triangles_median: median(walls),
            ms_median: Times::percentile(&times, 50),
            ms_p90: Times::percentile(&times, 90),
            ms_p99: Times::percentile(&times, 99),
            ms_max: Times::percentile(&times, 100),
            first_ms,
            last_ms,
            growth: last_ms / first_ms,
            first_wall_triangles: first_walls,
            last_wall_triangles: last_walls,
            us_standing: median(self.standing),
            failures: self.failures,
            stamp: stamp.clone(),
        }
    }
}
