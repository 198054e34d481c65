//! The paper's protocol (section 4) on one model.
//!
//! Two runs of the same length: the solver alone, and the solver with a blade that moves every
//! frame and slices the largest piece once a simulated second. The scene is weightless, and the
//! body starts with a spin and a squeeze: a hollow surface with stretch and bending alone collapses
//! under gravity.
//!
//! The scene's blade cuts by the exact method. The paper's method cuts the body in the same place
//! of the frame with [`Scene::cut_with`], while the blade rests, and the same stages are timed.
//!
//! On a GPU a frame ends when the GPU is done; the first, which compiles kernels, is not timed. Far
//! sweeps are skipped by the body's box, because a body that is read back every frame would not
//! stay on the GPU. The time of a cut includes readback and upload. Errors are sampled before each
//! slice, where the body is read back anyway.

use super::Parameters;
use super::paper::PaperRow;
use crate::measure::{Times, allocations};
use crate::method::Method;
use crate::models::Loaded;
use crate::motion;
use crate::statistics::mean;
use incise_cut::{CutOutcome, Sweep};
use incise_mesh::geometry::{area_vector, to_f32};
use incise_mesh::{AngleStats, Surface, Vec3};
use incise_models::scenes::Directions;
use incise_paper::{PaperError, PaperParams};
use incise_pbd_gpu::{InteriorSprings, Material, Volume};
use incise_scene::{
    BackendRequest, BladeId, BladeMode, Body, BodyId, FrameStats, Scene, SceneError,
};
use serde::Serialize;
use std::error::Error;
use std::time::{Duration, Instant};

/// Distance of the idle blade from the body, in diagonals of its box.
const HOVER: f64 = 100.0;

/// A row of the table.
#[derive(Debug, Serialize)]
pub(super) struct Row {
    source: String,
    vertices: usize,
    particles: usize,
    triangles: usize,
    /// Triangles after the last cut of PBD + CS.
    triangles_after: usize,
    /// GPU schedule at the start; none on the CPU.
    schedule: Option<&'static str>,
    /// Mean upload and readback of a frame with a cut; none on the CPU.
    bytes_uploaded_a_cut: Option<f64>,
    bytes_read_a_cut: Option<f64>,
    /// Whether sweeps outside of the body's box are skipped.
    skips_far_sweeps: bool,
    pbd_fps: f64,
    pbd_cs_fps: f64,
    fps_difference_percent: f64,
    cut_ms_mean: f64,
    cut_ms_p99: f64,
    paper: PaperRow,
    /// How many times better than the paper.
    gain: PaperRow,
    cuts: usize,
    cuts_refused: Vec<String>,
    stretch_error_percent: f64,
    volume_error_percent: f64,
    /// The smallest angle of all cap triangles.
    cap_min_angle_deg: f64,
    /// Heap allocations of all frames without a cut, except the first of a run.
    allocations: usize,
    /// Frame rate of every simulated second; none for a second without a timed frame.
    pbd_fps_by_second: Vec<Option<f64>>,
    pbd_cs_fps_by_second: Vec<Option<f64>>,
}

/// Measurements of a run.
#[derive(Default)]
struct Run {
    /// Work of every frame \[s\]; NaN for one that is not timed.
    work: Times,
    device: Option<String>,
    schedule: Option<&'static str>,
    bytes_uploaded: Vec<f64>,
    bytes_read: Vec<f64>,
    cuts: Times,
    refused: Vec<String>,
    stretch_error: f64,
    /// Number of samples.
    samples: u32,
    volume_error: f64,
    cap_min_angle: f64,
    allocations: usize,
    triangles_after: usize,
}

/// Returns frames per second of the timed frames; none if no frame is timed.
fn rate(work: &[f64]) -> Option<f64> {
    let timed = work.iter().filter(|seconds| seconds.is_finite());
    let sum: f64 = timed.clone().sum();
    (sum > 0.0).then(|| timed.count() as f64 / sum)
}

impl Run {
    fn fps(&self) -> f64 {
        rate(&self.work.0).unwrap_or(f64::NAN)
    }

    /// Returns the frame rates of every simulated second of some frames.
    fn fps_by_second(&self, frames: u32) -> Vec<Option<f64>> {
        self.work.0.chunks(frames as usize).map(rate).collect()
    }

    fn sample(&mut self, body: &Body) {
        self.stretch_error += body.solver().stretch_error(body.surface());
        self.samples += 1;
    }

    /// Returns the mean of all samples.
    fn mean_stretch_error(&self) -> f64 {
        self.stretch_error / f64::from(self.samples)
    }
}

/// Runs both halves of the protocol; calls `tick` after every frame. Returns the GPU, if any, and
/// the row.
pub(super) fn run(
    loaded: &Loaded,
    parameters: &Parameters,
    request: &BackendRequest,
    tick: &dyn Fn(),
) -> Result<(Option<String>, Row), Box<dyn Error>> {
    let pbd = run_scene(loaded, parameters, request, false, tick)?;
    let cs = run_scene(loaded, parameters, request, true, tick)?;
    let a_second = nearest(1.0 / parameters.dt).max(1);
    let paper = PaperRow::of(loaded.model);
    let ours = PaperRow {
        pbd_fps: pbd.fps(),
        pbd_cs_fps: cs.fps(),
        fps_difference_percent: (1.0 - cs.fps() / pbd.fps()) * 100.0,
        cut_ms: mean(&cs.cuts.0) * 1e3,
    };
    let is_on_gpu = pbd.device.is_some();
    let row = Row {
        source: loaded.source.clone(),
        vertices: loaded.vertices,
        particles: loaded.surface.topology().vertex_count(),
        triangles: loaded.surface.topology().triangle_count(),
        triangles_after: cs.triangles_after,
        schedule: pbd.schedule,
        bytes_uploaded_a_cut: is_on_gpu.then(|| mean(&cs.bytes_uploaded)),
        bytes_read_a_cut: is_on_gpu.then(|| mean(&cs.bytes_read)),
        skips_far_sweeps: is_on_gpu,
        pbd_fps: ours.pbd_fps,
        pbd_cs_fps: ours.pbd_cs_fps,
        fps_difference_percent: ours.fps_difference_percent,
        cut_ms_mean: ours.cut_ms,
        cut_ms_p99: cs.cuts.percentile(99) * 1e3,
        gain: paper.gain(&ours),
        paper,
        cuts: cs.cuts.0.len(),
        stretch_error_percent: cs.mean_stretch_error().max(pbd.mean_stretch_error()) * 100.0,
        volume_error_percent: cs.volume_error * 100.0,
        cap_min_angle_deg: cs.cap_min_angle,
        allocations: pbd.allocations + cs.allocations,
        pbd_fps_by_second: pbd.fps_by_second(a_second),
        pbd_cs_fps_by_second: cs.fps_by_second(a_second),
        cuts_refused: cs.refused,
    };
    Ok((pbd.device, row))
}

fn run_scene(
    loaded: &Loaded,
    parameters: &Parameters,
    request: &BackendRequest,
    cutting: bool,
    tick: &dyn Fn(),
) -> Result<Run, Box<dyn Error>> {
    let (mut scene, body) = set_up(loaded, parameters, request)?;
    let report = scene.backend_report();
    let on_device = report.gpu_bodies.contains(&body);
    scene.params.skip_far_sweeps = on_device;
    let diagonal = loaded.surface.bounds().diagonal();
    let blade = cutting.then(|| scene.add_blade(hover(diagonal, 0)));
    if let Some(blade) = blade {
        // The paper's blade cuts full slices.
        scene.set_blade_mode(blade, BladeMode::FullSlices)?;
    }
    let volume = rest_volume(scene.body(body)?.surface());
    let a_second = nearest(1.0 / parameters.dt).max(1);
    let mut directions = Directions(parameters.seed);
    let mut run = Run {
        device: report.adapter.filter(|_| on_device),
        cap_min_angle: f64::INFINITY,
        // Recording allocates nothing.
        work: Times(Vec::with_capacity(parameters.frames() as usize)),
        ..Run::default()
    };
    // A failed slice is repeated in the next frame with the next direction.
    let mut due = false;
    for frame in 1..=parameters.frames() {
        due |= cutting && frame % a_second == 0;
        let slices = due;
        let before = allocations();
        let mut readback = Duration::ZERO;
        if on_device && (slices || frame % a_second == 0) {
            // The sweep follows from the body's positions.
            let begin = Instant::now();
            scene.read_back(body)?;
            readback = begin.elapsed();
            run.sample(scene.body(body)?);
        }
        let mut by_paper = None;
        if let Some(blade) = blade {
            if slices {
                let (sweep, piece) = aim(&mut scene, body, blade, &mut directions)?;
                match parameters.caps.method() {
                    Method::Exact(_) => {
                        let [_, after] = sweep.ends();
                        scene.move_blade(blade, after)?;
                    }
                    Method::Paper(params) => {
                        let only_piece = Some(piece);
                        by_paper = Some((
                            sweep,
                            PaperParams {
                                only_piece,
                                ..params
                            },
                        ));
                    }
                }
            } else {
                scene.set_blade_piece(blade, None)?;
                scene.move_blade(blade, hover(diagonal, frame))?;
            }
        }
        let volume_before = if slices {
            rest_volume(scene.body(body)?.surface())
        } else {
            0.0
        };
        let begin = Instant::now();
        scene.cut()?;
        let cut = match by_paper {
            Some((sweep, params)) => Some(scene.cut_with(body, &sweep, |cutter, surface| {
                incise_paper::cut(cutter, surface, &sweep, &params).map(|outcome| outcome.cut)
            })?),
            None => None,
        };
        let mut work = begin.elapsed();
        // Caps are judged before they move.
        if slices {
            work += readback;
            judge_caps(&scene, body, cut.as_ref(), &mut run)?;
        }
        let begin = Instant::now();
        scene.advance()?;
        scene.wait_for_gpu()?;
        work += begin.elapsed();
        if frame > 1 || !on_device {
            run.work.0.push(work.as_secs_f64());
        } else {
            run.work.0.push(f64::NAN);
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
            )?;
            due = scene.stats().cuts == 0;
            scene.teleport_blade(blade, hover(diagonal, frame))?;
        } else if frame > 1 {
            run.allocations += allocations() - before;
        }
        if !on_device {
            run.sample(scene.body(body)?);
        }
        tick();
    }
    if on_device {
        scene.read_back(body)?;
        run.sample(scene.body(body)?);
    }
    let surface = scene.body(body)?.surface();
    run.triangles_after = surface.topology().triangle_count();
    Ok(run)
}

/// Returns the schedule of the body on the GPU.
fn schedule(stats: &FrameStats) -> Option<&'static str> {
    let counts = [
        (stats.whole_bodies, "whole-body"),
        (stats.patch_bodies, "patches"),
    ];
    let used = counts.into_iter().find(|(bodies, _)| *bodies > 0);
    used.map(|(_, name)| name)
}

fn set_up(
    loaded: &Loaded,
    parameters: &Parameters,
    request: &BackendRequest,
) -> Result<(Scene, BodyId), Box<dyn Error>> {
    let mut scene = Scene::with_backend(parameters.scene(), request)?;
    let material = Material {
        volume: parameters.volume.then(Volume::default),
        interior_springs: parameters.interior_springs.then(InteriorSprings::default),
        ..motion::material()
    };
    let body = scene.add_body(loaded.surface.clone(), &material)?;
    let (solver, surface) = scene.edit(body)?.solver_mut();
    motion::start(solver, surface)?;
    Ok((scene, body))
}

/// Puts the blade at the start of a sweep through the middle of the largest piece; returns the
/// sweep and the piece.
fn aim(
    scene: &mut Scene,
    body: BodyId,
    blade: BladeId,
    directions: &mut Directions,
) -> Result<(Sweep, u32), Box<dyn Error>> {
    let surface = scene.body(body)?.surface();
    let volumes = surface.piece_volumes();
    let largest = (0u32..)
        .zip(&volumes)
        .max_by(|x, y| x.1.abs().total_cmp(&y.1.abs()))
        .map_or(0, |(piece, _)| piece);
    let piece = surface.extract_piece(largest);
    let bounds = piece.bounds();
    let normal = directions.next_unit();
    let sweep = Sweep::from_plane(normal.into(), normal.dot(&middle(&piece)), &bounds)?;
    let [before, after] = sweep.ends();
    scene.teleport_blade(blade, before)?;
    scene.set_blade_piece(blade, Some(largest))?;
    Ok((Sweep::new(before, after)?, largest))
}

/// Returns the area-weighted middle of a surface \[m\].
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

/// Records the angles of caps, and the reason why the paper's method refused a cut.
fn judge_caps(
    scene: &Scene,
    body: BodyId,
    by_paper: Option<&Result<CutOutcome, PaperError>>,
    run: &mut Run,
) -> Result<(), SceneError> {
    let surface = scene.body(body)?.surface();
    if let Some(Err(error)) = by_paper {
        run.refused.push(error.to_string());
    }
    let cuts = scene.cuts().iter().filter_map(|sweep| sweep.cut.as_ref());
    let outcomes = cuts.map(|(_, outcome)| outcome);
    for outcome in outcomes.chain(by_paper.into_iter().flatten()) {
        let cap = outcome.cap.iter().map(|&t| surface.triangle_positions(t));
        run.cap_min_angle = run.cap_min_angle.min(AngleStats::from_triangles(cap).min);
    }
    Ok(())
}

fn after_slice(
    scene: &Scene,
    body: BodyId,
    readback: Duration,
    before: f64,
    volume: f64,
    run: &mut Run,
) -> Result<(), SceneError> {
    let stats = scene.stats();
    let refusals = scene.failed_cuts().iter();
    run.refused.extend(refusals.map(|r| r.error.to_string()));
    for _ in 0..stats.cuts {
        let cost = stats.cutting() + readback;
        run.cuts.0.push(cost.as_secs_f64());
        run.bytes_uploaded.push(stats.bytes_uploaded as f64);
        run.bytes_read.push(stats.bytes_read as f64);
    }
    let after = rest_volume(scene.body(body)?.surface()) / volume;
    run.volume_error += (after - before).abs();
    Ok(())
}

/// Returns the position of the idle blade, which moves every frame \[m\].
fn hover(diagonal: f64, frame: u32) -> [[f32; 3]; 2] {
    let angle = f64::from(frame) * 0.1;
    let reach = HOVER * diagonal;
    let out = Vec3::new(angle.cos(), 0.0, angle.sin()) * reach;
    let along = Vec3::new(0.0, diagonal / 2.0, 0.0);
    [to_f32(out - along), to_f32(out + along)]
}

/// Returns the enclosed volume at rest positions \[m^3\].
fn rest_volume(surface: &Surface) -> f64 {
    surface.rest_volume_of(surface.topology().triangles())
}

/// Rounds a positive number.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a saturating cast of a positive number"
)]
pub(super) fn nearest(x: f64) -> u32 {
    x.round() as u32
}

#[cfg(test)]
mod tests {
    use super::super::TableArguments;
    use super::*;
    use crate::models;
    use clap::Parser;
    use incise_scene::BackendChoice;

    #[derive(Parser)]
    struct Program {
        #[command(flatten)]
        table: TableArguments,
    }

    #[test]
    fn each_method_slices_once_a_second() {
        let request = BackendRequest {
            choice: BackendChoice::Cpu,
            ..BackendRequest::default()
        };
        for method in ["exact", "paper"] {
            let line = ["table", "--only", "Sphere80", "--method", method];
            let arguments = Program::parse_from(line).table;
            let mut parameters = arguments.parameters;
            parameters.seconds = 2.5;
            let loaded = models::load(&arguments.models).unwrap();
            let (_, row) = run(&loaded[0], &parameters, &request, &|| ()).unwrap();
            assert_eq!((row.cuts, row.cuts_refused.len()), (2, 0), "{method}");
            assert!(row.cut_ms_mean > 0.0 && row.cap_min_angle_deg.is_finite());
            // The paper's method removes the triangles that the blade hits.
            let has_lost_volume = row.volume_error_percent > 0.1;
            assert_eq!(has_lost_volume, method == "paper", "{row:?}");
        }
    }
}
