//! Scenes on a device.

use super::clock::pairs;
use super::row::Finding;
use super::sleeping::lull;
use super::{Effort, Measurement, add, params, us};
use incise_mesh::{Model, build_model};
use incise_pbd_gpu::{
    AdapterRequest, GpuBackend, Material, Schedule, Solver, SolverParams, Volume,
};
use incise_scene::{BackendChoice, BackendRequest, Scene, SleepParams};
use std::error::Error;

/// An adapter that opens.
#[derive(Debug)]
pub(super) struct Device {
    name: Option<String>,
    described: String,
}

/// What edges alone take, one dispatch a color: passes over vertices, over large colors and over small ones.
const LEAST: [&str; 4] = ["predict", "stretch", "tail", "integrate"];

impl Device {
    /// Opens the GPU of that name, else the best there is, software if there is nothing else.
    ///
    /// # Errors
    /// Why there is none.
    pub(super) fn open(adapter: Option<&str>) -> Result<Self, Box<dyn Error>> {
        let name = adapter.map(str::to_owned);
        let gpu = GpuBackend::new(&AdapterRequest::any(name.clone()))?;
        let adapter = gpu.adapter();
        let described = format!("{} ({})", adapter.name, adapter.driver);
        Ok(Self { name, described })
    }

    /// The adapter's name and driver.
    pub(super) fn describe(&self) -> String {
        self.described.clone()
    }

    pub(super) fn measurements(&self, effort: Effort) -> Vec<Measurement<'_>> {
        let mut all = vec![
            Measurement::new(&["kernels"], "edges alone", || Ok([self.kernels()?])),
            Measurement::new(&["readback", "kernels"], "Bunny", || self.unasked()),
            Measurement::new(&["sleep"], "Bunny", move || self.asleep(effort.pairs)),
        ];
        all.extend(effort.models.iter().map(|&model| {
            Measurement::new(&["volume"], model.name(), move || {
                Ok([self.volume(model, effort.pairs)?])
            })
        }));
        all
    }

    fn scene(&self, sleep: Option<SleepParams>) -> Result<Scene, Box<dyn Error>> {
        let asked = BackendRequest {
            choice: BackendChoice::Gpu,
            adapter: self.name.clone(),
            allow_software: true,
            ..BackendRequest::default()
        };
        let params = params(SolverParams::default(), sleep);
        Ok(Scene::with_backend(params, &asked)?)
    }

    fn kernels(&self) -> Result<Finding, Box<dyn Error>> {
        let mut gpu = GpuBackend::new(&AdapterRequest::any(self.name.clone()))?;
        gpu.force_schedule(Some(Schedule::Colors));
        let mut surface = build_model(Model::Bunny);
        let material = Material {
            bending: None,
            ..Material::default()
        };
        let mut solver = Solver::new(&mut surface, &material)?;
        let body = gpu.add(&surface, &mut solver)?;
        for _ in 0..10 {
            gpu.step([(body, &mut solver)], super::DT, &SolverParams::paper())?;
        }
        let made: Vec<&str> = gpu.kernels().collect();
        let beyond = made.iter().filter(|name| !LEAST.contains(name)).count();
        Ok(Finding {
            skip: "kernels",
            claim: "kernels compiled for edges alone, beyond those that they take",
            at: made.join(" "),
            bound: 0.0,
            measured: beyond as f64,
        })
    }

    /// A scene that nobody asks anything.
    fn unasked(&self) -> Result<[Finding; 2], Box<dyn Error>> {
        let mut scene = self.scene(None)?;
        add(&mut scene, Model::Bunny)?;
        scene.add_blade([[9.0, 0.0, -1.0], [9.0, 0.0, 1.0]]);
        let (mut read, mut compiled) = (0, 0);
        for frame in 0..100 {
            let stats = scene.step()?;
            read += stats.bytes_read;
            compiled += if frame > 0 { stats.kernels_compiled } else { 0 };
        }
        let at = "a bunny and a blade at rest, 100 frames".to_owned();
        Ok([
            Finding {
                skip: "readback",
                claim: "bytes read that nobody asked for",
                at: at.clone(),
                bound: 0.0,
                measured: read as f64,
            },
            Finding {
                skip: "kernels",
                claim: "kernels compiled after the first frame",
                at,
                bound: 0.0,
                measured: f64::from(compiled),
            },
        ])
    }

    /// A body at rest, asleep and awake.
    fn asleep(&self, count: u32) -> Result<[Finding; 2], Box<dyn Error>> {
        let mut asleep = self.scene(Some(SleepParams::default()))?;
        add(&mut asleep, Model::Bunny)?;
        lull(&mut asleep, 1)?;
        let mut awake = self.scene(None)?;
        add(&mut awake, Model::Bunny)?;
        let mut asked = 0;
        let found = pairs::<Box<dyn Error>>(
            count,
            || {
                let stats = asleep.step()?;
                asked += u64::from(stats.dispatches) + stats.bytes_read + stats.bytes_uploaded;
                Ok(asleep.wait()?)
            },
            || {
                awake.step()?;
                Ok(awake.wait()?)
            },
        )?;
        let [sleeps, steps] = found.seconds.map(us);
        Ok([
            Finding {
                skip: "sleep",
                claim: "time of a frame, of that of the same body awake, until the device is done",
                at: format!("Bunny: {sleeps} of {steps} us"),
                bound: 0.01,
                measured: found.ratio,
            },
            Finding {
                skip: "sleep",
                claim: "dispatches, and bytes sent and read, of a body asleep",
                at: "Bunny".to_owned(),
                bound: 0.0,
                measured: asked as f64,
            },
        ])
    }

    /// A body with volume, beside the same without.
    fn volume(&self, model: Model, count: u32) -> Result<Finding, Box<dyn Error>> {
        let scene = |volume| -> Result<Scene, Box<dyn Error>> {
            let mut scene = self.scene(None)?;
            let material = Material {
                volume,
                ..Material::default()
            };
            scene.add_body(build_model(model), &material)?;
            Ok(scene)
        };
        let (mut with, mut without) = (scene(Some(Volume::default()))?, scene(None)?);
        let frame = |scene: &mut Scene| -> Result<(), Box<dyn Error>> {
            scene.step()?;
            Ok(scene.wait()?)
        };
        let found = pairs(count, || frame(&mut with), || frame(&mut without))?;
        let [with, without] = found.seconds.map(us);
        Ok(Finding {
            skip: "volume",
            claim: "time of a frame with its volume kept, of that without, until the device is done",
            at: format!("{}: {with} of {without} us", model.name()),
            bound: 2.0,
            measured: found.ratio,
        })
    }
}
