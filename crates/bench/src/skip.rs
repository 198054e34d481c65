//! What a scene does not need, and that it costs nothing: sleeping bodies, features that are absent, blades that cut nothing,
//! iterations that move nothing, a device that nobody asks.

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
mod minimal;
mod row;
mod sleeping;

use crate::backend::Executor;
use crate::{columns, json, machine};
use clap::Args;
use device::Device;
use incise_mesh::{Model, Surface, build_model};
use incise_pbd_gpu::{Material, SolverParams};
use incise_scene::{BodyId, Scene, SceneError, SceneParams, SleepParams};
use row::{Finding, Row};
use std::error::Error;
use std::io::Write;
use std::path::PathBuf;

/// What is measured, on what.
#[derive(Args, Clone)]
pub(crate) struct SkipArguments {
    /// What executes the solver, separated by commas.
    #[arg(
        long,
        value_enum,
        value_name = "NAMES",
        value_delimiter = ',',
        default_value = "cpu"
    )]
    backend: Vec<Executor>,
    /// A part of the name of the GPU to take.
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
    /// Also write the claims as JSON, one object a row.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// Pairs of times that a ratio is the median of.
const PAIRS: u32 = 101;

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

/// All claims about the processor.
fn on_the_processor() -> Result<Vec<Finding>, Box<dyn Error>> {
    let some = [Model::Bunny, Model::Armadillo];
    // First, before anything else may have loaded a driver.
    let mut out = vec![drivers::finding()?];
    out.extend(sleeping::findings(&Model::ALL)?);
    out.extend(bare::findings(&some)?);
    out.extend(blades::findings(&some)?);
    out.extend(early::findings(&some)?);
    Ok(out)
}

/// Measures and prints.
pub(crate) fn run(arguments: &SkipArguments, out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    let commit = machine::commit();
    let mut rows: Vec<Row> = Vec::new();
    for &executor in &arguments.backend {
        let (device, findings) = match executor {
            Executor::Cpu => (machine::machine(), on_the_processor()?),
            Executor::Gpu => {
                let mut device = Device::open(arguments.adapter.as_deref())?;
                (device.describe(), device.findings()?)
            }
        };
        writeln!(out, "{device}, commit {commit}")?;
        rows.extend(findings.into_iter().map(|f| Row::of(f, &device, &commit)));
    }
    if let Some(path) = &arguments.json {
        json::write(path, &rows)?;
    }
    let cells: Vec<_> = [Row::NAMES.map(str::to_owned)]
        .into_iter()
        .chain(rows.iter().map(Row::cells))
        .collect();
    write!(out, "{}", columns::columns(&cells, 4))?;
    writeln!(out, "{}", row::LEGEND)?;
    let failed = rows.iter().filter(|row| !row.passed).count();
    writeln!(out, "Failed: {failed} of {} claims.", rows.len())?;
    if failed > 0 {
        return Err(format!("{failed} claims do not hold").into());
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

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
