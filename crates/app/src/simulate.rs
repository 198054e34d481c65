//! `incise simulate`: lets a mesh fall as a soft body, cuts it on the way if asked to, and writes its
//! pieces.

use crate::clock::{milliseconds, timed};
use crate::failure::Failure;
use crate::json::{all_lossy, lossy};
use crate::numbers::{Numbers, numbers, positive};
use crate::pieces::{self, Piece};
use crate::teller::Teller;
use clap::ValueEnum;
use incise_cut::Sweep;
use incise_mesh::{Surface, read_mesh};
use incise_pbd_gpu::{Material, SolverParams, Struts, Volume};
use incise_scene::{
    BackendChoice, BackendRequest, BodyId, ContactParams, Scene, SceneError, SceneParams,
};
use serde::Serialize;
use std::io::{self, Write};
use std::path::PathBuf;

/// Lets a mesh fall as a soft body, cuts it on the way if asked to, and writes its pieces.
///
/// They go to `DIR/piece_000.obj` and on, one file a piece. Files of that name from an earlier run are overwritten or
/// removed. The y axis points up. A body is a shell unless --volume or --struts give it an inside.
#[derive(clap::Args)]
pub(crate) struct SimulateArguments {
    /// The mesh: obj, ply, stl, glb or gltf; units are meters.
    input: PathBuf,
    /// Simulated time.
    #[arg(long, value_name = "S", value_parser = positive)]
    seconds: f64,
    /// Time of a frame, as a number or a fraction.
    #[arg(long, value_name = "S", default_value = "1/60", value_parser = positive)]
    dt: f64,
    /// Iterations of the solver a substep.
    #[arg(long, value_name = "N", default_value_t = SolverParams::default().iterations, value_parser = clap::value_parser!(u32).range(1..))]
    iterations: u32,
    /// Substeps of a frame.
    #[arg(long, value_name = "N", default_value_t = SolverParams::default().substeps, value_parser = clap::value_parser!(u32).range(1..))]
    substeps: u32,
    /// Height of a ground that nothing sinks below; the mesh has to begin above it.
    #[arg(long, value_name = "H", value_parser = numbers::<1>, allow_hyphen_values = true)]
    ground: Option<Numbers<1>>,
    /// Every closed piece keeps the volume that it has at rest.
    #[arg(long)]
    volume: bool,
    /// Struts through the body hold its sides apart: so many a vertex, 0 to 1.
    #[arg(long, value_name = "DENSITY", value_parser = numbers::<1>)]
    struts: Option<Numbers<1>>,
    /// Pieces touch each other instead of passing through each other.
    #[arg(long)]
    contacts: bool,
    /// Cut along the plane `nx x + ny y + nz z = d`.
    #[arg(long, value_name = "NX,NY,NZ,D", value_parser = numbers::<4>, allow_hyphen_values = true)]
    plane: Option<Numbers<4>>,
    /// When to cut; at once by default.
    #[arg(long, value_name = "S", value_parser = positive, requires = "plane")]
    at: Option<f64>,
    /// What moves the body.
    #[arg(long, value_enum, default_value_t = Backend::Cpu)]
    backend: Backend,
    /// A part of the name of the GPU to take, see `incise devices`.
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
    /// Where the pieces go.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, ValueEnum)]
pub(crate) enum Backend {
    /// The processor.
    Cpu,
    /// A GPU.
    Gpu,
    /// A GPU if there is a real one and the body is large enough to gain, else the processor.
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
    backend: &'static str,
    /// What the body was on at the end; none for the processor.
    device: Option<String>,
    frames: u32,
    dt: f64,
    iterations: u32,
    substeps: u32,
    /// Triangles that the cut crossed; none without a cut.
    triangles_hit: Option<usize>,
    pieces: Vec<Piece>,
    /// Pieces of an earlier run that are there no more.
    #[serde(serialize_with = "all_lossy")]
    removed: Vec<PathBuf>,
    milliseconds: Times,
}

/// Time of each stage \[ms\].
#[derive(Serialize)]
struct Times {
    simulate: f64,
    write: f64,
}

/// What a simulation came to.
struct Simulated {
    scene: Scene,
    body: BodyId,
    triangles_hit: Option<usize>,
}

/// Simulates and writes.
pub(crate) fn run(
    arguments: &SimulateArguments,
    teller: &mut Teller<impl Write>,
) -> Result<(), Failure> {
    let path = &arguments.input;
    let frames = whole(arguments.seconds / arguments.dt).max(1);
    let cut_at = arguments
        .plane
        .map(|_| whole(arguments.at.unwrap_or(0.0) / arguments.dt));
    if cut_at.is_some_and(|frame| frame >= frames) {
        return Err(Failure::CutAfterEnd);
    }
    let data = read_mesh(path)?;
    let (surface, _) = data.into_surface().map_err(|source| Failure::NotFit {
        path: path.clone(),
        source,
    })?;
    let lowest = surface.bounds().min[1];
    if let Some(ground) = arguments.ground()
        && lowest < ground
    {
        let path = path.clone();
        return Err(Failure::BelowGround {
            path,
            lowest,
            ground,
        });
    }
    let (simulate, simulated) = timed(|| arguments.simulate(surface, frames, cut_at, teller));
    let simulated = simulated?;
    let surface = simulated.scene.body(simulated.body).surface();
    let (write, written) = timed(|| pieces::write(surface, path, &arguments.output));
    let written = written?;
    let backend = simulated.scene.backend_report();
    let is_on_device = backend.on_device.contains(&simulated.body);
    let report = Report {
        input: path.clone(),
        backend: backend.choice.name(),
        device: backend.device.filter(|_| is_on_device),
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
    Ok(teller.report(&report, arguments.json, print)?)
}

impl SimulateArguments {
    fn ground(&self) -> Option<f32> {
        self.ground.map(|Numbers([height])| narrow(height))
    }

    fn scene(&self) -> Result<Scene, SceneError> {
        let params = SceneParams {
            dt: narrow(self.dt),
            solver: SolverParams {
                iterations: self.iterations,
                substeps: self.substeps,
                ground: self.ground(),
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
            struts: self.struts.map(|Numbers([density])| Struts {
                density: narrow(density),
                ..Struts::default()
            }),
            ..Material::default()
        }
    }

    fn simulate(
        &self,
        surface: Surface,
        frames: u32,
        cut_at: Option<u32>,
        teller: &Teller<impl Write>,
    ) -> Result<Simulated, Failure> {
        let path = &self.input;
        let failed = |source| Failure::Scene {
            path: path.clone(),
            source,
        };
        let mut scene = self.scene().map_err(failed)?;
        let body = scene.add_body(surface, &self.material()).map_err(failed)?;
        let mut triangles_hit = None;
        let a_second = whole(1.0 / self.dt).clamp(1, frames);
        let progress = teller.progress(frames.div_ceil(a_second), a_second);
        for frame in 0..frames {
            if frame % a_second == 0 {
                progress.begin(&format!("from {:.3} s", f64::from(frame) * self.dt));
            }
            let cuts = cut_at == Some(frame);
            if cuts {
                scene.read(body).map_err(failed)?;
                self.aim(&mut scene, body)?;
            }
            let stats = *scene.step().map_err(failed)?;
            if stats.fell_back {
                progress.aside(|| say_why(&scene));
            }
            if cuts {
                triangles_hit = Some(stats.hits);
                if let Some(refusal) = scene.refusals().first() {
                    return Err(Failure::Cut {
                        path: path.clone(),
                        source: refusal.error,
                    });
                }
            }
            progress.step();
        }
        progress.end();
        scene.read(body).map_err(failed)?;
        Ok(Simulated {
            scene,
            body,
            triangles_hit,
        })
    }

    /// Has a blade sweep through the body, where it is now, in the next frame.
    fn aim(&self, scene: &mut Scene, body: BodyId) -> Result<(), Failure> {
        let Some(Numbers([x, y, z, d])) = self.plane else {
            return Ok(());
        };
        let bounds = scene.body(body).surface().bounds();
        let sweep = Sweep::across_box([x, y, z], d, &bounds).map_err(Failure::Sweep)?;
        let [start, end, end_after, start_after] = sweep.corners();
        let blade = scene.add_blade([start, end]);
        scene.move_blade(blade, [start_after, end_after]);
        Ok(())
    }
}

/// Tells people why the processor does what a GPU was to do.
fn say_why(scene: &Scene) {
    let report = scene.backend_report();
    let why = report.fallback.unwrap_or_default();
    // Without an error output nobody wants to know.
    let _ = writeln!(io::stderr(), "incise: going on with the CPU: {why}");
}

fn print(report: &Report, out: &mut impl Write) -> io::Result<()> {
    writeln!(
        out,
        "{}: {} frames of {:.6} s on {}",
        report.input.display(),
        report.frames,
        report.dt,
        report.device.as_deref().unwrap_or("the CPU")
    )?;
    match report.triangles_hit {
        Some(0) => writeln!(out, "  the cut misses the body")?,
        Some(hits) => writeln!(out, "  {hits} triangles hit")?,
        None => {}
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

#[expect(clippy::cast_possible_truncation, reason = "rounded to storage")]
fn narrow(x: f64) -> f32 {
    x as f32
}
