//! The table for people and for programs.

use crate::protocol::{Row, frames, run as run_protocol};
use crate::{TableArguments, machine, models, paper};
use incise_mesh::Model;
use indicatif::{ProgressBar, ProgressStyle};
use std::error::Error;
use std::io::Write;

/// Runs the table and prints it.
pub(crate) fn run(arguments: &TableArguments, out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    if frames(arguments) == 0 {
        return Err("the simulated time is shorter than half a frame: raise --seconds".into());
    }
    let loaded = models::load(arguments.models.as_deref(), &arguments.only)?;
    let (machine, commit) = (machine::machine(), machine::commit());
    // Hidden by itself when the error output is no terminal.
    let bar = ProgressBar::new(2 * u64::from(frames(arguments)) * loaded.len() as u64).with_style(
        ProgressStyle::with_template("{msg:12} {wide_bar} {percent}% {eta}")?,
    );
    let mut rows = Vec::new();
    for model in &loaded {
        bar.set_message(model.model.name());
        let tick = || bar.inc(1);
        rows.push((
            model.model,
            run_protocol(model, arguments, &machine, &commit, &tick)?,
        ));
    }
    bar.finish_and_clear();
    write!(out, "{}", table(&rows))?;
    writeln!(
        out,
        "\n{machine}, commit {commit}; {} s at dt {:.6} s, {} iterations, level {}, seed {}",
        arguments.seconds, arguments.dt, arguments.iterations, arguments.level, arguments.seed
    )?;
    writeln!(out, "{LEGEND}")?;
    let allocations: usize = rows.iter().map(|(_, row)| row.allocations).sum();
    writeln!(
        out,
        "Heap allocations in all frames without a cut: {allocations}."
    )?;
    for (_, row) in &rows {
        for reason in &row.cuts_refused {
            writeln!(out, "Refused cut of {}: {reason}.", row.model)?;
        }
    }
    if let Some(path) = &arguments.json {
        let rows: Vec<&Row> = rows.iter().map(|(_, row)| row).collect();
        let mut text = serde_json::to_string_pretty(&rows)?;
        text.push('\n');
        std::fs::write(path, text).map_err(|error| format!("{}: {error}", path.display()))?;
    }
    Ok(())
}

const LEGEND: &str = "\
Frames a second of the solver alone (PBD) and with a moving blade that slices the largest piece once a
second (PBD + CS); time of a cut is detection, topology, refinement and constraint update. Each is followed
by the paper's number and by how many times better this one is. Stretch error: mean over frames, edges weighted by length.
Volume lost: by all cuts together, of the body at rest. Cap angle: the smallest of all cap triangles.";

const HEADER: [&str; 21] = [
    "model",
    "source",
    "vertices",
    "particles",
    "triangles",
    "PBD FPS",
    "paper",
    "x",
    "PBD+CS FPS",
    "paper",
    "x",
    "diff %",
    "paper",
    "x",
    "cut ms",
    "paper",
    "x",
    "p99 ms",
    "stretch %",
    "volume %",
    "cap angle",
];

fn table(rows: &[(Model, Row)]) -> String {
    let mut cells = vec![HEADER.map(str::to_owned)];
    cells.extend(rows.iter().map(|(model, row)| line(*model, row)));
    let widths: Vec<usize> = (0..HEADER.len())
        .map(|k| cells.iter().map(|line| line[k].len()).max().unwrap_or(0))
        .collect();
    let mut text = String::new();
    for line in &cells {
        let padded: Vec<String> = line
            .iter()
            .zip(&widths)
            .enumerate()
            .map(|(k, (cell, &width))| {
                if k < 2 {
                    format!("{cell:width$}")
                } else {
                    format!("{cell:>width$}")
                }
            })
            .collect();
        text.push_str(padded.join("  ").trim_end());
        text.push('\n');
    }
    text
}

fn line(model: Model, row: &Row) -> [String; 21] {
    let paper = paper::row(model);
    let times = |x: f64| {
        if !x.is_finite() || x < 0.0 {
            "-".to_owned()
        } else if x < 10.0 {
            format!("{x:.1}")
        } else {
            format!("{x:.0}")
        }
    };
    [
        row.model.to_owned(),
        row.source.clone(),
        row.vertices.to_string(),
        row.particles.to_string(),
        row.triangles.to_string(),
        format!("{:.1}", row.pbd_fps),
        paper.pbd_fps.to_string(),
        times(row.pbd_fps / paper.pbd_fps),
        format!("{:.1}", row.pbd_cs_fps),
        paper.pbd_cs_fps.to_string(),
        times(row.pbd_cs_fps / paper.pbd_cs_fps),
        format!("{:.1}", row.fps_difference_percent),
        paper.difference_percent.to_string(),
        times(paper.difference_percent / row.fps_difference_percent),
        measured(row.cut_ms_mean, 3),
        paper.cut_ms.to_string(),
        times(paper.cut_ms / row.cut_ms_mean),
        measured(row.cut_ms_p99, 3),
        format!("{:.3}", row.stretch_error_percent),
        format!("{:.2}", row.volume_error_percent),
        measured(row.cap_min_angle_deg, 1),
    ]
}

/// A number, or a dash for what a run without a cut cannot tell.
fn measured(x: f64, digits: usize) -> String {
    if x.is_finite() {
        format!("{x:.digits$}")
    } else {
        "-".to_owned()
    }
}
