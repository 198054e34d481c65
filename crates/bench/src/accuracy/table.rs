//! What people read.

use super::front::{BUDGETS, Point, TARGETS, error_at, least_gain, time_to, totals};
use super::ladder::{Exact, Ladder};
use super::row::Row;
use super::scene::{Body, Scene};
use super::scenes;
use crate::columns::columns;
use incise_bench::ReferenceError;
use std::error::Error;
use std::io::Write;

/// A line on a scene and on what it is measured against.
pub(super) fn reference(
    out: &mut impl Write,
    scene: &Scene,
    body: &Body,
    ladder: &Ladder,
    exact: Result<&Exact, &ReferenceError>,
) -> Result<(), Box<dyn Error>> {
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
        Ok(exact) => writeln!(out, "  its own uncertainty: {:.1e}", exact.uncertainty)?,
        Err(error) => writeln!(out, "  no total errors: {error}")?,
    }
    Ok(())
}

/// The fronts of a scene.
pub(super) fn scene(out: &mut impl Write, rows: &[Row]) -> Result<(), Box<dyn Error>> {
    for backend in backends(rows) {
        scene_on(out, rows, backend)?;
    }
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
fn scene_on(out: &mut impl Write, rows: &[Row], backend: &str) -> Result<(), Box<dyn Error>> {
    let rows = || rows.iter().filter(move |row| row.backend == backend);
    let best = totals(rows());
    let header = [
        "  backend",
        "scheme",
        "substeps",
        "iterations",
        "ms",
        "left",
        "solver",
        "total",
        "force",
        "strain",
        "volume",
        "energy",
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
        cells.push([
            format!("  {}", row.backend),
            row.scheme.to_owned(),
            row.substeps.to_string(),
            row.iterations.to_string(),
            format!("{time:.3}"),
            brief(row.residuals.map(|r| r.decrement)),
            brief(row.solver_error.map(|e| e.position)),
            format!("{}{error:.1e}", if known { "" } else { "~" }),
            brief(total.force),
            brief(Some(total.strain)),
            brief(total.volume),
            brief(Some(total.energy)),
        ]);
    }
    write!(out, "{}", columns(&cells, 2))?;
    Ok(())
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
    writeln!(
        out,
        "gain: how many times nearer than the paper's scheme (one substep, pbd) is in the same time, at the least of \
         1, 4, 8 and 16 ms."
    )?;
    Ok(())
}

fn brief(value: Option<f64>) -> String {
    value.map_or_else(|| "-".to_owned(), |x| format!("{x:.1e}"))
}
