//! `incise-bench table`: the paper's Table 1 and Figure 11 on seven models.

pub(crate) mod paper;
mod protocol;
pub(crate) mod row;

use crate::backend::BackendChoice as BackendArgument;
use crate::json::Json;
use crate::method::MethodArguments;
use crate::numbers::fixed;
use crate::options::{AdapterArguments, ModelArguments, OutputArguments, positive};
use crate::text_table::{paragraphs, text_table};
use crate::{machine, models};
use clap::Args;
use incise_scene::{BackendChoice, BackendRequest, Scene, SceneError};
use protocol::{frames, params, run as run_protocol};
use row::Row;
use std::error::Error;
use std::io::Write;

/// Runs the paper's protocol on seven models.
#[derive(Args, Clone)]
pub(crate) struct TableArguments {
    #[command(flatten)]
    from: ModelArguments,
    /// Backend of the solver.
    #[arg(long, value_enum, default_value_t = BackendArgument::Cpu)]
    backend: BackendArgument,
    #[command(flatten)]
    gpu: AdapterArguments,
    /// Simulated seconds per run.
    #[arg(long, default_value_t = 15.0, value_parser = positive)]
    seconds: f64,
    /// Length of a frame in seconds, as a number or a fraction.
    #[arg(long, default_value = "1/60", value_parser = positive)]
    dt: f64,
    /// Solver iterations per frame.
    #[arg(long, default_value_t = 10, value_parser = clap::value_parser!(u32).range(1..))]
    iterations: u32,
    #[command(flatten)]
    caps: MethodArguments,
    /// Add volume constraints; the paper's bodies have none.
    #[arg(long)]
    pub(crate) volume: bool,
    /// Add interior springs, one per vertex; the paper's bodies have none.
    #[arg(long)]
    pub(crate) interior_springs: bool,
    /// Resolve contacts between pieces; the paper's pieces pass through each other.
    #[arg(long)]
    pub(crate) contacts: bool,
    /// Models to run, separated by commas.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    only: Vec<String>,
    /// Seed of the directions of slices.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    pub(crate) rows: OutputArguments,
}

/// Runs the protocol on all models, prints and writes the rows.
pub(crate) fn run(arguments: &TableArguments, out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    if frames(arguments) == 0 {
        return Err("the simulated time is shorter than half a frame: raise --seconds".into());
    }
    let loaded = models::load(arguments.from.models.as_deref(), &arguments.only)?;
    let used = loaded.iter().map(|l| (l.model.name(), l.source.as_str()));
    models::warn_built_in(arguments.from.models.as_deref(), used);
    let (machine, commit) = (machine::machine(), machine::commit());
    let (request, fallback) = backend(arguments)?;
    let mut json = Json::open(arguments.rows.json.as_deref())?;
    let progress = (arguments.rows).progress(loaded.len(), 2 * u64::from(frames(arguments)));
    let mut rows = Vec::new();
    for model in &loaded {
        progress.begin(model.model.name());
        let tick = || progress.step();
        rows.push(run_protocol(
            model, arguments, &request, &machine, &commit, &tick,
        )?);
    }
    progress.end();
    write!(out, "{}", text_table(row::COLUMNS, &rows))?;
    writeln!(
        out,
        "\n{machine}, commit {commit}; {} s at dt {:.6} s, {} iterations, method {}, level {}, \
         grading {}, seed {}{}",
        arguments.seconds,
        arguments.dt,
        arguments.iterations,
        arguments.caps.method.name(),
        arguments.caps.level,
        arguments.caps.grading,
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
    let on_device: Vec<&Row> = (rows.iter().filter(|row| row.schedule.is_some())).collect();
    if !on_device.is_empty() {
        write!(out, "{}", paragraphs(DEVICE_LEGEND))?;
    }
    for row in on_device {
        writeln!(
            out,
            "{} on {}, schedule {}; a cut sends {} KiB and reads {} KiB.",
            row.model,
            row.device,
            row.schedule.as_deref().unwrap_or_default(),
            kibibytes(row.bytes_uploaded_a_cut),
            kibibytes(row.bytes_read_a_cut)
        )?;
    }
    let allocations: usize = rows.iter().map(|row| row.allocations).sum();
    writeln!(
        out,
        "Heap allocations in all frames without a cut: {allocations}."
    )?;
    for row in &rows {
        for reason in &row.cuts_refused {
            writeln!(out, "Refused cut of {}: {reason}.", row.model)?;
        }
    }
    Ok(json.write(&rows)?)
}

const LEGEND: &str = "\
Frames per second of the solver alone (PBD), and with a moving blade that slices the largest piece \
once a second (PBD+CS). cut ms: detection, topology, refinement and update of constraints. paper: \
the paper's number; x: ratio to it, above 1 where incise is better. stretch %: mean over frames, \
edges weighted by length. volume %: rest volume lost in all cuts together. cap angle: the smallest \
angle of all cap triangles.";

const BEYOND_LEGEND: &str = "\
--volume, --interior-springs and --contacts add constraints that the paper's bodies lack, so a \
frame does more work than the paper's.";

const DEVICE_LEGEND: &str = "\
On a GPU a frame ends when the GPU is done. The first frame, which compiles kernels, is not timed. \
Sweeps that miss the body's box are skipped. The time of a cut includes readback and upload. \
Stretch errors are sampled once a second. Heap allocations include those of the driver.";

/// Names the enabled options that the paper's bodies lack.
fn beyond(arguments: &TableArguments) -> String {
    let all = [
        (arguments.volume, ", with volumes"),
        (arguments.interior_springs, ", with interior springs"),
        (arguments.contacts, ", with contacts"),
    ];
    all.iter()
        .filter(|(is_on, _)| *is_on)
        .map(|&(_, text)| text)
        .collect()
}

/// Returns the backend of all runs, and the reason for a fallback to the CPU. `auto` is calibrated
/// once, so that all runs use the same backend.
fn backend(arguments: &TableArguments) -> Result<(BackendRequest, Option<String>), SceneError> {
    let mut request = BackendRequest {
        choice: arguments.backend.into(),
        adapter: arguments.gpu.adapter.clone(),
        allow_software: true,
        min_gpu_constraints: None,
    };
    let report = Scene::with_backend(params(arguments), &request)?.backend_report();
    request.min_gpu_constraints = report.min_gpu_constraints;
    if report.adapter.is_none() {
        request.choice = BackendChoice::Cpu;
    }
    let why = report.fallback_reason.map(|reason| reason.to_string());
    Ok((request, why))
}

fn kibibytes(bytes: Option<f64>) -> String {
    fixed(bytes.map(|bytes| bytes / 1024.0), 1)
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
    fn a_table_names_its_additions_to_the_paper() {
        let place = tempfile::tempdir().unwrap();
        let all = [
            ("--volume", "volume", "with volumes"),
            (
                "--interior-springs",
                "interior_springs",
                "with interior springs",
            ),
            ("--contacts", "contacts", "with contacts"),
        ];
        for asked in [0, 1, 3] {
            let path = place.path().join(format!("{asked}.json"));
            let file = path.display().to_string();
            let line = [
                "b",
                "--only",
                "Sphere80",
                "--seconds",
                "1.1",
                "--grading",
                "0.5",
            ];
            let mut words = line.to_vec();
            words.extend(["--json", &file]);
            words.extend(all[..asked].iter().map(|of| of.0));
            let mut out = Vec::new();
            run(&Line::parse_from(words).table, &mut out).unwrap();
            let told = String::from_utf8(out).unwrap();
            let rows = std::fs::read_to_string(&path).unwrap();
            let rows: serde_json::Value = serde_json::from_str(&rows).unwrap();
            assert_eq!(rows[0]["cuts"], 1, "{rows}");
            assert_eq!(rows[0]["grading"], 0.5, "{rows}");
            for (i, (_, name, text)) in all.into_iter().enumerate() {
                assert_eq!(told.contains(text), i < asked, "{told}");
                assert_eq!(rows[0][name], i < asked, "{rows}");
            }
        }
    }
}
