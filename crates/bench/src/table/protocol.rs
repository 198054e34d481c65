//! The paper's protocol (section 4) on one model.
//!
//! Two runs of the same length: the solver alone, and the solver with a blade that moves every
//! frame and slices the largest piece once a simulated second. The scene is weightless, and the
//! body starts with a spin and a squeeze: a hollow surface with stretch and bending alone cannot
//! carry itself, and a heap on the ground would be another test than the paper's figures show.
//!
//! On a device a frame is timed until the device is done with it, the first frame left out, in which
//! kernels are compiled. Far sweeps are skipped by the device's box, since a body that is read in
//! every frame would not live there. A cut costs everything from the readback to the update of the
//! device. Errors are measured before each slice only, where the body is read anyway.

use super::TableArguments;
use super::row::Row;
use crate::allocations;
use crate::directions::Directions;
use crate::models::Loaded;
use crate::motion;
use crate::pace::Pace;
use crate::statistics::{mean, percentile_99};
use incise_cut::Sweep;
use incise_mesh::geometry::{area_vector, round};
use incise_mesh::{AngleStats, Surface, Vec3};
use incise_pbd_gpu::{Material, SolverParams, Struts, Volume};
use incise_scene::{
    BackendRequest, BladeId, Body, BodyId, ContactParams, FrameStats, Scene, SceneParams,
};
use std::error::Error;
use std::time::{Duration, Instant};

/// How far from the body the blade hovers, in diagonals of its box.
const HOVER: f64 = 100.0;

/// What a run measured.
#[derive(Default)]
struct Run {
    /// Frames that were timed.
    frames: u32,
    work: Duration,
    pace: Pace,
    device: Option<String>,
    schedule: Option<&'static str>,
    bytes_uploaded: Vec<f64>,
    bytes_read: Vec<f64>,
    cut_ms: Vec<f64>,
    refused: Vec<String>,
    stretch_error: f64,
    /// How often it was measured.
    samples: u32,
    volume_error: f64,
    cap_min_angle: f64,
    allocations: usize,
    triangles_after: usize,
}

impl Run {
    fn fps(&self) -> f64 {
        f64::from(self.frames) / self.work.as_secs_f64()
    }

    fn sample(&mut self, body: &Body) {
        self.stretch_error += body.solver().stretch_error(body.surface());
        self.samples += 1;
    }

    /// The mean of all samples.
    fn mean_stretch_error(&self) -> f64 {
        self.stretch_error / f64::from(self.samples)
    }
}

/// Runs both halves of the protocol; `tick` is called after every frame.
pub(crate) fn run(
    loaded: &Loaded,
    arguments: &TableArguments,
    request: &BackendRequest,
    machine: &str,
    commit: &str,
    tick: &dyn Fn(),
) -> Result<Row, Box<dyn Error>> {
    let pbd = run_scene(loaded, arguments, request, false, tick)?;
    let cs = run_scene(loaded, arguments, request, true, tick)?;
    let mut cut_ms = cs.cut_ms.clone();
    cut_ms.sort_by(f64::total_cmp);
    Ok(Row {
        model: loaded.model.name(),
        source: loaded.source.clone(),
        vertices: loaded.vertices,
        particles: loaded.surface.topology().vertex_count(),
        triangles: loaded.surface.topology().triangle_count(),
        triangles_after: cs.triangles_after,
        backend: arguments.backend.name(),
        bytes_uploaded_a_cut: pbd.device.is_some().then(|| mean(&cs.bytes_uploaded)),
        bytes_read_a_cut: pbd.device.is_some().then(|| mean(&cs.bytes_read)),
        skips_far_sweeps: pbd.device.is_some(),
        schedule: pbd.schedule,
        stretch_error_percent: cs.mean_stretch_error().max(pbd.mean_stretch_error()) * 100.0,
        device: pbd.device.clone().unwrap_or_else(|| machine.to_owned()),
        pbd_fps: pbd.fps(),
        pbd_cs_fps: cs.fps(),
        pbd_fps_by_second: pbd.pace.rates(),
        pbd_cs_fps_by_second: cs.pace.rates(),
        fps_difference_percent: (1.0 - cs.fps() / pbd.fps()) * 100.0,
        cut_ms_mean: mean(&cut_ms),
        cut_ms_p99: percentile_99(&cut_ms),
        cuts: cut_ms.len(),
        cuts_refused: cs.refused,
        volume_error_percent: cs.volume_error * 100.0,
        cap_min_angle_deg: cs.cap_min_angle,
        allocations: pbd.allocations + cs.allocations,
        machine: machine.to_owned(),
        commit: commit.to_owned(),
        version: env!("CARGO_PKG_VERSION"),
        dt: arguments.dt,
        iterations: arguments.iterations,
        seconds: arguments.seconds,
        method: arguments.method.name(),
        level: arguments.level.z(),
        seed: arguments.seed,
        volume: arguments.volume,
        struts: arguments.struts,
        contacts: arguments.contacts,
    })
}

/// Frames of one run.
pub(crate) fn frames(arguments: &TableArguments) -> u32 {
    whole(arguments.seconds / arguments.dt)
}

fn run_scene(
    loaded: &Loaded,
    arguments: &TableArguments,
    request: &BackendRequest,
    cutting: bool,
    tick: &dyn Fn(),
) -> Result<Run, Box<dyn Error>> {
    let (mut scene, body) = set_up(loaded, arguments, request)?;
    let report = scene.backend_report();
    let on_device = report.on_device.contains(&body);
    scene.params.skip_far_sweeps = on_device;
    let diagonal = loaded.surface.bounds().diagonal();
    let blade = cutting.then(|| scene.add_blade(hover(diagonal, 0)));
    let volume = rest_volume(scene.body(body).surface());
    let a_second = whole(1.0 / arguments.dt).max(1);
    let mut directions = Directions(arguments.seed);
    let mut run = Run {
        device: report.device.filter(|_| on_device),
        cap_min_angle: f64::INFINITY,
        pace: Pace::of(frames(arguments), a_second),
        ..Run::default()
    };
    // A refused slice is tried again in the next frame, in the next direction.
    let mut due = false;
    for frame in 1..=frames(arguments) {
        due |= cutting && frame % a_second == 0;
        let slices = due;
        let before = allocations::count();
        let mut readback = Duration::ZERO;
        if on_device && (slices || frame % a_second == 0) {
            // Where the sweep goes depends on where the body is: what the cut needs comes now.
            let begin = Instant::now();
            scene.read(body)?;
            readback = begin.elapsed();
            run.sample(scene.body(body));
        }
        if let Some(blade) = blade {
            if slices {
                let sweep = aim(&mut scene, body, blade, &mut directions)?;
                let [_, _, end, start] = sweep.corners();
                scene.move_blade(blade, [start, end]);
            } else {
                scene.set_blade_piece(blade, None);
                scene.move_blade(blade, hover(diagonal, frame));
            }
        }
        let volume_before = if slices {
            rest_volume(scene.body(body).surface())
        } else {
            0.0
        };
        let begin = Instant::now();
        scene.cut()?;
        let mut work = begin.elapsed();
        // A cap is judged as it was made, before it moves.
        if slices {
            work += readback;
            judge_caps(&scene, body, &mut run);
        }
        let begin = Instant::now();
        scene.advance()?;
        scene.wait()?;
        work += begin.elapsed();
        if frame > 1 || !on_device {
            run.work += work;
            run.pace.note(frame, work);
            run.frames += 1;
        } else {
            run.schedule = schedule(scene.stats());
        }
        if let Some(blade) = blade.filter(|_| slices) {
            after_slice(
                &scene,
                body,
                readback,
                volume_before / volume,
                volume,
                &mut run,
            );
            due = scene.outcomes().is_empty();
            scene.jump_blade(blade, hover(diagonal, frame));
        } else if frame > 1 {
            run.allocations += allocations::count() - before;
        }
        if !on_device {
            run.sample(scene.body(body));
        }
        tick();
    }
    if on_device {
        scene.read(body)?;
        run.sample(scene.body(body));
    }
    let surface = scene.body(body).surface();
    run.triangles_after = surface.topology().triangle_count();
    Ok(run)
}

/// How the device steps its one body.
fn schedule(stats: &FrameStats) -> Option<&'static str> {
    let counts = [
        (stats.whole_bodies, "whole-body"),
        (stats.color_bodies, "colors"),
        (stats.patch_bodies, "patches"),
    ];
    let used = counts.into_iter().find(|(bodies, _)| *bodies > 0);
    used.map(|(_, name)| name)
}

fn set_up(
    loaded: &Loaded,
    arguments: &TableArguments,
    request: &BackendRequest,
) -> Result<(Scene, BodyId), Box<dyn Error>> {
    let mut scene = Scene::with_backend(params(arguments), request)?;
    let material = Material {
        volume: arguments.volume.then(Volume::default),
        struts: arguments.struts.then(Struts::default),
        ..motion::material()
    };
    let body = scene.add_body(loaded.surface.clone(), &material)?;
    let (solver, surface) = scene.edit(body)?.solver_mut();
    motion::start(solver, surface)?;
    Ok((scene, body))
}

/// How frames are stepped and cut.
pub(crate) fn params(arguments: &TableArguments) -> SceneParams {
    SceneParams {
        dt: narrow(arguments.dt),
        solver: SolverParams {
            iterations: arguments.iterations,
            gravity: [0.0; 3],
            ..SolverParams::paper()
        },
        cut: arguments.method.params(arguments.level),
        // The paper tests every triangle in every frame; its table is no place to skip that.
        skip_far_sweeps: false,
        // A readback in between would be timed with a frame that has none.
        checkpoint: 0,
        contacts: arguments.contacts.then(ContactParams::default),
        // The paper steps whatever it has, at rest or not.
        sleep: None,
    }
}

/// Puts the blade at the start of a sweep through the middle of the largest piece.
fn aim(
    scene: &mut Scene,
    body: BodyId,
    blade: BladeId,
    directions: &mut Directions,
) -> Result<Sweep, Box<dyn Error>> {
    let surface = scene.body(body).surface();
    let volumes = surface.piece_volumes();
    let largest = (0u32..)
        .zip(&volumes)
        .max_by(|x, y| x.1.abs().total_cmp(&y.1.abs()))
        .map_or(0, |(piece, _)| piece);
    let piece = surface.extract_piece(largest);
    let bounds = piece.bounds();
    let normal = directions.next_unit();
    let sweep = Sweep::across_box(normal.into(), normal.dot(&middle(&piece)), &bounds)?;
    let [start, end, _, _] = sweep.corners();
    scene.jump_blade(blade, [start, end]);
    scene.set_blade_piece(blade, Some(largest));
    Ok(sweep)
}

/// The area-weighted middle of a surface.
fn middle(surface: &Surface) -> Vec3 {
    let (mut sum, mut area) = (Vec3::zeros(), 0.0);
    for t in surface.topology().triangles() {
        let [a, b, c] = surface.triangle_positions(t);
        let weight = area_vector([a, b, c]).norm();
        sum += (a + b + c) / 3.0 * weight;
        area += weight;
    }
    sum / area
}

fn judge_caps(scene: &Scene, body: BodyId, run: &mut Run) {
    let surface = scene.body(body).surface();
    for (_, outcome) in scene.outcomes() {
        let cap = outcome.cap.iter().map(|&t| surface.triangle_positions(t));
        run.cap_min_angle = run.cap_min_angle.min(AngleStats::of(cap).min);
    }
}

fn after_slice(
    scene: &Scene,
    body: BodyId,
    readback: Duration,
    before: f64,
    volume: f64,
    run: &mut Run,
) {
    let stats = scene.stats();
    let refusals = scene.refusals().iter();
    run.refused.extend(refusals.map(|r| r.error.to_string()));
    for _ in scene.outcomes() {
        let cost = stats.cutting() + readback;
        run.cut_ms.push(cost.as_secs_f64() * 1e3);
        run.bytes_uploaded.push(stats.bytes_uploaded as f64);
        run.bytes_read.push(stats.bytes_read as f64);
    }
    let after = rest_volume(scene.body(body).surface()) / volume;
    run.volume_error += (after - before).abs();
}

/// The blade above the body, a little further on its way every frame.
fn hover(diagonal: f64, frame: u32) -> [[f32; 3]; 2] {
    let angle = f64::from(frame) * 0.1;
    let reach = HOVER * diagonal;
    let out = Vec3::new(angle.cos(), 0.0, angle.sin()) * reach;
    let along = Vec3::new(0.0, diagonal / 2.0, 0.0);
    [round(out - along), round(out + along)]
}

/// The volume that the body encloses at rest \[m^3\]: free of what the motion does to it.
fn rest_volume(surface: &Surface) -> f64 {
    surface.rest_volume_of(surface.topology().triangles())
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a saturating cast of a positive number"
)]
fn whole(x: f64) -> u32 {
    x.round() as u32
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "a time step is rounded to storage"
)]
fn narrow(x: f64) -> f32 {
    x as f32
}
