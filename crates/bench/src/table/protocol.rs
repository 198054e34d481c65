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

use super::{PaperRow, Parameters};
use crate::measure::{Times, allocations, mean};
use crate::models::Loaded;
use crate::motion;
use crate::options::Method;
use incise_cut::{CutOutcome, Sweep};
use incise_mesh::geometry::{area_vector, to_f32};
use incise_mesh::{AngleStats, Surface, Vec3};
use incise_models::scenes::Directions;
use incise_pbd_gpu::{InteriorSprings, Material, Volume};
use incise_scene::{BackendRequest, BladeId, BladeMode, BodyId, FrameStats, Scene, SceneError};
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

/// A run of the protocol with its measurements.
struct Run<'a> {
    parameters: &'a Parameters,
    scene: Scene,
    body: BodyId,
    /// Rest volume before all cuts \[m^3\].
    volume: f64,
    /// The GPU that has the body.
    gpu: Option<String>,
    /// Work of every frame \[s\]; NaN for one that is not timed.
    work: Times,
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
}

/// A slice of the largest piece.
struct Slice {
    sweep: Sweep,
    piece: u32,
    /// Rest volume of the body before the slice, relative to that before all.
    volume: f64,
}

/// Runs both halves of the protocol; calls `tick` after every frame. Returns the GPU, if any, and
/// the row.
pub(super) fn run(
    loaded: &Loaded,
    parameters: &Parameters,
    request: &BackendRequest,
    tick: &dyn Fn(),
) -> Result<(Option<String>, Row), Box<dyn Error>> {
    let diagonal = loaded.surface.bounds().diagonal();
    let mut pbd = Run::new(loaded, parameters, request)?;
    pbd.frames(None, tick)?;
    let mut cs = Run::new(loaded, parameters, request)?;
    cs.frames(Some(diagonal), tick)?;
    let paper = PaperRow::of(loaded.model);
    let ours = PaperRow {
        pbd_fps: pbd.fps(),
        pbd_cs_fps: cs.fps(),
        fps_difference_percent: (1.0 - cs.fps() / pbd.fps()) * 100.0,
        cut_ms: mean(&cs.cuts.0) * 1e3,
    };
    let is_on_gpu = pbd.gpu.is_some();
    let row = Row {
        source: loaded.source.clone(),
        vertices: loaded.vertices,
        particles: loaded.surface.topology().vertex_count(),
        triangles: loaded.surface.topology().triangle_count(),
        triangles_after: cs.surface()?.topology().triangle_count(),
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
        pbd_fps_by_second: pbd.fps_by_second(),
        pbd_cs_fps_by_second: cs.fps_by_second(),
        cuts_refused: cs.refused,
    };
    Ok((pbd.gpu, row))
}

/// Returns frames per second of the timed frames; none if no frame is timed.
fn rate(work: &[f64]) -> Option<f64> {
    let timed = work.iter().filter(|seconds| seconds.is_finite());
    let sum: f64 = timed.clone().sum();
    (sum > 0.0).then(|| timed.count() as f64 / sum)
}

impl<'a> Run<'a> {
    /// Sets up the scene.
    fn new(
        loaded: &Loaded,
        parameters: &'a Parameters,
        request: &BackendRequest,
    ) -> Result<Self, Box<dyn Error>> {
        let mut scene = Scene::with_backend(parameters.scene(), request)?;
        let material = Material {
            volume: parameters.volume.then(Volume::default),
            interior_springs: parameters.interior_springs.then(InteriorSprings::default),
            ..motion::material()
        };
        let body = scene.add_body(loaded.surface.clone(), &material)?;
        let (solver, surface) = scene.edit(body)?.solver_mut();
        motion::start(solver, surface)?;
        let volume = rest_volume(surface);
        let report = scene.backend_report();
        let is_on_gpu = report.gpu_bodies.contains(&body);
        scene.params.skip_far_sweeps = is_on_gpu;
        Ok(Self {
            parameters,
            scene,
            body,
            volume,
            gpu: report.adapter.filter(|_| is_on_gpu),
            // Recording allocates nothing.
            work: Times(Vec::with_capacity(parameters.frames() as usize)),
            schedule: None,
            bytes_uploaded: Vec::new(),
            bytes_read: Vec::new(),
            cuts: Times::default(),
            refused: Vec::new(),
            stretch_error: 0.0,
            samples: 0,
            volume_error: 0.0,
            cap_min_angle: f64::INFINITY,
            allocations: 0,
        })
    }

    fn surface(&self) -> Result<&Surface, SceneError> {
        Ok(self.scene.body(self.body)?.surface())
    }

    fn fps(&self) -> f64 {
        rate(&self.work.0).unwrap_or(f64::NAN)
    }

    /// Returns the frame rates of every simulated second.
    fn fps_by_second(&self) -> Vec<Option<f64>> {
        let frames = self.parameters.frames_a_second() as usize;
        self.work.0.chunks(frames).map(rate).collect()
    }

    fn sample(&mut self) -> Result<(), SceneError> {
        let body = self.scene.body(self.body)?;
        self.stretch_error += body.solver().stretch_error(body.surface());
        self.samples += 1;
        Ok(())
    }

    /// Returns the mean of all samples.
    fn mean_stretch_error(&self) -> f64 {
        self.stretch_error / f64::from(self.samples)
    }

    /// Steps all frames; with the diagonal of the body's box, a blade moves and slices.
    fn frames(&mut self, diagonal: Option<f64>, tick: &dyn Fn()) -> Result<(), Box<dyn Error>> {
        let body = self.body;
        let is_on_gpu = self.gpu.is_some();
        let a_second = self.parameters.frames_a_second();
        let mut directions = Directions(self.parameters.seed);
        let mut blade = None;
        if let Some(diagonal) = diagonal {
            let id = self.scene.add_blade(hover(diagonal, 0));
            // The paper's blade cuts full slices.
            self.scene.set_blade_mode(id, BladeMode::FullSlices)?;
            blade = Some((id, diagonal));
        }
        // A failed slice is repeated in the next frame with the next direction.
        let mut is_due = false;
        for frame in 1..=self.parameters.frames() {
            is_due |= blade.is_some() && frame % a_second == 0;
            let allocations_before = allocations();
            let mut readback = Duration::ZERO;
            if is_on_gpu && (is_due || frame % a_second == 0) {
                // The sweep follows from the body's positions.
                let begin = Instant::now();
                self.scene.read_back(body)?;
                readback = begin.elapsed();
                self.sample()?;
            }
            let slice = match blade {
                Some((blade, _)) if is_due => Some(self.aim(blade, &mut directions)?),
                Some((blade, diagonal)) => {
                    self.scene.set_blade_piece(blade, None)?;
                    self.scene.move_blade(blade, hover(diagonal, frame))?;
                    None
                }
                None => None,
            };
            let begin = Instant::now();
            self.scene.cut()?;
            let by_paper = match &slice {
                Some(slice) if self.parameters.caps.method == Method::Paper => {
                    Some(self.cut_by_paper(slice)?)
                }
                _ => None,
            };
            let mut work = begin.elapsed();
            // Caps are judged before they move.
            if slice.is_some() {
                work += readback;
                self.judge_caps(by_paper)?;
            }
            let begin = Instant::now();
            self.scene.advance()?;
            self.scene.wait_for_gpu()?;
            work += begin.elapsed();
            if frame > 1 || !is_on_gpu {
                self.work.0.push(work.as_secs_f64());
            } else {
                self.work.0.push(f64::NAN);
                self.schedule = schedule(self.scene.stats());
            }
            if let (Some(slice), Some((blade, diagonal))) = (&slice, blade) {
                self.record_slice(slice, readback)?;
                is_due = self.scene.stats().cuts == 0;
                self.scene.teleport_blade(blade, hover(diagonal, frame))?;
            } else if frame > 1 {
                self.allocations += allocations() - allocations_before;
            }
            if !is_on_gpu {
                self.sample()?;
            }
            tick();
        }
        if is_on_gpu {
            self.scene.read_back(body)?;
            self.sample()?;
        }
        Ok(())
    }

    /// Puts the blade at the start of a sweep through the middle of the largest piece, and by the
    /// exact method moves it through.
    fn aim(
        &mut self,
        blade: BladeId,
        directions: &mut Directions,
    ) -> Result<Slice, Box<dyn Error>> {
        let surface = self.surface()?;
        let volume = rest_volume(surface) / self.volume;
        let volumes = surface.piece_volumes();
        let largest = (0u32..)
            .zip(&volumes)
            .max_by(|x, y| x.1.abs().total_cmp(&y.1.abs()))
            .map_or(0, |(piece, _)| piece);
        let piece = surface.extract_piece(largest);
        let normal = directions.next_unit();
        let d = normal.dot(&middle(&piece));
        let [before, after] = Sweep::from_plane(normal.into(), d, &piece.bounds())?.ends();
        self.scene.teleport_blade(blade, before)?;
        self.scene.set_blade_piece(blade, Some(largest))?;
        if self.parameters.caps.method == Method::Exact {
            self.scene.move_blade(blade, after)?;
        }
        Ok(Slice {
            sweep: Sweep::new(before, after)?,
            piece: largest,
            volume,
        })
    }

    /// Cuts by the paper's method, in the place of the frame where the blade would.
    fn cut_by_paper(
        &mut self,
        slice: &Slice,
    ) -> Result<Result<CutOutcome, Box<dyn Error>>, SceneError> {
        let (caps, sweep) = (&self.parameters.caps, &slice.sweep);
        (self.scene).cut_with(self.body, sweep, |cutter, surface| {
            caps.cut(cutter, surface, sweep, Some(slice.piece))
        })
    }

    /// Records the angles of caps, and the reason why the paper's method refused a cut.
    fn judge_caps(
        &mut self,
        by_paper: Option<Result<CutOutcome, Box<dyn Error>>>,
    ) -> Result<(), SceneError> {
        let surface = self.scene.body(self.body)?.surface();
        if let Some(Err(error)) = &by_paper {
            self.refused.push(error.to_string());
        }
        let cuts = self.scene.cuts().iter();
        let outcomes = cuts.filter_map(|sweep| Some(&sweep.cut.as_ref()?.1));
        for outcome in outcomes.chain(by_paper.iter().flatten()) {
            let cap = outcome.cap.iter().map(|&t| surface.triangle_positions(t));
            self.cap_min_angle = self.cap_min_angle.min(AngleStats::from_triangles(cap).min);
        }
        Ok(())
    }

    /// Records the costs of a slice and its loss of volume.
    fn record_slice(&mut self, slice: &Slice, readback: Duration) -> Result<(), SceneError> {
        let stats = self.scene.stats();
        let refusals = self.scene.failed_cuts().iter();
        self.refused.extend(refusals.map(|r| r.error.to_string()));
        for _ in 0..stats.cuts {
            let cost = stats.cutting() + readback;
            self.cuts.0.push(cost.as_secs_f64());
            self.bytes_uploaded.push(stats.bytes_uploaded as f64);
            self.bytes_read.push(stats.bytes_read as f64);
        }
        let after = rest_volume(self.surface()?) / self.volume;
        self.volume_error += (after - slice.volume).abs();
        Ok(())
    }
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
