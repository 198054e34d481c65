//! Printed tables of the accuracy bench.

use super::convergence::{Convergence, Exact};
use super::error::ErrorMeasure;
use super::scene::{Body, Scene};
use super::scenes;
use crate::numbers::{exponent, fixed};
use crate::text_table::{Column, paragraphs, text_table};
use crate::work_precision::{
    BUDGETS, FLOOR_SUBSTEPS, Point, Row, TARGETS, error_at, least_gain, time_to, totals,
};
use incise_reference::{ReferenceError, State};
use std::io::{self, Write};

/// Explains the columns of a scene.
const LEGEND: &str = "\
steps: substeps per frame x iterations per substep. proj: projections per frame. ms: median time \
of a frame. solver: position error to converged steps of the same size. total: position error to \
the limit of small steps. Both are root mean squares over vertices and frames, over the mean rest \
length. force, strain, volume, energy, sag: total errors of the pin force, of the root mean square \
strain, of the enclosed volume, of the energy at the end per second over the largest kinetic \
energy, and of the largest sag. ~: less than ten times the uncertainty of the reference. -: no \
reference of that many substeps, no pins, no closed surface.";

/// Explains the columns of GPU runs.
const ON_GPU: &str = "
device: time of a frame by GPU timestamps, in one run of several. encode: the part of ms before \
submission. -: the GPU has no timestamps.";

/// Explains the columns of the summary.
const SUMMARY: &str = "\
ms to E: shortest time of a frame with a total error of at most E. at T ms: smallest total error \
of frames of at most T ms. First all schemes but pbd and patches, then the paper's: pbd, one \
substep. gain: \
ratio of the second error to the first in the same time, the smallest at 1, 4, 8 and 16 ms; empty \
where one has no run that fast.";

/// Prints a scene and its reference.
pub(super) fn reference(
    out: &mut impl Write,
    scene: &Scene,
    body: &Body,
    convergence: &Convergence,
    exact: Result<&Exact, &ReferenceError>,
) -> io::Result<()> {
    let topology = body.surface.topology();
    writeln!(
        out,
        "\n{}: {} triangles, {} vertices, {} pinned, {} frames; reference in {:.1} s",
        scene.name,
        topology.triangle_count(),
        topology.vertex_count(),
        body.solver.pins().len(),
        scene.frames,
        convergence.seconds
    )?;
    match exact {
        Ok(exact) => {
            writeln!(out, "  uncertainty: {:.1e}", exact.uncertainty)?;
            let floors = FLOOR_SUBSTEPS.map(|n| {
                let floor = convergence.floor(exact, n);
                format!("{} with {n}", exponent(floor))
            });
            let floors = floors.join(", ");
            writeln!(out, "  floor, of converged second-order substeps: {floors}")?;
            let start = State::of(&body.solver, &body.surface);
            let measure = ErrorMeasure {
                model: &convergence.model,
                triangles: &[],
                start: &start,
                is_held: !scene.pins.is_empty(),
            };
            if let Some(way) = measure.sag(&exact.states) {
                writeln!(out, "  sag: {way:.5} m")?;
            }
        }
        Err(error) => writeln!(out, "  no total errors: {error}")?,
    }
    Ok(())
}

/// Prints the Pareto fronts of a scene.
pub(super) fn scene(out: &mut impl Write, rows: &[Row]) -> io::Result<()> {
    let all = backends(rows);
    for backend in &all {
        scene_on(out, rows, backend)?;
    }
    write!(out, "{}", paragraphs(LEGEND))?;
    if all.contains(&"gpu") {
        write!(out, "{}", paragraphs(ON_GPU))?;
    }
    for row in rows {
        if let Some(refusal) = &row.refusal {
            let (scheme, substeps, iterations) = (&row.scheme, row.substeps, row.iterations);
            writeln!(out, "  {scheme} {substeps} x {iterations}: {refusal}")?;
        }
    }
    Ok(())
}

/// Returns the backends of rows.
pub(super) fn backends(rows: &[Row]) -> Vec<&str> {
    let mut names: Vec<&str> = rows.iter().map(|row| row.backend.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    names
}

/// Columns of a front.
const COLUMNS: &[Column<Row>] = &[
    ("scheme", |row| row.scheme.clone()),
    ("steps", |row| {
        format!("{}x{}", row.substeps, row.iterations)
    }),
    ("proj", |row| row.projections_per_frame.to_string()),
    ("ms", |row| fixed(row.ms_per_frame, 3)),
    ("device", |row| fixed(row.ms_device, 3)),
    ("encode", |row| fixed(row.ms_encode, 3)),
    ("solver", |row| exponent(row.solver_position)),
    ("total", |row| {
        let limit = row.uncertainty.map_or(f64::INFINITY, |u| 10.0 * u);
        let is_certain = row.total_position.is_some_and(|error| error > limit);
        let mark = if is_certain { "" } else { "~" };
        format!("{mark}{}", exponent(row.total_position))
    }),
    ("force", |row| exponent(row.total_force)),
    ("strain", |row| exponent(row.total_strain)),
    ("volume", |row| exponent(row.total_volume)),
    ("energy", |row| exponent(row.total_energy)),
    ("sag", |row| exponent(row.total_sag)),
];

/// Prints the front of a scene on one backend.
fn scene_on(out: &mut impl Write, rows: &[Row], backend: &str) -> io::Result<()> {
    let rows = || rows.iter().filter(move |row| row.backend == backend);
    writeln!(out, "{backend}, Pareto front of {} runs:", rows().count())?;
    let best = totals(rows()).into_iter().filter_map(|[time, error]| {
        rows().find(|row| row.ms_per_frame == time && row.total_position == Some(error))
    });
    write!(out, "{}", text_table(COLUMNS, &best.collect::<Vec<_>>()))
}

/// A front of the summary.
struct Front {
    name: String,
    points: Vec<Point>,
    gain: Option<f64>,
}

/// Columns of the summary; the numbers are those of [`TARGETS`] and [`BUDGETS`].
const SUMMARY_COLUMNS: &[Column<Front>] = &[
    ("scene", |front| front.name.clone()),
    ("ms to 1e-1", |front| {
        fixed(time_to(&front.points, TARGETS[0]), 2)
    }),
    ("ms to 1e-2", |front| {
        fixed(time_to(&front.points, TARGETS[1]), 2)
    }),
    ("ms to 1e-3", |front| {
        fixed(time_to(&front.points, TARGETS[2]), 2)
    }),
    ("ms to 1e-4", |front| {
        fixed(time_to(&front.points, TARGETS[3]), 2)
    }),
    ("at 1 ms", |front| {
        exponent(error_at(&front.points, BUDGETS[0]))
    }),
    ("at 4 ms", |front| {
        exponent(error_at(&front.points, BUDGETS[1]))
    }),
    ("at 8 ms", |front| {
        exponent(error_at(&front.points, BUDGETS[2]))
    }),
    ("at 16 ms", |front| {
        exponent(error_at(&front.points, BUDGETS[3]))
    }),
    ("gain", |front| {
        front.gain.map_or_else(String::new, |gain| fixed(gain, 1))
    }),
];

/// Prints time to an error and error within a time, for all scenes.
pub(super) fn summary(out: &mut impl Write, rows: &[Row]) -> io::Result<()> {
    let mut fronts = Vec::new();
    let all = backends(rows);
    let both = (scenes::NAMES.into_iter()).flat_map(|name| all.iter().map(move |b| (name, *b)));
    for (name, backend) in both {
        let is = move |row: &&Row| row.scene == name && row.backend == backend;
        let rows = || rows.iter().filter(is);
        if rows().next().is_none() {
            continue;
        }
        let ours = totals(rows().filter(|row| row.is_ours()));
        let paper = totals(rows().filter(|row| row.is_paper()));
        fronts.push(Front {
            name: format!("{name}, {backend}"),
            gain: least_gain(&ours, &paper),
            points: ours,
        });
        fronts.push(Front {
            name: "  the paper's".to_owned(),
            points: paper,
            gain: None,
        });
    }
    writeln!(out)?;
    write!(out, "{}", text_table(SUMMARY_COLUMNS, &fronts))?;
    write!(out, "{}", paragraphs(SUMMARY))
}
