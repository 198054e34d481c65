//! `incise-bench strokes`: blades that cut bodies step by step, at rest and under tension.

mod at_rest;
mod in_scene;
mod kinds;
mod paths;
mod trial;

use crate::failure::Failure;
use crate::models::named;
use crate::options::OutputArguments;
use crate::output::Output;
use clap::Args;
use incise_cut::CutParams;
use incise_mesh::{AngleStats, EdgeStats, Vec3};
use incise_models::scenes::Directions;
use kinds::{KINDS, Kind};
use serde::Serialize;
use std::any::Any;
use std::error::Error;
use std::io::Write;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Instant;
use trial::Trial;

/// Minimum part of a body that is a piece and no scrap, of its volume or of a sheet's triangles.
const MIN_PIECE: f64 = 0.02;

/// Moves blades through bodies, and counts refused steps, pieces and invalid surfaces.
///
/// A row is a kind of stroke. `steps`: motions of the blade; `full`: strokes that pass through the
/// whole body, of which `parted` leave two pieces of at least 2% of the body, `scraps` only smaller
/// ones, and `whole` none. `invalid`: surfaces with a broken invariant, or at rest another volume
/// than before (1e-4). `triangles`: means before and after. `min_edge`: shortest edge [mean edges
/// of its body]; `wall_angle`: 5th percentile of the angles of walls [degrees], both in the rest
/// shape.
#[derive(Args, Clone)]
pub(crate) struct StrokesArguments {
    /// Kinds to run, separated by commas; all by default.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    kind: Vec<String>,
    /// Number of the first stroke, to repeat one of a row.
    #[arg(long, value_name = "N", default_value_t = 0)]
    first: u32,
    #[command(flatten)]
    parameters: Parameters,
    #[command(flatten)]
    output: OutputArguments,
}

/// The parameters of all rows.
#[derive(Args, Clone, Copy, Debug, Serialize)]
struct Parameters {
    /// Number of strokes per kind.
    #[arg(long, value_name = "N", default_value_t = 20)]
    seeds: u32,
    /// Seed of bodies and paths.
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

/// The strokes of one kind.
#[derive(Debug, Default, Serialize)]
struct Row {
    strokes: u32,
    steps: usize,
    /// Steps that cut.
    cutting: usize,
    /// Refused steps.
    refused: usize,
    /// Strokes with a refused step.
    strokes_refused: u32,
    full: u32,
    parted: u32,
    scraps: u32,
    whole: u32,
    invalid: u32,
    triangles_before: usize,
    triangles_after: usize,
    min_edge: f64,
    wall_angle: f64,
    seconds: f64,
    /// Refused steps by the error's name.
    errors: Vec<Failure>,
    /// Invalid surfaces.
    broken: Vec<Failure>,
}

/// Runs all kinds, prints and writes the rows.
pub(crate) fn run(arguments: &StrokesArguments, out: &mut dyn Write) -> Result<(), Box<dyn Error>> {
    let kinds = named(KINDS.iter().collect(), |kind| kind.name, &arguments.kind)?;
    let parameters = arguments.parameters;
    let mut output = Output::open("strokes", &arguments.output, parameters, out)?;
    output.start(kinds.len(), 1);
    let mut all = Row::default();
    for kind in kinds {
        output.progress.begin(kind.name);
        let row = measure(kind, arguments);
        all.steps += row.steps;
        all.refused += row.refused;
        all.whole += row.whole;
        all.scraps += row.scraps;
        all.full += row.full;
        all.invalid += row.invalid;
        output.row(kind.name, &row)?;
        output.progress.step();
    }
    output.table()?;
    let Row {
        steps,
        refused,
        whole,
        scraps,
        full,
        invalid,
        ..
    } = all;
    Ok(output.print(format_args!(
        "Failed: {refused} refused of {steps} steps; {whole} whole and {scraps} scraps of {full} \
         full strokes; {invalid} invalid."
    ))?)
}

/// Returns the row of a kind.
fn measure(kind: &Kind, arguments: &StrokesArguments) -> Row {
    let Parameters { seeds, seed } = arguments.parameters;
    let begin = Instant::now();
    let mut row = Row {
        min_edge: f64::INFINITY,
        ..Row::default()
    };
    let mut walls = Vec::new();
    for number in arguments.first..arguments.first.saturating_add(seeds) {
        // Equal numbers of different kinds have the same body where they choose among the same.
        let mut random = Directions(seed << 32 ^ u64::from(number));
        let mut trial = Trial::new(number);
        let stroke = || (kind.run)(&mut random, &mut trial);
        let end = catch_unwind(AssertUnwindSafe(stroke));
        match end {
            Ok(Ok(())) => {}
            Ok(Err(error)) => trial.fail(&error),
            Err(panic) => trial.fail_by("Panic", &message(&*panic)),
        }
        row.add(trial, &mut walls);
    }
    row.triangles_before /= (seeds as usize).max(1);
    row.triangles_after /= (seeds as usize).max(1);
    row.wall_angle = AngleStats::from_triangles(walls).percentile_5;
    row.seconds = begin.elapsed().as_secs_f64();
    row
}

/// Returns the message of a panic.
fn message(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|&text| text.to_owned());
    let text = text.or_else(|| panic.downcast_ref::<String>().cloned());
    text.unwrap_or_default()
}

impl Row {
    /// Adds a stroke and the triangles of its walls at rest.
    fn add(&mut self, trial: Trial, walls: &mut Vec<[Vec3; 3]>) {
        let refused = trial
            .failures
            .iter()
            .map(|failure| failure.count)
            .sum::<usize>();
        self.strokes += 1;
        self.steps += trial.steps;
        self.cutting += trial.cutting;
        self.refused += refused;
        self.strokes_refused += u32::from(refused > 0);
        if trial.is_full {
            self.full += 1;
            *match trial.second_piece() {
                Some(part) if part >= MIN_PIECE => &mut self.parted,
                Some(_) => &mut self.scraps,
                None => &mut self.whole,
            } += 1;
        }
        if let Some((kind, error)) = trial.defect() {
            self.invalid += 1;
            let first = || format!("stroke {}: {error}", trial.number);
            Failure::add(&mut self.broken, kind, first);
        }
        self.triangles_before += trial.triangles;
        self.triangles_after += trial.surface.topology().triangle_count();
        let edges = EdgeStats::from_triangles(trial.rest_triangles(|_| true));
        self.min_edge = self.min_edge.min(edges.min / edges.mean);
        let wall = CutParams::default().cap_material;
        walls.extend(trial.rest_triangles(|t| trial.surface.material(t) == wall));
        for failure in trial.failures {
            failure.merge_into(&mut self.errors);
        }
    }
}
