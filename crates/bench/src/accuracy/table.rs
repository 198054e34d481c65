//! What people read.

use super::error::Yardstick;
use super::front::{BUDGETS, TARGETS, error_at, least_gain, time_to, totals};
use super::ladder::{Exact, Ladder};
use super::row::Row;
use super::scene::{Body, Scene};
use super::scenes;
use crate::columns::{columns, paragraphs};
use crate::front::Point;
use incise_bench::{ReferenceError, State};
use std::error::Error;
use std::io::{self, Write};

/// What stands in the columns of a scene.
const LEGEND: &str = "\
Runs that no other one is both faster and nearer than. steps: substeps a frame x iterations a substep. proj: projections a frame. \
ms: median time of a frame. solver: positions off those of converged steps of the same size, which the solver's \
iterations are to reach; total: off those that ever smaller steps tend to. Both are root mean squares over vertices and frames, over \
the mean rest length. force, strain, volume, energy, sag: totals too: of the force that holds the body, over it; of the root mean \
square strain; of the enclosed volume, over it; of the energy at the end, a second, over the largest kinetic one; sag: of how far the lowest vertex comes \
down in any frame, over that way. \
~: less than ten times what the reference itself may be off by, and so hardly known. -: there is none: no reference of that many \
substeps, nothing held, no closed surface.";

/// What stands in those that only the processor has.
const ON_CPU: &str = "
left: Newton's decrement at the end of one substep, over that of its prediction: 0 is solved. dual: the same of \
C + alpha lambda, which XPBD's iterations make small; stiffnesses of pbd have none.";

/// What stands in those that only devices have.
const ON_GPU: &str = "
device: what a frame took by the device's own clock, in one run of several; encode: the part of ms until the device was \
told what to do. -: it has no clock.";

/// What stands in the columns of all scenes.
const SUMMARY: &str = "\
ms to E: the least time of a frame with a total error of at most E; -: no run came so near. at T ms: the least total error of \
frames of at most T ms; -: no run was so fast. First all schemes but pbd, then the paper's: pbd, one substep. gain: how many times nearer \
the first are in the same time, at the least of 1, 4, 8 and 16 ms; nothing where one has no run that is so fast.";

/// A line on a scene and on what it is measured against.
pub(super) fn reference(
    out: &mut impl Write,
    scene: &Scene,
    body: &Body,
    ladder: &Ladder,
    exact: Result<&Exact, &ReferenceError>,
) -> io::Result<()> {
    let topology = body.surface.topology();
    writeln!(
        out,
        "\n{}: {} triangles, {} vertices, {} held, {} frames; reference in {:.1} s",
        scene.name,
        topology.triangle_count(),
        topology.vertex_count(),
        body.solver.pins().len(),
        scene.frames,
        ladder.seconds
    )?;
    match exact {
        Ok(exact) => {
            writeln!(out, "  its own uncertainty: {:.1e}", exact.uncertainty)?;
            let start = State::of(&body.solver, &body.surface);
            let yardstick = Yardstick {
                model: &ladder.model,
                triangles: &[],
                start: &start,
                is_held: !scene.pins.is_empty(),
            };
            if let Some(way) = yardstick.sag(&exact.states) {
                writeln!(out, "  its lowest vertex comes down by {way:.5} m")?;
            }
        }
        Err(error) => writeln!(out, "  no total errors: {error}")?,
    }
    Ok(())
}

/// The fronts of a scene.
pub(super) fn scene(out: &mut impl Write, rows: &[Row]) -> io::Result<()> {
    let mut legend = LEGEND.to_owned();
    for backend in backends(rows) {
        scene_on(out, rows, backend)?;
        legend += if backend == "cpu" { ON_CPU } else { ON_GPU };
    }
    write!(out, "{}", paragraphs(&legend))?;
    for row in rows {
        if let Some(refusal) = &row.refusal {
            let (scheme, substeps, iterations) = (row.scheme, row.substeps, row.iterations);
            writeln!(out, "  {scheme} {substeps} x {iterations}: {refusal}")?;
        }
    }
    Ok(())
}

/// The backends that rows are of.
fn backends(rows: &[Row]) -> Vec<&'static str> {
    let mut names: Vec<&str> = rows.iter().map(|row| row.backend).collect();
    names.dedup();
    names.sort_unstable();
    names.dedup();
    names
}

/// The front of a scene on one backend.
fn scene_on(out: &mut impl Write, rows: &[Row], backend: &str) -> io::Result<()> {
    let is_gpu = backend == "gpu";
    let rows = || rows.iter().filter(move |row| row.backend == backend);
    let best = totals(rows());
    writeln!(out, "  {backend}, the front of {} runs:", rows().count())?;
    let header = [
        "  scheme",
        "steps",
        "proj",
        "ms",
        if is_gpu { "device" } else { "left" },
        if is_gpu { "encode" } else { "dual" },
        "solver",
        "total",
        "force",
        "strain",
        "volume",
        "energy",
        "sag",
    ];
    let mut cells = vec![header.map(str::to_owned)];
    for [time, error] in best {
        let is = |row: &&Row| row.ms_per_frame == time && row.total() == Some(error);
        let Some(row) = rows().find(is) else {
            continue;
        };
        let Some(total) = row.total_error else {
            continue;
        };
        let known = row.uncertainty.is_some_and(|u| 10.0 * u < error);
        let ms = |ms: Option<f64>| ms.map_or("-".to_owned(), |ms| format!("{ms:.3}"));
        let beside = if is_gpu {
            [ms(row.ms_device), ms(row.ms_encode)]
        } else {
            let left = row.residuals;
            [
                left.map(|l| l.residuals.decrement),
                left.and_then(|l| l.dual),
            ]
            .map(brief)
        };
        let [fifth, sixth] = beside;
        cells.push([
            format!("  {}", row.scheme),
            format!("{}x{}", row.substeps, row.iterations),
            row.projections_per_frame.to_string(),
            format!("{time:.3}"),
            fifth,
            sixth,
            brief(row.solver_error.map(|e| e.position)),
            format!("{}{error:.1e}", if known { "" } else { "~" }),
            brief(total.force),
            brief(Some(total.strain)),
            brief(total.volume),
            brief(Some(total.energy)),
            brief(total.sag),
        ]);
    }
    write!(out, "{}", columns(&cells, 2))
}

/// Time to an error and error in a time, of all scenes.
pub(super) fn summary(out: &mut impl Write, rows: &[Row]) -> Result<(), Box<dyn Error>> {
    let mut cells = vec![
        std::iter::once(String::new())
            .chain(TARGETS.map(|e| format!("ms to {e:.0e}")))
            .chain(BUDGETS.map(|ms| format!("at {ms} ms")))
            .chain(["gain".to_owned()])
            .collect::<Vec<_>>(),
    ];
    let all = backends(rows);
    let both = (scenes::NAMES.into_iter()).flat_map(|name| all.iter().map(move |b| (name, *b)));
    for (name, backend) in both {
        let is = move |row: &&Row| row.scene == name && row.backend == backend;
        let rows = || rows.iter().filter(is);
        if rows().next().is_none() {
            continue;
        }
        let ours = totals(rows().filter(|row| row.scheme != "pbd"));
        let paper = totals(rows().filter(|row| row.is_paper()));
        let line = |label: String, front: &[Point], gain: Option<f64>| {
            std::iter::once(label)
                .chain(
                    TARGETS
                        .map(|e| time_to(front, e).map_or("-".to_owned(), |t| format!("{t:.2}"))),
                )
                .chain(BUDGETS.map(|ms| brief(error_at(front, ms))))
                .chain([gain.map_or(String::new(), |gain| format!("{gain:.1}"))])
                .collect()
        };
        cells.push(line(
            format!("{name}, {backend}"),
            &ours,
            least_gain(&ours, &paper),
        ));
        cells.push(line("  the paper's".to_owned(), &paper, None));
    }
    let cells: Vec<[String; 10]> = cells
        .into_iter()
        .filter_map(|line| line.try_into().ok())
        .collect();
    writeln!(out)?;
    write!(out, "{}", columns(&cells, 1))?;
    write!(out, "{}", paragraphs(SUMMARY))?;
    Ok(())
}

fn brief(value: Option<f64>) -> String {
    value.map_or_else(|| "-".to_owned(), |x| format!("{x:.1e}"))
}
