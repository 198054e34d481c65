//! The paper's protocol (section 4) on one model.
//!
//! Two runs of the same length: the solver alone, and the solver with a blade that moves every
//! frame and slices the largest piece once a simulated second. The scene is weightless, and the
//! body starts with a spin and a squeeze: a hollow surface with stretch and bending alone cannot
//! carry itself, and a heap on the ground would be another test than the paper's figures show.

use crate::allocations;
use crate::models::Loaded;
use crate::{BackendChoice, TableArguments};
use incise_cut::{CutParams, Sweep};
use incise_mesh::geometry::{area_vector, round};
use incise_mesh::{AngleStats, Surface, Vec3, VertexId};
use incise_pbd_gpu::{Material, SolverParams, Stiffness};
use incise_refine::RefineParams;
use incise_scene::{BladeId, BodyId, Scene, SceneParams};
use serde::Serialize;
use std::error::Error;
use std::time::{Duration, Instant};

/// Angular velocity of the body at the start, about its vertical axis \[1/s\].
const SPIN: f64 = 1.0;
/// Rate at which the body is squeezed along its vertical axis at the start \[1/s\].
const SQUEEZE: f64 = 0.25;
/// How far from the body the blade hovers, in diagonals of its box.
const HOVER: f64 = 100.0;

/// A row of the table.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Row {
    pub(crate) model: &'static str,
    pub(crate) source: String,
    pub(crate) vertices: usize,
    pub(crate) particles: usize,
    pub(crate) triangles: usize,
    /// Triangles after the last cut of PBD + CS.
    pub(crate) triangles_after: usize,
    pub(crate) backend: &'static str,
    pub(crate) device: String,
    pub(crate) pbd_fps: f64,
    pub(crate) pbd_cs_fps: f64,
    pub(crate) fps_difference_percent: f64,
    pub(crate) cut_ms_mean: f64,
    pub(crate) cut_ms_p99: f64,
    pub(crate) cuts: usize,
    pub(crate) cuts_refused: Vec<String>,
    pub(crate) stretch_error_percent: f64,
    pub(crate) volume_error_percent: f64,
    pub(crate) cap_min_angle_deg: f64,
    /// Heap allocations in all frames without a cut together, the first of a run left out.
    pub(crate) allocations: usize,
    pub(crate) machine: String,
    pub(crate) commit: String,
    pub(crate) version: &'static str,
    pub(crate) dt: f64,
    pub(crate) iterations: u32,
    pub(crate) seconds: f64,
    pub(crate) level: f64,
    pub(crate) seed: u64,
}

/// What a run measured.
#[derive(Default)]
struct Run {
    frames: u32,
    work: Duration,
    cut_ms: Vec<f64>,
    refused: Vec<String>,
    stretch_error: f64,
    volume_error: f64,
    cap_min_angle: f64,
    allocations: usize,
    triangles_after: usize,
}

impl Run {
    fn fps(&self) -> f64 {
        f64::from(self.frames) / self.work.as_secs_f64()
    }
}

/// Runs both halves of the protocol; `tick` is called after every frame.
pub(crate) fn run(
    loaded: &Loaded,
    arguments: &TableArguments,
    machine: &str,
    commit: &str,
    tick: &dyn Fn(),
) -> Result<Row, Box<dyn Error>> {
    let pbd = run_scene(loaded, arguments, false, tick)?;
    let cs = run_scene(loaded, arguments, true, tick)?;
    let mut cut_ms = cs.cut_ms.clone();
    cut_ms.sort_by(f64::total_cmp);
    let BackendChoice::Cpu = arguments.backend;
    Ok(Row {
        model: loaded.model.name(),
        source: loaded.source.clone(),
        vertices: loaded.vertices,
        particles: loaded.surface.topology().vertex_count(),
        triangles: loaded.surface.topology().triangle_count(),
        triangles_after: cs.triangles_after,
        backend: arguments.backend.name(),
        device: machine.to_owned(),
        pbd_fps: pbd.fps(),
        pbd_cs_fps: cs.fps(),
        fps_difference_percent: (1.0 - cs.fps() / pbd.fps()) * 100.0,
        cut_ms_mean: mean(&cut_ms),
        cut_ms_p99: percentile_99(&cut_ms),
        cuts: cut_ms.len(),
        cuts_refused: cs.refused,
        stretch_error_percent: cs.stretch_error.max(pbd.stretch_error) * 100.0,
        volume_error_percent: cs.volume_error * 100.0,
        cap_min_angle_deg: cs.cap_min_angle,
        allocations: pbd.allocations + cs.allocations,
        machine: machine.to_owned(),
        commit: commit.to_owned(),
        version: env!("CARGO_PKG_VERSION"),
        dt: arguments.dt,
        iterations: arguments.iterations,
        seconds: arguments.seconds,
        level: arguments.level.z(),
        seed: arguments.seed,
    })
}

/// Frames of one run.
pub(crate) fn frames(arguments: &TableArguments) -> u32 {
    whole(arguments.seconds / arguments.dt)
}

fn run_scene(
    loaded: &Loaded,
    arguments: &TableArguments,
    cutting: bool,
    tick: &dyn Fn(),
) -> Result<Run, Box<dyn Error>> {
    let (mut scene, body) = set_up(loaded, arguments)?;
    let diagonal = loaded.surface.bounds().diagonal();
    let blade = cutting.then(|| scene.add_blade(hover(diagonal, 0)));
    let volume = rest_volume(scene.body(body).surface());
    let frames = frames(arguments);
    let a_second = whole(1.0 / arguments.dt).max(1);
    let mut directions = Directions(arguments.seed);
    let mut run = Run {
        frames,
        cap_min_angle: f64::INFINITY,
        ..Run::default()
    };
    // A refused slice is tried again in the next frame, in the next direction.
    let mut due = false;
    for frame in 1..=frames {
        due |= cutting && frame % a_second == 0;
        let slices = due;
        let before = allocations::count();
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
            judge_caps(&scene, body, &mut run);
        }
        let begin = Instant::now();
        scene.advance()?;
        work += begin.elapsed();
        run.work += work;
        if let Some(blade) = blade.filter(|_| slices) {
            after_slice(&scene, body, volume_before / volume, volume, &mut run);
            due = scene.outcomes().is_empty();
            scene.jump_blade(blade, hover(diagonal, frame));
        } else if frame > 1 {
            run.allocations += allocations::count() - before;
        }
        let now = scene.body(body);
        run.stretch_error += now.solver().stretch_error(now.surface()) / f64::from(frames);
        tick();
    }
    let surface = scene.body(body).surface();
    run.triangles_after = surface.topology().triangle_count();
    Ok(run)
}

fn set_up(loaded: &Loaded, arguments: &TableArguments) -> Result<(Scene, BodyId), Box<dyn Error>> {
    let mut scene = Scene::new(SceneParams {
        dt: narrow(arguments.dt),
        solver: SolverParams {
            iterations: arguments.iterations,
            gravity: [0.0; 3],
            ..SolverParams::default()
        },
        cut: CutParams {
            refine: RefineParams {
                level: arguments.level,
                ..RefineParams::default()
            },
            ..CutParams::default()
        },
        // The paper tests every triangle in every frame; its table is no place to skip that.
        skip_far_sweeps: false,
        ..SceneParams::default()
    });
    let material = Material {
        bending: Some(Stiffness::Pbd(0.5)),
        ..Material::default()
    };
    let body = scene.add_body(loaded.surface.clone(), &material)?;
    let center = loaded.surface.bounds().center();
    let (solver, surface) = scene.edit(body)?.solver_mut();
    let vertices: Vec<VertexId> = surface.topology().vertices().collect();
    for v in vertices {
        let r = surface.position(v) - center;
        let velocity = Vec3::new(SPIN * r.z, -SQUEEZE * r.y, -SPIN * r.x);
        solver.set_velocity(v, round(velocity))?;
    }
    Ok((scene, body))
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

fn after_slice(scene: &Scene, body: BodyId, before: f64, volume: f64, run: &mut Run) {
    let stats = scene.stats();
    let refusals = scene.refusals().iter();
    run.refused.extend(refusals.map(|r| r.error.to_string()));
    for _ in scene.outcomes() {
        run.cut_ms.push(stats.cutting().as_secs_f64() * 1e3);
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

/// Seeded directions (splitmix64, Steele et al. 2014).
struct Directions(u64);

impl Directions {
    /// A number from -1 to 1.
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        f64::from(u32::try_from(z >> 32).unwrap_or(u32::MAX)) / f64::from(u32::MAX) * 2.0 - 1.0
    }

    /// A direction, all equally likely.
    fn next_unit(&mut self) -> Vec3 {
        loop {
            let v = Vec3::new(self.next(), self.next(), self.next());
            let length = v.norm();
            if length > 0.1 && length <= 1.0 {
                return v / length;
            }
        }
    }
}

#[expect(
    clippy::cast_precision_loss,
    reason = "a run has far fewer than 2^53 cuts"
)]
fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// The smallest value that 99% of the sorted values do not exceed.
fn percentile_99(sorted: &[f64]) -> f64 {
    let rank = (sorted.len() * 99).div_ceil(100);
    sorted
        .get(rank.wrapping_sub(1))
        .copied()
        .unwrap_or(f64::NAN)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_are_units_and_repeat_with_their_seed() {
        let mut directions = Directions(7);
        let all: Vec<Vec3> = (0..1000).map(|_| directions.next_unit()).collect();
        assert!(all.iter().all(|d| (d.norm() - 1.0).abs() < 1e-12));
        let mean = all.iter().sum::<Vec3>() / 1000.0;
        assert!(mean.norm() < 0.1, "no direction is preferred: {mean}");
        assert_eq!(Directions(7).next_unit(), all[0]);
    }

    #[test]
    fn the_99th_percentile_of_few_values_is_the_largest() {
        assert_eq!(percentile_99(&[1.0, 2.0, 3.0]), 3.0);
        let hundred: Vec<f64> = (1..=100).map(f64::from).collect();
        assert_eq!(percentile_99(&hundred), 99.0);
        assert!(percentile_99(&[]).is_nan());
    }
}
