//! What a scene does not need, and that it costs nothing: sleeping bodies, features that are absent, blades that cut nothing,
//! iterations that move nothing, a device that nobody asks. And what it costs to keep volumes.

mod bare;
mod blades;
mod clock;
#[cfg(feature = "gpu")]
mod device;
#[cfg(not(feature = "gpu"))]
#[path = "skip/no_device.rs"]
mod device;
mod drivers;
mod early;
mod inside;
mod minimal;
mod row;
mod sleeping;
mod volumes;

use crate::backend::Executor;
use crate::columns::{self, count};
use crate::json::Json;
use crate::machine;
use crate::options::{OutputArguments, RunArguments};
use clap::Args;
use device::Device;
use incise_mesh::{Model, Surface, build_model};
use incise_pbd_gpu::{Material, SolverParams};
use incise_scene::{BodyId, Scene, SceneError, SceneParams, SleepParams};
use row::{Finding, Row};
use std::error::Error;
use std::io::Write;

/// What is measured, on what.
#[derive(Args, Clone)]
pub(crate) struct SkipArguments {
    /// What is left out, separated by commas.
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = NAMES)]
    only: Vec<String>,
    /// Small bodies and fewer pairs of times: seconds instead of minutes.
    #[arg(long)]
    quick: bool,
    #[command(flatten)]
    pub(crate) run: RunArguments,
}

/// What claims are about, in the order of the table; what a backend has no claim about is passed over there.
const NAMES: [&str; 11] = [
    "device",
    "sleep",
    "absent",
    "volume",
    "struts",
    "contacts",
    "blade-at-rest",
    "far-blade",
    "early-out",
    "kernels",
    "readback",
];

/// How much is measured.
#[derive(Debug, Clone, Copy)]
struct Effort {
    /// Pairs of times that a ratio is the median of.
    pairs: u32,
    /// Bodies that sleep.
    sleepers: &'static [Model],
    /// Bodies that other claims are about.
    models: &'static [Model],
}

const FULL: Effort = Effort {
    pairs: 101,
    sleepers: &Model::ALL,
    models: &[Model::Bunny, Model::Armadillo],
};

const QUICK: Effort = Effort {
    pairs: 21,
    sleepers: &[Model::Sphere20, Model::Bunny],
    models: &[Model::Bunny],
};

/// A frame of 60 a second \[s\].
const DT: f32 = 1.0 / 60.0;

/// A scene of one body that nothing pulls, so that it rests as it is.
fn at_rest(
    model: Model,
    solver: SolverParams,
    sleep: Option<SleepParams>,
) -> Result<Scene, SceneError> {
    at_rest_of(build_model(model), &Material::default(), solver, sleep)
}

fn at_rest_of(
    surface: Surface,
    material: &Material,
    solver: SolverParams,
    sleep: Option<SleepParams>,
) -> Result<Scene, SceneError> {
    let mut scene = Scene::new(params(solver, sleep));
    scene.add_body(surface, material)?;
    Ok(scene)
}

fn params(solver: SolverParams, sleep: Option<SleepParams>) -> SceneParams {
    SceneParams {
        dt: DT,
        solver: SolverParams {
            gravity: [0.0; 3],
            ..solver
        },
        checkpoint: 0,
        sleep,
        ..SceneParams::default()
    }
}

fn add(scene: &mut Scene, model: Model) -> Result<BodyId, SceneError> {
    scene.add_body(build_model(model), &Material::default())
}

/// Seconds in millionths, with three digits.
fn us(seconds: f64) -> String {
    let us = seconds * 1e6;
    match us {
        us if us < 10.0 => format!("{us:.2}"),
        us if us < 100.0 => format!("{us:.1}"),
        us => format!("{us:.0}"),
    }
}

/// What is measured at once, and the claims that come of it.
struct Measurement<'a> {
    skips: &'static [&'static str],
    /// On what, for people who wait.
    on: String,
    run: Box<dyn FnMut() -> Found + 'a>,
}

type Found = Result<Vec<Finding>, Box<dyn Error>>;

impl<'a> Measurement<'a> {
    fn new<const N: usize>(
        skips: &'static [&'static str],
        on: impl Into<String>,
        mut run: impl FnMut() -> Result<[Finding; N], Box<dyn Error>> + 'a,
    ) -> Self {
        Self {
            skips,
            on: on.into(),
            run: Box::new(move || Ok(run()?.into())),
        }
    }

    /// Whether `only` names one of its claims, or nothing.
    fn is_wanted(&self, only: &[String]) -> bool {
        self.skips.iter().any(|skip| is_named(only, skip))
    }
}

/// Whether `only` names this, or nothing.
fn is_named(only: &[String], skip: &str) -> bool {
    only.is_empty() || only.iter().any(|name| *name == skip.replace(' ', "-"))
}

/// All measurements on the processor.
fn on_the_processor(effort: Effort) -> Vec<Measurement<'static>> {
    // First, before anything else may have loaded a driver.
    let mut out = vec![drivers::measurement(effort)];
    out.extend(sleeping::measurements(effort));
    out.extend(bare::measurements(effort));
    out.extend(volumes::measurements(effort));
    out.extend(inside::measurements(effort));
    out.extend(blades::measurements(effort));
    out.extend(early::measurements(effort));
    out
}

/// Measures what is wanted on one backend.
fn measure(measurements: Vec<Measurement<'_>>, only: &[String], rows: &OutputArguments) -> Found {
    let wanted: Vec<_> = (measurements.into_iter())
        .filter(|measurement| measurement.is_wanted(only))
        .collect();
    let progress = rows.progress(wanted.len(), 1);
    let mut out = Vec::new();
    for mut measurement in wanted {
        let Measurement { skips, on, .. } = &measurement;
        progress.begin(&format!("{}, {on}", skips[0]));
        out.extend((measurement.run)()?);
        progress.step();
    }
    progress.end();
    out.retain(|finding| is_named(only, finding.skip));
    Ok(out)
}

/// Measures and prints.
pub(crate) fn run(arguments: &SkipArguments, out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    let SkipArguments { run, only, quick } = arguments;
    let effort = if *quick { QUICK } else { FULL };
    let commit = machine::commit();
    let mut json = Json::open(run.rows.json.as_deref())?;
    let mut rows: Vec<Row> = Vec::new();
    for executor in run.backends() {
        let device = match executor {
            Executor::Cpu => None,
            Executor::Gpu => Some(Device::open(run.gpu.adapter.as_deref())?),
        };
        let described = (device.as_ref()).map_or_else(machine::machine, Device::describe);
        writeln!(out, "{}: {described}, commit {commit}", executor.name())?;
        out.flush()?;
        let measurements = match &device {
            None => on_the_processor(effort),
            Some(device) => device.measurements(effort),
        };
        let findings = measure(measurements, only, &run.rows)?;
        rows.extend(
            findings
                .into_iter()
                .map(|f| Row::of(f, &described, &commit)),
        );
    }
    if rows.is_empty() {
        return Err(
            "--only names nothing that is claimed of these backends: add --backend gpu".into(),
        );
    }
    let cells: Vec<_> = [(Row::NAMES.map(str::to_owned), vec![row::TEXTS.to_owned()])]
        .into_iter()
        .chain(rows.iter().map(|row| (row.cells(), row.texts())))
        .collect();
    write!(out, "{}", columns::with_texts(&cells, 2))?;
    write!(out, "{}", columns::paragraphs(row::LEGEND))?;
    let failed = rows.iter().filter(|row| !row.passed).count();
    writeln!(out, "Failed: {failed} of {}.", count(rows.len(), "claim"))?;
    json.write(&rows)?;
    if failed > 0 {
        let verb = if failed == 1 { "does" } else { "do" };
        return Err(format!("{} {verb} not hold", count(failed, "claim")).into());
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn claims_are_found_by_their_names() {
        for effort in [FULL, QUICK] {
            let all = on_the_processor(effort);
            let skips = || all.iter().flat_map(|measurement| measurement.skips);
            assert!(skips().all(|skip| NAMES.contains(&skip.replace(' ', "-").as_str())));
            let wanted = |only: &[&str]| {
                let only: Vec<String> = only.iter().map(|&s| s.to_owned()).collect();
                all.iter().filter(|m| m.is_wanted(&only)).count()
            };
            assert_eq!(wanted(&[]), all.len());
            assert_eq!(wanted(&["device"]), 1);
            assert_eq!(wanted(&["early-out"]), 2 * effort.models.len());
            assert_eq!(wanted(&["volume"]), effort.models.len());
            assert_eq!(wanted(&["struts", "contacts"]), 3 * effort.models.len());
            assert_eq!(
                wanted(&["far-blade", "blade-at-rest"]),
                2 * effort.models.len()
            );
            assert_eq!(wanted(&["readback"]), 0, "a device has it");
        }
    }

    #[test]
    fn what_is_measured_is_what_was_named() {
        let found = measure(
            on_the_processor(QUICK),
            &["device".to_owned()],
            &OutputArguments::default(),
        )
        .unwrap();
        let skips: Vec<&str> = found.iter().map(|finding| finding.skip).collect();
        assert_eq!(skips, ["device"]);
    }

    #[test]
    fn a_body_at_rest_sleeps_and_costs_less() {
        let mut scene = at_rest(
            Model::Sphere80,
            SolverParams::default(),
            Some(SleepParams::default()),
        )
        .unwrap();
        sleeping::lull(&mut scene, 1).unwrap();
        assert_eq!(scene.step().unwrap().asleep, 1);
    }
}
