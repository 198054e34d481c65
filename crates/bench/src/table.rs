//! The paper's table, for people and for programs.

pub(crate) mod paper;
mod protocol;
mod row;

use crate::backend::BackendChoice as BackendArgument;
use crate::columns::{folded, measured, paragraphs};
use crate::json::Json;
use crate::method::MethodChoice;
use crate::options::{AdapterArguments, ModelArguments, OutputArguments, positive};
use crate::{machine, models};
use clap::Args;
use incise_mesh::Model;
use incise_refine::RefinementLevel;
use incise_scene::{BackendChoice, BackendRequest, Scene, SceneError};
use protocol::{frames, params, run as run_protocol};
use row::Row;
use std::error::Error;
use std::io::Write;

/// What the table is made of.
#[derive(Args, Clone)]
pub(crate) struct TableArguments {
    #[command(flatten)]
    from: ModelArguments,
    /// What executes the solver.
    #[arg(long, value_enum, default_value_t = BackendArgument::Cpu)]
    backend: BackendArgument,
    #[command(flatten)]
    gpu: AdapterArguments,
    /// Simulated seconds of each run.
    #[arg(long, default_value_t = 15.0, value_parser = positive)]
    seconds: f64,
    /// Seconds of a frame, as a number or a fraction.
    #[arg(long, default_value = "1/60", value_parser = positive)]
    dt: f64,
    /// Iterations of the solver a frame.
    #[arg(long, default_value_t = 10, value_parser = clap::value_parser!(u32).range(1..))]
    iterations: u32,
    /// Refinement level of the caps: one of the five names, or z.
    #[arg(long, default_value = "1")]
    level: RefinementLevel,
    /// How surfaces are opened.
    #[arg(long, value_enum, default_value_t = MethodChoice::Exact)]
    method: MethodChoice,
    /// Every closed piece keeps the volume that it has at rest, which the paper's bodies do not.
    #[arg(long)]
    pub(crate) volume: bool,
    /// Struts hold the sides of bodies apart, one a vertex.
    #[arg(long)]
    pub(crate) struts: bool,
    /// Pieces touch each other instead of passing through each other.
    #[arg(long)]
    pub(crate) contacts: bool,
    /// Models to run, separated by commas.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    only: Vec<String>,
    /// Where the directions of the slices start.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    pub(crate) rows: OutputArguments,
}

/// Runs the table and prints it.
pub(crate) fn run(arguments: &TableArguments, out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    if frames(arguments) == 0 {
        return Err("the simulated time is shorter than half a frame: raise --seconds".into());
    }
    let loaded = models::load(arguments.from.models.as_deref(), &arguments.only)?;
    let used = loaded.iter().map(|l| (l.model.name(), l.source.as_str()));
    models::tell_built_in(arguments.from.models.as_deref(), used);
    let (machine, commit) = (machine::machine(), machine::commit());
    let (request, fallback) = backend(arguments)?;
    let mut json = Json::open(arguments.rows.json.as_deref())?;
    let progress = (arguments.rows).progress(loaded.len(), 2 * u64::from(frames(arguments)));
    let mut rows = Vec::new();
    for model in &loaded {
        progress.begin(model.model.name());
        let tick = || progress.step();
        rows.push((
            model.model,
            run_protocol(model, arguments, &request, &machine, &commit, &tick)?,
        ));
    }
    progress.end();
    write!(out, "{}", table(&rows))?;
    writeln!(
        out,
        "\n{machine}, commit {commit}; {} s at dt {:.6} s, {} iterations, method {}, level {}, seed {}{}",
        arguments.seconds,
        arguments.dt,
        arguments.iterations,
        arguments.method.name(),
        arguments.level,
        arguments.seed,
        beyond(arguments)
    )?;
    write!(out, "{}", paragraphs(LEGEND))?;
    if !beyond(arguments).is_empty() {
        write!(out, "{}", paragraphs(BEYOND_LEGEND))?;
    }
    if let Some(why) = fallback {
        writeln!(out, "All on the CPU: {why}.")?;
    }
    let on_device: Vec<&Row> = (rows.iter().map(|(_, row)| row))
        .filter(|row| row.schedule.is_some())
        .collect();
    if !on_device.is_empty() {
        write!(out, "{}", paragraphs(DEVICE_LEGEND))?;
    }
    for row in on_device {
        writeln!(
            out,
            "{} on {}, schedule {}; a cut sends {} KiB and reads {} KiB.",
            row.model,
            row.device,
            row.schedule.unwrap_or_default(),
            kibibytes(row.bytes_uploaded_a_cut),
            kibibytes(row.bytes_read_a_cut)
        )?;
    }
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
    let rows: Vec<&Row> = rows.iter().map(|(_, row)| row).collect();
    Ok(json.write(&rows)?)
}

const LEGEND: &str = "\
Frames a second of the solver alone (PBD) and with a moving blade that slices the largest piece once a \
second (PBD + CS); time of a cut is detection, topology, refinement and constraint update. Each is followed \
by the paper's number and by how many times better this one is. Stretch error: mean over frames, edges weighted by length. \
Volume lost: by all cuts together, of the body at rest. Cap angle: the smallest of all cap triangles.";

const BEYOND_LEGEND: &str = "\
Every closed piece keeps the volume that it has at rest (--volume), struts hold its sides apart (--struts), pieces touch each other \
(--contacts): what was asked for of that the paper's bodies do not, and the numbers beside the paper's are of more work a frame.";

const DEVICE_LEGEND: &str = "\
On a device a frame ends when the device is done with it; the first, in which kernels are compiled, is left out. Sweeps that miss the \
device's box of the body are skipped there. The time of a cut runs from the readback to the update of the device. Stretch error: once a second. \
Heap allocations are those of the device's interface too.";

/// What the table has that the paper's has not, for the line that says how it was made.
fn beyond(arguments: &TableArguments) -> String {
    let all = [
        (arguments.volume, ", volumes kept"),
        (arguments.struts, ", with struts"),
        (arguments.contacts, ", pieces touching"),
    ];
    all.iter()
        .filter(|(is_on, _)| *is_on)
        .map(|&(_, text)| text)
        .collect()
}

/// The backend of all runs, and why it is the CPU if another was asked for. What `auto` measures is
/// measured once, so that all runs are on the same backend.
fn backend(arguments: &TableArguments) -> Result<(BackendRequest, Option<String>), SceneError> {
    let mut request = BackendRequest {
        choice: arguments.backend.into(),
        adapter: arguments.gpu.adapter.clone(),
        allow_software: true,
        device_from: None,
    };
    let report = Scene::with_backend(params(arguments), &request)?.backend_report();
    request.device_from = report.device_from;
    if report.device.is_none() {
        request.choice = BackendChoice::Cpu;
    }
    Ok((request, report.fallback))
}

fn kibibytes(bytes: Option<f64>) -> String {
    measured(bytes.unwrap_or(f64::NAN) / 1024.0, 1)
}

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
    folded(&cells, 2)
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

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[derive(Parser)]
    struct Line {
        #[command(flatten)]
        table: TableArguments,
    }

    #[test]
    fn a_table_says_what_the_paper_has_not() {
        let place = tempfile::tempdir().unwrap();
        let all = [
            ("--volume", "volume", "volumes kept"),
            ("--struts", "struts", "with struts"),
            ("--contacts", "contacts", "pieces touching"),
        ];
        for asked in [0, 1, 3] {
            let path = place.path().join(format!("{asked}.json"));
            let file = path.display().to_string();
            let line = ["b", "--only", "Sphere80", "--seconds", "1.1", "--json"];
            let mut words = line.to_vec();
            words.push(&file);
            words.extend(all[..asked].iter().map(|of| of.0));
            let mut out = Vec::new();
            run(&Line::parse_from(words).table, &mut out).unwrap();
            let told = String::from_utf8(out).unwrap();
            let rows = std::fs::read_to_string(&path).unwrap();
            let rows: serde_json::Value = serde_json::from_str(&rows).unwrap();
            assert_eq!(rows[0]["cuts"], 1, "{rows}");
            for (i, (_, name, text)) in all.into_iter().enumerate() {
                assert_eq!(told.contains(text), i < asked, "{told}");
                assert_eq!(rows[0][name], i < asked, "{rows}");
            }
        }
    }
}
