//! `incise simulate`: drops a mesh as a soft body, optionally cuts it, and writes its pieces.

mod knife;
mod print;

use crate::blade_path::BladePath;
use crate::caps::CapsOption;
use crate::clock::{milliseconds, timed};
use crate::failure::Failure;
use crate::input::{InputOptions, file_bounds};
use crate::json::{all_lossy, lossy};
use crate::numbers::{Numbers, numbers, positive};
use crate::pieces::{self, Piece, output_path};
use crate::reporter::Reporter;
use clap::ValueEnum;
use incise_cut::CutParams;
use incise_mesh::geometry::round_to_f32;
use incise_mesh::{Surface, Warning};
use incise_pbd_gpu::{InteriorSprings, Material, SolverParams, Volume};
use incise_scene::{
    BackendChoice, BackendRequest, BodyId, ContactParams, Scene, SceneError, SceneParams,
};
use knife::Knife;
use print::print;
use serde::Serialize;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Drops a mesh as a soft body, optionally cuts it at a given time, and writes its pieces.
///
/// Writes one piece per file: `DIR/piece_000.obj` and so on. Files of these names from
/// an earlier run are overwritten or removed. The y axis points up. Without --volume or
/// --interior-springs the body is a shell, which collapses under its weight. A mesh with a boundary
/// is a sheet, such as cloth.
#[derive(clap::Args)]
#[command(after_long_help = AFTER_HELP)]
pub(crate) struct SimulateArguments {
    /// The mesh (obj, ply, stl, glb or gltf; units are meters), or a built-in model such as Bunny.
    #[arg(value_name = "FILE|MODEL")]
    input: PathBuf,
    #[command(flatten)]
    reading: InputOptions,
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
    /// Height of the ground plane [m]; the mesh must begin above it.
    #[arg(long, value_name = "H", value_parser = numbers::<1>, allow_hyphen_values = true)]
    ground: Option<Numbers<1>>,
    /// Preserve the rest volume of every closed piece.
    #[arg(long)]
    volume: bool,
    /// Connect opposite sides by springs through the body: springs per vertex, 0 to 1.
    #[arg(long, value_name = "DENSITY", value_parser = numbers::<1>)]
    interior_springs: Option<Numbers<1>>,
    /// Resolve contacts between the pieces of the body.
    #[arg(long)]
    contacts: bool,
    /// Cut along the plane `nx x + ny y + nz z = d`.
    #[arg(
        long,
        value_name = "NX,NY,NZ,D",
        value_parser = numbers::<4>,
        allow_hyphen_values = true,
        group = "cutter"
    )]
    plane: Option<Numbers<4>>,
    /// Move a straight blade through the body, one pose per frame. The cut may end inside.
    ///
    /// The file is that of `incise cut --path`, with two points per line. The blade stands at its
    /// last pose. With --contacts the walls of the cut collide with each other.
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
    #[arg(long, value_name = "S", value_parser = positive, requires = "cutter")]
    at: Option<f64>,
    /// Backend that steps the body.
    #[arg(long, value_enum, default_value_t = Backend::Cpu)]
    backend: Backend,
    /// GPU to use: a part of its name, as listed by `incise devices`.
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
    /// The folder for the pieces.
    #[arg(short, long, value_name = "DIR", value_parser = output_path())]
    output: PathBuf,
}

const AFTER_HELP: &str = "\
Examples:
  incise simulate Bunny --seconds 2 --ground -0.5 --volume --interior-springs 1 -o pieces
  incise simulate Bunny --seconds 2 --volume --contacts --plane 0,1,0.2,-1 --at 0.5 -o pieces
  incise simulate Bunny --seconds 2 --volume --contacts --path knife.txt -o pieces

JSON report (--json): input, warnings, backend, device, fallback_reason, frames, dt, iterations,
substeps, triangles_hit, steps, cutting_steps (with --path, else null: motions of the blade, and
those that cut), pieces (file, vertices, triangles, area, volume, cavity, boundary_edges and
euler_characteristic of each), removed, milliseconds.

Exit code 4: the cut misses the body, and the pieces are those of the uncut body.";

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

/// The report as JSON.
#[derive(Serialize)]
struct Report {
    #[serde(serialize_with = "lossy")]
    input: PathBuf,
    /// Repairs made while reading.
    warnings: Vec<Warning>,
    backend: &'static str,
    /// The GPU that held the body at the end; none for the CPU.
    device: Option<String>,
    /// Why the CPU continued in place of a GPU; none if it did not.
    fallback_reason: Option<String>,
    frames: u32,
    dt: f64,
    iterations: u32,
    substeps: u32,
    /// Triangles that the sweep crosses; none without a cut.
    triangles_hit: Option<usize>,
    /// Motions of the blade from pose to pose; none without a path.
    steps: Option<usize>,
    /// Steps that cut.
    cutting_steps: Option<usize>,
    pieces: Vec<Piece>,
    /// Removed pieces of an earlier run.
    #[serde(serialize_with = "all_lossy")]
    removed: Vec<PathBuf>,
    milliseconds: Times,
}

/// Times of the stages \[ms\].
#[derive(Serialize)]
struct Times {
    simulate: f64,
    write: f64,
}

/// Runs the command.
pub(crate) fn run(
    arguments: &SimulateArguments,
    reporter: &mut Reporter<impl Write>,
) -> Result<(), Failure> {
    let path = &arguments.input;
    let frames = whole(arguments.seconds / arguments.dt).max(1);
    let start = whole(arguments.at.unwrap_or(0.0) / arguments.dt);
    let blade_path = arguments.blade_path(start, frames)?;
    let (mut surface, warnings) = arguments.reading.read_open(path)?;
    surface.sort_by_position();
    for warning in &warnings {
        reporter.warn(format_args!("{}: {warning}", path.display()));
    }
    let height = surface.origin()[1];
    if let Some(ground) = arguments.ground(0.0)
        && arguments.ground(height) > Some(surface.bounds().min[1])
    {
        return Err(Failure::BelowGround {
            path: path.clone(),
            lowest: file_bounds(&surface).min[1],
            ground,
        });
    }
    let mut knife = match (arguments.plane, &blade_path) {
        (Some(plane), _) => Some(Knife::from_plane(path, plane, start)),
        (None, Some(way)) => Some(Knife::from_path(path, way, surface.origin(), start)?),
        (None, None) => None,
    };
    let (simulate, simulated) =
        timed(|| arguments.simulate(surface, frames, knife.as_mut(), reporter));
    let (scene, body) = simulated?;
    let failed = |source| Failure::Scene {
        path: path.clone(),
        source,
    };
    let surface = scene.body(body).map_err(failed)?.surface();
    let (write, written) = timed(|| pieces::write(surface, path, &arguments.output));
    let written = written?;
    let backend = scene.backend_report();
    let is_on_device = backend.gpu_bodies.contains(&body);
    let report = Report {
        input: path.clone(),
        warnings,
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
        pieces: written.pieces,
        removed: written.removed,
        milliseconds: Times {
            simulate: milliseconds(simulate),
            write: milliseconds(write),
        },
    };
    reporter.report(&report, print)?;
    if let Some(knife) = knife
        && knife.triangles_hit == 0
    {
        return Err(Failure::Missed {
            path: path.clone(),
            bounds: knife.bounds_at_start,
            output: "the files hold the uncut body",
        });
    }
    Ok(())
}

impl SimulateArguments {
    /// Checks the time of the cut, and reads the path of the blade, if there is one.
    fn blade_path(&self, start: u32, frames: u32) -> Result<Option<(&Path, BladePath)>, Failure> {
        if start >= frames {
            return Err(Failure::CutAfterEnd);
        }
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
            contacts: self.contacts.then(|| ContactParams {
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
        surface: Surface,
        frames: u32,
        mut knife: Option<&mut Knife<'_>>,
        reporter: &Reporter<impl Write>,
    ) -> Result<(Scene, BodyId), Failure> {
        let path = &self.input;
        let failed = |source| Failure::Scene {
            path: path.clone(),
            source,
        };
        let mut scene = self.scene(surface.origin()[1]).map_err(failed)?;
        let body = scene.add_body(surface, &self.material()).map_err(failed)?;
        let a_second = whole(1.0 / self.dt).clamp(1, frames);
        let progress = reporter.progress(frames.div_ceil(a_second), a_second);
        for frame in 0..frames {
            if frame % a_second == 0 {
                progress.begin(&format!("from {:.3} s", f64::from(frame) * self.dt));
            }
            if let Some(knife) = &mut knife {
                knife.before_frame(frame, &mut scene, body)?;
            }
            let stats = *scene.step().map_err(failed)?;
            if stats.fell_back {
                progress.suspend(|| warn_of_fallback(&scene, reporter));
            }
            if let Some(knife) = &mut knife {
                knife.after_frame(frame, &mut scene, body)?;
            }
            progress.step();
        }
        progress.end();
        scene.read_back(body).map_err(failed)?;
        Ok((scene, body))
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
