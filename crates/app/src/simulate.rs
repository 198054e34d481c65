//! `incise simulate`: drops meshes as soft bodies, optionally cuts them, and writes their pieces.

mod bodies;
mod knife;
mod report;

use crate::blade_path::BladePath;
use crate::caps::CapsOption;
use crate::clock::{milliseconds, timed};
use crate::failure::Failure;
use crate::input::InputOptions;
use crate::numbers::{Numbers, numbers, positive};
use crate::pieces::OutputOptions;
use crate::reporter::Reporter;
use bodies::{Bodies, Input};
use clap::ValueEnum;
use incise_cut::CutParams;
use incise_mesh::Surface;
use incise_mesh::geometry::round_to_f32;
use incise_pbd_gpu::{InteriorSprings, Material, SolverParams, Volume};
use incise_scene::{BackendChoice, BackendRequest, ContactParams, Scene, SceneError, SceneParams};
use knife::Knife;
use report::{PieceOfBody, Report, Times, print};
use std::io::Write;
use std::path::{Path, PathBuf};

/// Drops meshes as soft bodies, optionally cuts them at given times, and writes their pieces.
///
/// Writes one piece per file: `DIR/piece_000.obj` and so on, body by body. Files of these names
/// from an earlier run are overwritten or removed. The y axis points up. Without --volume or
/// --interior-springs a body is a shell, which collapses under its weight. A mesh with a boundary
/// is a sheet, such as cloth.
#[derive(clap::Args)]
#[command(after_long_help = AFTER_HELP)]
pub(crate) struct SimulateArguments {
    /// The meshes (obj, ply, stl, glb or gltf; units are meters), or built-in models such as Bunny.
    #[arg(value_name = "FILE|MODEL", required = true)]
    inputs: Vec<PathBuf>,
    #[command(flatten)]
    reading: InputOptions,
    /// Move an input before the start [m]; the first one moves the first input, and so on.
    #[arg(
        long,
        value_name = "X,Y,Z",
        value_parser = numbers::<3>,
        allow_hyphen_values = true
    )]
    offset: Vec<Numbers<3>>,
    /// Simulated time [s].
    #[arg(long, value_name = "S", value_parser = positive)]
    seconds: f64,
    /// Time step of a frame, as a number or a fraction [s].
    #[arg(long, value_name = "S", default_value = "1/60", value_parser = positive)]
    dt: f64,
    /// Solver iterations per substep.
    #[arg(
        long,
        value_name = "N",
        default_value_t = SolverParams::default().iterations,
        value_parser = clap::value_parser!(u32).range(1..)
    )]
    iterations: u32,
    /// Substeps per frame.
    #[arg(
        long,
        value_name = "N",
        default_value_t = SolverParams::default().substeps,
        value_parser = clap::value_parser!(u32).range(1..)
    )]
    substeps: u32,
    /// Height of the ground plane [m]; the meshes must begin above it.
    #[arg(long, value_name = "H", value_parser = numbers::<1>, allow_hyphen_values = true)]
    ground: Option<Numbers<1>>,
    /// Preserve the rest volume of every closed piece.
    #[arg(long)]
    volume: bool,
    /// Connect opposite sides by springs through the body: springs per vertex, 0 to 1.
    #[arg(long, value_name = "DENSITY", value_parser = numbers::<1>)]
    interior_springs: Option<Numbers<1>>,
    /// Let pieces pass through each other instead of resolving their contacts.
    #[arg(long)]
    no_contacts: bool,
    /// Cut all bodies along the plane `nx x + ny y + nz z = d`. Several planes cut in their order.
    #[arg(
        long,
        value_name = "NX,NY,NZ,D",
        value_parser = numbers::<4>,
        allow_hyphen_values = true,
        group = "cutter"
    )]
    plane: Vec<Numbers<4>>,
    /// Move a straight blade through the bodies, one pose per frame. The cut may end inside.
    ///
    /// The file is that of `incise cut --path`, with two points per line. The blade stands at its
    /// last pose. The walls of the cut collide with each other, except with --no-contacts.
    #[arg(long, value_name = "FILE", group = "cutter")]
    path: Option<PathBuf>,
    /// Curves along which caps close the cut.
    #[arg(
        long,
        value_enum,
        value_name = "CURVES",
        default_value_t = CapsOption::Bodies,
        requires = "cutter"
    )]
    caps: CapsOption,
    /// Time of the cut, or of the first pose [s]; 0 by default.
    ///
    /// Given once it is the time of all planes, else each plane has its own, in their order.
    #[arg(long, value_name = "S", value_parser = positive, requires = "cutter")]
    at: Vec<f64>,
    /// Backend that steps the bodies.
    #[arg(long, value_enum, default_value_t = Backend::Cpu)]
    backend: Backend,
    /// GPU to use: a part of its name, as listed by `incise devices`.
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
    #[command(flatten)]
    output: OutputOptions,
}

const AFTER_HELP: &str = "\
Examples:
  incise simulate Bunny --seconds 2 --ground -0.5 --volume --interior-springs 1 -o pieces
  incise simulate Bunny --seconds 2 --volume --plane 0,1,0.2,-1 --at 0.5 -o pieces
  incise simulate Bunny --seconds 2 --volume --path knife.txt -o pieces
  Two bodies above each other, cut by two planes at two times:
    incise simulate Bunny Sphere768 --offset 0,0,0 --offset 0,1.5,0 --seconds 2 --ground -1 \\
      --volume --interior-springs 1 --plane 1,0,0.1,0 --at 0.2 --plane 0,0.1,1,0 --at 0.4 -o pieces

JSON report (--json): inputs (file and warnings of each), backend, device, fallback_reason, frames,
dt, iterations, substeps, triangles_hit, steps, cutting_steps (with --path, else null: motions of
the blade, and those that cut), pieces (body, which is the index of its input, file, vertices,
triangles, area, volume, cavity, boundary_edges and euler_characteristic of each), removed,
milliseconds.

Exit code 4: the cuts miss all bodies, and the pieces are those of the uncut bodies.";

/// The backend that steps a body.
#[derive(Clone, Copy, ValueEnum)]
pub(crate) enum Backend {
    /// The CPU.
    Cpu,
    /// A GPU.
    Gpu,
    /// A hardware GPU for bodies that it steps faster, else the CPU.
    Auto,
}

impl Backend {
    pub(crate) fn choice(self) -> BackendChoice {
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
    let frames = whole(arguments.seconds / arguments.dt).max(1);
    let starts = arguments.starts(frames)?;
    let first_start = starts.first().copied().unwrap_or(0);
    let blade_path = arguments.blade_path(first_start, frames)?;
    let (inputs, surfaces) = bodies::read(&arguments.inputs, &arguments.offset, arguments.reading)?;
    for (input, surface) in inputs.iter().zip(&surfaces) {
        for warning in &input.warnings {
            reporter.warn(format_args!("{}: {warning}", input.file.display()));
        }
        let ground = arguments.ground(surface.origin()[1]);
        bodies::check_ground(surface, &input.file, ground)?;
    }
    let origin = surfaces.first().map_or([0.0; 3], Surface::origin);
    let mut knife = match &blade_path {
        Some(way) => Some(Knife::from_path(way, origin, first_start)?),
        None if arguments.plane.is_empty() => None,
        None => {
            let planes = arguments.plane.iter().copied();
            Some(Knife::from_planes(planes.zip(starts)))
        }
    };
    let (simulate, simulated) =
        timed(|| arguments.simulate(&inputs, surfaces, frames, knife.as_mut(), reporter));
    let (mut scene, bodies) = simulated?;
    let backend = scene.backend_report();
    let cut_surfaces = bodies.surfaces(&mut scene)?;
    let (write, written) = timed(|| arguments.output.write(&cut_surfaces));
    let written = written?;
    for warning in &written.warnings {
        reporter.warn(format_args!(
            "{}: {warning}",
            arguments.output.path().display()
        ));
    }
    let is_on_device = (bodies.ids().iter()).any(|id| backend.gpu_bodies.contains(id));
    let of_body = |(body, piece)| PieceOfBody { body, piece };
    let report = Report {
        inputs,
        backend: backend.choice.name(),
        device: backend.adapter.filter(|_| is_on_device),
        fallback_reason: backend.fallback_reason.map(|reason| reason.to_string()),
        frames,
        dt: arguments.dt,
        iterations: arguments.iterations,
        substeps: arguments.substeps,
        triangles_hit: knife.as_ref().map(|knife| knife.triangles_hit),
        steps: knife.as_ref().and_then(Knife::steps),
        cutting_steps: knife.as_ref().and_then(Knife::cutting_steps),
        pieces: written.pieces.into_iter().map(of_body).collect(),
        removed: written.removed,
        milliseconds: Times {
            simulate: milliseconds(simulate),
            write: milliseconds(write),
        },
    };
    reporter.report(&report, print)?;
    match knife {
        Some(knife) if knife.triangles_hit == 0 => Err(Failure::Missed {
            path: bodies.all_paths(),
            bounds: knife.bounds_at_start,
            output: "the files hold the uncut bodies",
        }),
        Some(knife) => {
            for Numbers([x, y, z, d]) in knife.missed_planes() {
                reporter.warn(format_args!("the plane {x},{y},{z},{d} misses all bodies"));
            }
            Ok(())
        }
        None => Ok(()),
    }
}

impl SimulateArguments {
    /// Returns the first frame of each cut: of every plane, or of the path.
    fn starts(&self, frames: u32) -> Result<Vec<u32>, Failure> {
        let planes = self.plane.len().max(1);
        let times = match self.at.as_slice() {
            [] => vec![0.0; planes],
            &[time] => vec![time; planes],
            times if times.len() == planes => times.to_vec(),
            times => {
                return Err(Failure::CutTimes {
                    times: times.len(),
                    planes: self.plane.len(),
                });
            }
        };
        let starts = times.iter().map(|time| whole(time / self.dt));
        let starts: Vec<u32> = starts.collect();
        if starts.iter().any(|&start| start >= frames) {
            return Err(Failure::CutAfterEnd);
        }
        Ok(starts)
    }

    /// Reads the path of the blade, if there is one; it must end before the simulation.
    fn blade_path(&self, start: u32, frames: u32) -> Result<Option<(&Path, BladePath)>, Failure> {
        let Some(file) = self.path.as_deref() else {
            return Ok(None);
        };
        let path = BladePath::read(file)?;
        let poses = path.len();
        let end = poses.saturating_add(usize::try_from(start).unwrap_or(usize::MAX));
        if end > usize::try_from(frames).unwrap_or(usize::MAX) {
            #[expect(clippy::cast_precision_loss, reason = "for a message")]
            let seconds = end as f64 * self.dt;
            return Err(Failure::PathAfterEnd { poses, seconds });
        }
        Ok(Some((file, path)))
    }

    /// Returns the height of the ground above a height of the file.
    fn ground(&self, origin: f64) -> Option<f32> {
        self.ground
            .map(|Numbers([height])| round_to_f32(height - origin))
    }

    /// Creates a scene with its origin at this height of the file.
    fn scene(&self, origin_height: f64) -> Result<Scene, SceneError> {
        let params = SceneParams {
            dt: round_to_f32(self.dt),
            solver: SolverParams {
                iterations: self.iterations,
                substeps: self.substeps,
                ground: self.ground(origin_height),
                ..SolverParams::default()
            },
            cut: CutParams {
                caps: self.caps.caps(),
                ..CutParams::default()
            },
            contacts: (!self.no_contacts).then(|| ContactParams {
                // Both walls of a cut that ends inside belong to one piece.
                self_collision: self.path.is_some(),
                ..ContactParams::default()
            }),
            ..SceneParams::default()
        };
        let request = BackendRequest {
            choice: self.backend.choice(),
            adapter: self.adapter.clone(),
            ..BackendRequest::default()
        };
        Scene::with_backend(params, &request)
    }

    fn material(&self) -> Material {
        Material {
            volume: self.volume.then(Volume::default),
            interior_springs: self
                .interior_springs
                .map(|Numbers([density])| InteriorSprings {
                    density: round_to_f32(density),
                    ..InteriorSprings::default()
                }),
            ..Material::default()
        }
    }

    fn simulate(
        &self,
        inputs: &[Input],
        surfaces: Vec<Surface>,
        frames: u32,
        mut knife: Option<&mut Knife<'_>>,
        reporter: &Reporter<impl Write>,
    ) -> Result<(Scene, Bodies), Failure> {
        let height = surfaces.first().map_or(0.0, |surface| surface.origin()[1]);
        let mut scene = self.scene(height).map_err(|source| Failure::Scene {
            path: inputs[0].file.clone(),
            source,
        })?;
        let bodies = Bodies::add(&mut scene, inputs, surfaces, &self.material())?;
        let a_second = whole(1.0 / self.dt).clamp(1, frames);
        let progress = reporter.progress(frames.div_ceil(a_second), a_second);
        for frame in 0..frames {
            if frame % a_second == 0 {
                progress.begin(&format!("from {:.3} s", f64::from(frame) * self.dt));
            }
            if let Some(knife) = &mut knife {
                knife.before_frame(frame, &mut scene, &bodies)?;
            }
            let stepped = scene.step().map(|stats| stats.fell_back);
            if stepped.map_err(|source| bodies.failed(source))? {
                progress.suspend(|| warn_of_fallback(&scene, reporter));
            }
            if let Some(knife) = &mut knife {
                knife.after_frame(frame, &mut scene, &bodies)?;
            }
            progress.step();
        }
        progress.end();
        Ok((scene, bodies))
    }
}

/// Warns that the scene continues on the CPU.
fn warn_of_fallback(scene: &Scene, reporter: &Reporter<impl Write>) {
    let report = scene.backend_report();
    if let Some(why) = report.fallback_reason {
        reporter.warn(format_args!("continuing on the CPU: {why}"));
    }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a saturating cast of a number that is not negative"
)]
fn whole(x: f64) -> u32 {
    x.round() as u32
}
