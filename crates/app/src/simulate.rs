//! `incise simulate`: drops meshes as soft bodies, optionally cuts them, and writes their pieces.
//!
//! A scene comes from a file or from options; both are a [`SceneFile`].

mod bodies;
mod export;
mod options;
mod output;
#[cfg(feature = "gpu")]
mod pictures;
mod recording;
mod report;
mod scene_file;
mod scheduled_cuts;

pub(crate) use scene_file::SceneFileError;

use crate::clock::timed;
use crate::failure::Failure;
use crate::pieces::{self, Written};
use crate::reporter::Reporter;
use bodies::{Bodies, Input, StartBounds};
use clap::ValueEnum;
use incise_mesh::Surface;
use incise_scene::{BackendChoice, BackendRequest, Scene, SceneParams};
use options::SceneOptions;
use output::SimulateOutput;
use recording::Recording;
use report::{PieceOfBody, Report, Times, print};
use scene_file::SceneFile;
use scheduled_cuts::ScheduledCuts;
use serde::Deserialize;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Drops meshes as soft bodies, optionally cuts them at given times, and writes their pieces.
///
/// The input is a scene file (toml), or meshes with the options below. Writes one piece per file:
/// `DIR/piece_000.obj` and so on, body by body. Files of these names from an earlier run are
/// overwritten or removed. The y axis points up. A mesh with a boundary is
/// cloth by default, since it has no inside.
#[derive(clap::Args)]
#[command(after_long_help = AFTER_HELP)]
pub(crate) struct SimulateArguments {
    /// A scene file (toml); or meshes (obj, ply, stl, glb or gltf; units are meters), or built-in
    /// models such as Bunny.
    #[arg(value_name = "SCENE|FILE|MODEL", required = true)]
    inputs: Vec<PathBuf>,
    #[command(flatten)]
    scene: SceneOptions,
    /// Backend that steps the bodies. [default: cpu]
    #[arg(long, value_enum)]
    backend: Option<Backend>,
    /// GPU to use: a part of its name, as listed by `incise devices`.
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
    #[command(flatten)]
    output: SimulateOutput,
}

const AFTER_HELP: &str = "\
Examples:
  incise simulate Bunny --seconds 2 --ground -0.5 -o pieces
  incise simulate Bunny --seconds 2 --material jelly --plane 0,1,0.2,-1 --at 0.5 -o pieces
  incise simulate Bunny --seconds 2 --path knife.txt -o pieces
  incise simulate scene.toml
  Two bodies above each other, cut by two planes at two times:
    incise simulate Bunny Sphere768 --offset 0,0,0 --offset 0,1.5,0 --seconds 2 --ground -1 \\
      --plane 1,0,0.1,0 --at 0.2 --plane 0,0.1,1,0 --at 0.4 -o pieces

JSON report (--json): inputs (file and warnings of each), backend, device, fallback_reason, frames,
dt, iterations, substep, hits, failed_cuts and missed_cuts (a message for every cut that
could not be made, and for every plane and blade that hit nothing), steps, cutting_steps (with
--path, else null: motions of the blade, and those that cut), pieces (body, which is the index of
its input, file, vertices, triangles, area, volume, cavity, boundary_edges and euler_characteristic
of each), pictures (of --frames and --animation), removed, seconds.

Exit code 4: the cuts miss all bodies or cannot be made, and the pieces are those of the uncut
bodies.";

/// The backend that steps a body.
#[derive(Debug, Clone, Copy, Default, ValueEnum, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Backend {
    /// The CPU.
    #[default]
    Cpu,
    /// A GPU.
    Gpu,
    /// A hardware GPU for bodies that it steps faster, else the CPU.
    Auto,
}

impl Backend {
    /// Returns the choice of a scene's backend.
    #[must_use]
    pub fn choice(self) -> BackendChoice {
        match self {
            Self::Cpu => BackendChoice::Cpu,
            Self::Gpu => BackendChoice::Gpu,
            Self::Auto => BackendChoice::Auto,
        }
    }
}

/// Runs the command.
pub(crate) fn run(
    arguments: &SimulateArguments,
    reporter: &mut Reporter<impl Write>,
) -> Result<(), Failure> {
    let file = arguments.scene_file()?;
    file.check_frames()?;
    let mut cuts = ScheduledCuts::new(&file)?;
    let materials = file.materials()?;
    let (inputs, surfaces) = bodies::read(&file)?;
    for (input, surface) in inputs.iter().zip(&surfaces) {
        for warning in &input.warnings {
            reporter.warn(format_args!("{}: {warning}", input.file.display()));
        }
        if let Some(export) = &file.output.export {
            pieces::check_target(export, &input.file)?;
        }
        let colliders = file.colliders(surface.origin())?;
        bodies::check_planes(surface, &input.file, &colliders)?;
    }
    let origin = surfaces.first().map_or([0.0; 3], Surface::origin);
    let params = file.scene_params()?;
    let mut scene = new_scene(&file, params, origin, &inputs)?;
    let mut recording = Recording::new(&file);
    let start = StartBounds::new(&surfaces);
    let (simulate, bodies) = timed(|| {
        let bodies = Bodies::add(&mut scene, &inputs, surfaces, &materials)?;
        step(
            &file,
            &mut scene,
            &bodies,
            &mut cuts,
            &mut recording,
            reporter,
        )?;
        Ok::<_, Failure>(bodies)
    });
    let bodies = bodies?;
    let backend = scene.backend_report();
    let cut_surfaces = bodies.surfaces(&mut scene)?;
    let seconds = f64::from(file.frames()) * file.dt;
    start.check(&cut_surfaces, params.solver.gravity, seconds)?;
    let (write, written) = timed(|| write_pieces(&file.output, &cut_surfaces, reporter));
    let written = written?;
    #[cfg(feature = "gpu")]
    let pictures = pictures::draw(
        &recording,
        &file.output,
        &scene.colliders,
        file.adapter.clone(),
    )?;
    if let Some(path) = &file.output.export {
        let rate = file.output.pictures_per_second();
        for warning in export::write(&recording, rate, path)? {
            reporter.warn(format_args!("{}: {warning}", path.display()));
        }
    }
    let is_on_gpu = (bodies.ids().iter()).any(|id| backend.gpu_bodies.contains(id));
    let of_body = |(body, piece)| PieceOfBody { body, piece };
    let report = Report {
        inputs,
        backend: backend.choice.name(),
        device: backend.adapter.filter(|_| is_on_gpu),
        fallback_reason: backend.fallback_reason.map(|reason| reason.to_string()),
        frames: file.frames(),
        dt: file.dt,
        iterations: params.solver.iterations,
        substep: params.solver.substep,
        hits: (!cuts.is_empty()).then_some(cuts.hits),
        failed_cuts: cuts.refusals.clone(),
        missed_cuts: cuts.misses().collect(),
        steps: cuts.steps(),
        cutting_steps: cuts.cutting_steps(),
        pieces: written.pieces.into_iter().map(of_body).collect(),
        #[cfg(feature = "gpu")]
        pictures,
        removed: written.removed,
        seconds: Times {
            simulate: simulate.as_secs_f64(),
            write: write.as_secs_f64(),
        },
    };
    reporter.report(&report, print)?;
    if cuts.is_empty() {
        return Ok(());
    }
    if cuts.hits == 0 && !cuts.refusals.is_empty() {
        let path = bodies.all_paths();
        return Err(Failure::NoCut { path });
    }
    if cuts.hits == 0 {
        return Err(Failure::Missed {
            path: bodies.all_paths(),
            bounds: cuts.bounds_at_start,
            output: "the files hold the uncut bodies",
        });
    }
    for miss in &report.missed_cuts {
        reporter.warn(miss);
    }
    Ok(())
}

impl SimulateArguments {
    /// Returns the scene of the file or of the options, with the outputs of the command line.
    fn scene_file(&self) -> Result<SceneFile, Failure> {
        let is_scene = |input: &&PathBuf| {
            let extension = input.extension();
            extension.is_some_and(|extension| extension.eq_ignore_ascii_case("toml"))
        };
        let mut file = match self.inputs.iter().find(is_scene) {
            None => self.scene.scene_file(&self.inputs)?,
            Some(path) => {
                if let Some(option) = self.scene.first_given() {
                    let with = "a scene file, which describes it";
                    return Err(Failure::NotWith { option, with });
                }
                if self.inputs.len() > 1 {
                    return Err(Failure::SceneAndMeshes { path: path.clone() });
                }
                SceneFile::read(path)?
            }
        };
        file.backend = self.backend.unwrap_or(file.backend);
        file.adapter = self.adapter.clone().or(file.adapter);
        file.output = self.output.clone().or(file.output);
        if file.output.is_empty() {
            return Err(Failure::NoOutput);
        }
        file.output.check()?;
        Ok(file)
    }
}

/// Creates the scene, without bodies and blades, relative to an origin.
fn new_scene(
    file: &SceneFile,
    params: SceneParams,
    origin: [f64; 3],
    inputs: &[Input],
) -> Result<Scene, Failure> {
    let request = BackendRequest {
        choice: file.backend.choice(),
        adapter: file.adapter.clone(),
        ..BackendRequest::default()
    };
    let scene = Scene::with_backend(params, &request);
    let mut scene = scene.map_err(|source| Failure::Scene {
        path: inputs
            .first()
            .map(|input| input.file.clone())
            .unwrap_or_default(),
        source,
    })?;
    scene.colliders = file.colliders(origin)?;
    Ok(scene)
}

/// Steps the scene to its end, and records the pictures that are due.
fn step(
    file: &SceneFile,
    scene: &mut Scene,
    bodies: &Bodies,
    cuts: &mut ScheduledCuts,
    recording: &mut Recording,
    reporter: &Reporter<impl Write>,
) -> Result<(), Failure> {
    let frames = file.frames();
    let a_second = file.frame_at(1.0).clamp(1, frames);
    let progress = reporter.progress(frames.div_ceil(a_second), a_second);
    recording.record(0, scene, bodies, cuts)?;
    for frame in 0..frames {
        if frame % a_second == 0 {
            progress.begin(&format!("from {:.3} s", f64::from(frame) * file.dt));
        }
        cuts.before_frame(frame, scene, bodies)?;
        let stepped = scene.step().map(|stats| stats.fell_back);
        if stepped.map_err(|source| bodies.failed(source))? {
            progress.suspend(|| warn_of_fallback(scene, reporter));
        }
        for refusal in cuts.after_frame(frame, scene, bodies)? {
            progress.suspend(|| reporter.warn(refusal));
        }
        recording.record(frame + 1, scene, bodies, cuts)?;
        progress.step();
    }
    progress.end();
    Ok(())
}

/// Writes the pieces, if the output has a place for them, without the normals of the input, which
/// do not follow the motion.
fn write_pieces(
    output: &SimulateOutput,
    surfaces: &[(&Surface, &Path)],
    reporter: &Reporter<impl Write>,
) -> Result<Written, Failure> {
    let Some(path) = &output.pieces else {
        return Ok(Written::default());
    };
    let moved = surfaces.iter().map(|&(surface, input)| {
        let mut surface = surface.clone();
        surface
            .set_corner_normals(Vec::new())
            .expect("a surface without normals is allowed");
        (surface, input)
    });
    let moved: Vec<(Surface, &Path)> = moved.collect();
    let moved: Vec<(&Surface, &Path)> = moved.iter().map(|(s, input)| (s, *input)).collect();
    let written = pieces::write(&moved, path, output.format.unwrap_or_default())?;
    for warning in &written.warnings {
        reporter.warn(format_args!("{}: {warning}", path.display()));
    }
    Ok(written)
}

/// Warns that the scene continues on the CPU.
fn warn_of_fallback(scene: &Scene, reporter: &Reporter<impl Write>) {
    let report = scene.backend_report();
    if let Some(why) = report.fallback_reason {
        reporter.warn(format_args!("continuing on the CPU: {why}"));
    }
}
