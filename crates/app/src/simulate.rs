//! `incise simulate`: drops a mesh as a soft body, optionally cuts it, and writes its pieces.

use crate::clock::{milliseconds, timed};
use crate::cut_options::plane_sweep;
use crate::failure::Failure;
use crate::input::{InputOptions, file_bounds};
use crate::json::{all_lossy, lossy};
use crate::numbers::{Numbers, counted, numbers, positive};
use crate::pieces::{self, Piece, output_path};
use crate::reporter::Reporter;
use clap::ValueEnum;
use incise_mesh::geometry::round_to_f32;
use incise_mesh::{Aabb, Surface, Warning};
use incise_pbd_gpu::{InteriorSprings, Material, SolverParams, Volume};
use incise_scene::{
    BackendChoice, BackendRequest, BodyId, ContactParams, Scene, SceneError, SceneParams,
};
use serde::Serialize;
use std::io::{self, Write};
use std::path::PathBuf;

/// Drops a mesh as a soft body, optionally cuts it at a given time, and writes its pieces.
///
/// Writes one piece per file: `DIR/piece_000.obj` and so on. Files of these names from
/// an earlier run are overwritten or removed. The y axis points up. Without --volume or
/// --interior-springs the body is a shell, which collapses under its weight.
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
    #[arg(long, value_name = "NX,NY,NZ,D", value_parser = numbers::<4>, allow_hyphen_values = true)]
    plane: Option<Numbers<4>>,
    /// Time of the cut [s]; 0 by default.
    #[arg(long, value_name = "S", value_parser = positive, requires = "plane")]
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

JSON report (--json): input, warnings, backend, device, fallback_reason, frames, dt, iterations,
substeps, triangles_hit, pieces (file, vertices, triangles, area, volume, cavity of each), removed,
milliseconds.

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

/// The result of a simulation.
struct Simulated {
    scene: Scene,
    body: BodyId,
    triangles_hit: Option<usize>,
    /// Bounding box at the time of the cut, else empty.
    bounds_at_cut: Aabb,
}

/// Runs the command.
pub(crate) fn run(
    arguments: &SimulateArguments,
    reporter: &mut Reporter<impl Write>,
) -> Result<(), Failure> {
    let path = &arguments.input;
    let frames = whole(arguments.seconds / arguments.dt).max(1);
    let cut_at = arguments
        .plane
        .map(|_| whole(arguments.at.unwrap_or(0.0) / arguments.dt));
    if cut_at.is_some_and(|frame| frame >= frames) {
        return Err(Failure::CutAfterEnd);
    }
    let (surface, warnings) = arguments.reading.read_closed(path)?;
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
    let (simulate, simulated) = timed(|| arguments.simulate(surface, frames, cut_at, reporter));
    let simulated = simulated?;
    let failed = |source| Failure::Scene {
        path: path.clone(),
        source,
    };
    let body = simulated.scene.body(simulated.body).map_err(failed)?;
    let surface = body.surface();
    let (write, written) = timed(|| pieces::write(surface, path, &arguments.output));
    let written = written?;
    let backend = simulated.scene.backend_report();
    let is_on_device = backend.gpu_bodies.contains(&simulated.body);
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
        triangles_hit: simulated.triangles_hit,
        pieces: written.pieces,
        removed: written.removed,
        milliseconds: Times {
            simulate: milliseconds(simulate),
            write: milliseconds(write),
        },
    };
    reporter.report(&report, print)?;
    if report.triangles_hit == Some(0) {
        return Err(Failure::Missed {
            path: path.clone(),
            bounds: simulated.bounds_at_cut,
            output: "the files hold the uncut body",
        });
    }
    Ok(())
}

impl SimulateArguments {
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
            contacts: self.contacts.then(ContactParams::default),
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
        cut_at: Option<u32>,
        reporter: &Reporter<impl Write>,
    ) -> Result<Simulated, Failure> {
        let path = &self.input;
        let failed = |source| Failure::Scene {
            path: path.clone(),
            source,
        };
        let mut scene = self.scene(surface.origin()[1]).map_err(failed)?;
        let body = scene.add_body(surface, &self.material()).map_err(failed)?;
        let (mut triangles_hit, mut bounds_at_cut) = (None, Aabb::default());
        let a_second = whole(1.0 / self.dt).clamp(1, frames);
        let progress = reporter.progress(frames.div_ceil(a_second), a_second);
        for frame in 0..frames {
            if frame % a_second == 0 {
                progress.begin(&format!("from {:.3} s", f64::from(frame) * self.dt));
            }
            let cuts = cut_at == Some(frame);
            if cuts {
                scene.read_back(body).map_err(failed)?;
                bounds_at_cut = self.aim(&mut scene, body)?;
            }
            let stats = *scene.step().map_err(failed)?;
            if stats.fell_back {
                progress.suspend(|| warn_of_fallback(&scene, reporter));
            }
            if cuts {
                triangles_hit = Some(stats.hit_triangles);
                if let Some(refusal) = scene.failed_cuts().first() {
                    return Err(Failure::Cut {
                        path: path.clone(),
                        source: refusal.error,
                    });
                }
            }
            progress.step();
        }
        progress.end();
        scene.read_back(body).map_err(failed)?;
        Ok(Simulated {
            scene,
            body,
            triangles_hit,
            bounds_at_cut,
        })
    }

    /// Adds a blade that sweeps along the plane through the whole body in the next frame, and
    /// returns the body's bounding box.
    fn aim(&self, scene: &mut Scene, body: BodyId) -> Result<Aabb, Failure> {
        let Some(plane) = self.plane else {
            return Ok(Aabb::default());
        };
        let failed = |source| Failure::Scene {
            path: self.input.clone(),
            source,
        };
        let surface = scene.body(body).map_err(failed)?.surface();
        let sweep = plane_sweep(plane, surface, &self.input)?;
        let bounds = file_bounds(surface);
        let [before, after] = sweep.ends();
        let blade = scene.add_blade(before);
        let moved = scene.move_blade(blade, after);
        moved.map_err(failed)?;
        Ok(bounds)
    }
}

/// Warns that the scene continues on the CPU.
fn warn_of_fallback(scene: &Scene, reporter: &Reporter<impl Write>) {
    let report = scene.backend_report();
    if let Some(why) = report.fallback_reason {
        reporter.warn(format_args!("continuing on the CPU: {why}"));
    }
}

fn print(report: &Report, out: &mut impl Write) -> io::Result<()> {
    writeln!(
        out,
        "{}: {} of {:.6} s on {}",
        report.input.display(),
        counted(
            usize::try_from(report.frames).unwrap_or(usize::MAX),
            "frame"
        ),
        report.dt,
        report.device.as_deref().unwrap_or("the CPU")
    )?;
    if let Some(hits @ 1..) = report.triangles_hit {
        writeln!(out, "  {} hit", counted(hits, "triangle"))?;
    }
    pieces::print(&report.pieces, &report.removed, out)?;
    let t = &report.milliseconds;
    writeln!(
        out,
        "  ms: simulate {:.2}, write {:.2}",
        t.simulate, t.write
    )
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a saturating cast of a number that is not negative"
)]
fn whole(x: f64) -> u32 {
    x.round() as u32
}
