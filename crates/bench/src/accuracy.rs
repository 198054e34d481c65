//! Work and precision: what a frame costs for a given error, scene by scene.

mod error;
mod front;
mod ladder;
mod plot;
mod row;
mod run;
mod scene;
mod scenes;
mod shapes;
mod table;

use crate::{json, machine};
use clap::Args;
use error::Yardstick;
use incise_bench::State;
use incise_mesh::TriangleId;
use ladder::Ladder;
use row::Row;
use scene::{Body, DT, Scene, Scheme};
use std::error::Error;
use std::io::Write;
use std::path::PathBuf;

/// Which scenes are stepped and how often.
#[derive(Args, Clone)]
pub(crate) struct AccuracyArguments {
    /// Scenes to run, separated by commas.
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = scenes::NAMES)]
    only: Vec<String>,
    /// The most substeps, and the most iterations: powers of two up to that.
    #[arg(long, value_name = "N", default_value_t = 64, value_parser = clap::value_parser!(u32).range(1..=64))]
    most: u32,
    /// The most iterations a frame, those of all substeps together.
    #[arg(long, value_name = "N", default_value_t = 4096, value_parser = clap::value_parser!(u32).range(1..))]
    most_iterations: u32,
    /// Also write the rows as JSON, after every scene.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Also draw a picture of every scene, with the rows behind it as CSV.
    #[arg(long, value_name = "DIR")]
    plot: Option<PathBuf>,
}

/// Measures and prints.
pub(crate) fn run(
    arguments: &AccuracyArguments,
    out: &mut impl Write,
) -> Result<(), Box<dyn Error>> {
    let [machine, commit] = [machine::machine(), machine::commit()];
    writeln!(
        out,
        "{machine}, commit {commit}; errors are of positions, over the mean rest length"
    )?;
    if let Some(folder) = &arguments.plot {
        std::fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    }
    let wanted =
        |name: &&str| arguments.only.is_empty() || arguments.only.iter().any(|n| n == name);
    let mut rows: Vec<Row> = Vec::new();
    for name in scenes::NAMES.into_iter().filter(wanted) {
        let scene = scenes::scene(name)?;
        let first = rows.len();
        measure(arguments, &scene, [&machine, &commit], &mut rows, out)?;
        table::scene(out, &rows[first..])?;
        if let Some(path) = &arguments.json {
            json::write(path, &rows)?;
        }
        if let Some(folder) = &arguments.plot {
            plot::draw(folder, name, &rows[first..])?;
        }
    }
    table::summary(out, &rows)?;
    Ok(())
}

/// Powers of two.
fn powers(most: u32) -> Vec<u32> {
    (0..).map(|k| 1 << k).take_while(|&n| n <= most).collect()
}

/// All runs of a scene.
fn measure(
    arguments: &AccuracyArguments,
    scene: &Scene,
    [machine, commit]: [&str; 2],
    rows: &mut Vec<Row>,
    out: &mut impl Write,
) -> Result<(), Box<dyn Error>> {
    let body = scene.body()?;
    let numbers = powers(arguments.most);
    let ladder = Ladder::climb(scene, &body, &numbers)?;
    let exact = ladder.exact();
    table::reference(out, scene, &body, &ladder, exact.as_ref())?;
    let start = State::of(&body.solver, &body.surface);
    let triangles = closed_triangles(&body);
    let yardstick = Yardstick {
        model: &ladder.model,
        triangles: &triangles,
        start: &start,
        is_held: !scene.pins.is_empty(),
    };
    for scheme in Scheme::ALL {
        for &substeps in &numbers {
            let body = scene.body_by(scheme, f64::from(DT) / f64::from(substeps))?;
            for &iterations in &numbers {
                if substeps * iterations > arguments.most_iterations {
                    break;
                }
                let params = scene.params(substeps, iterations);
                let mut row = Row {
                    scene: scene.name,
                    backend: "cpu",
                    device: machine.to_owned(),
                    scheme: scheme.name(),
                    substeps,
                    iterations,
                    machine: machine.to_owned(),
                    commit: commit.to_owned(),
                    version: env!("CARGO_PKG_VERSION"),
                    ..Row::default()
                };
                match run::on_processor(&body, &params, scene.frames) {
                    Ok(run) => {
                        row.ms_per_frame = run.seconds * 1e3;
                        row.projections_per_frame = run.projections;
                        let states = &run.states;
                        row.solver_error = (ladder.rung(substeps).ok())
                            .map(|reference| yardstick.errors(states, reference));
                        row.total_error = (exact.as_ref().ok())
                            .map(|exact| yardstick.errors(states, &exact.states));
                        row.uncertainty = exact.as_ref().ok().map(|exact| exact.uncertainty);
                    }
                    Err(error) => row.refusal = Some(error.to_string()),
                }
                rows.push(row);
            }
        }
    }
    Ok(())
}

/// The triangles of a surface without a boundary.
fn closed_triangles(body: &Body) -> Vec<[usize; 3]> {
    let topology = body.surface.topology();
    let is_open = |t: TriangleId| t.half_edges().iter().any(|&h| topology.twin(h).is_null());
    if topology.triangles().any(is_open) {
        return Vec::new();
    }
    let triangles = topology.triangles();
    triangles
        .map(|t| topology.triangle(t).map(|v| v.index()))
        .collect()
}
