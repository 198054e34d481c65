//! [`Stroke`]: paths of a blade through a body without a solver, in coordinates of the body.

use super::trial::Trial;
use crate::measure::whole;
use incise_cut::{CutParams, Cutter, Incision};
use incise_mesh::geometry::{area_vector, to_f32};
use incise_mesh::{Surface, Vec3};
use incise_models::place;
use incise_models::scenes::Directions;
use std::f64::consts::PI;

/// Displacement of each side of a gaping slit \[m\], and the distance behind the blade at which it
/// is reached \[m\].
const GAP: f64 = 0.2;
const GAP_LENGTH: f64 = 0.3;
/// Samples by which the length of a path is measured.
const SAMPLES: u32 = 1000;

/// Poses of a blade, one after the other \[m\].
pub(super) type Path = Vec<Vec<[f32; 3]>>;

/// A body and the paths of blades through it, one after the other.
///
/// Positions relative to the body are from -1 to 1 between the ends of the body along the axes. The
/// blade's edge is mostly along y, its motion along z, and x is the normal of its sweep.
#[derive(Debug)]
pub(super) struct Stroke<'a> {
    pub(super) random: &'a mut Directions,
    pub(super) surface: Surface,
    pub(super) paths: Vec<Path>,
    /// Motion between two poses \[m\].
    step: f64,
    /// The number of steps instead.
    pub(super) count: Option<u32>,
    /// Whether the paths part the body.
    pub(super) is_full: bool,
    /// Whether the sides of the slit are pulled apart along x behind the blade.
    pub(super) is_gaping: bool,
    snap: f64,
    center: Vec3,
    half_extents: Vec3,
}

/// Returns a number between two.
pub(super) fn between(random: &mut Directions, low: f64, high: f64) -> f64 {
    low + (high - low) * f64::midpoint(random.signed(), 1.0)
}

/// Returns a number between two positive ones, uniform in its logarithm.
pub(super) fn log_between(random: &mut Directions, low: f64, high: f64) -> f64 {
    between(random, low.ln(), high.ln()).exp()
}

/// Returns one of several items.
pub(super) fn pick<T: Copy>(random: &mut Directions, items: &[T]) -> T {
    let number = whole(between(random, 0.0, items.len() as f64)) as usize;
    items[number.min(items.len() - 1)]
}

impl<'a> Stroke<'a> {
    /// Returns one of some bodies, turned at random or not, without a path yet.
    ///
    /// The speed and the snapping distance are random.
    pub(super) fn new(
        random: &'a mut Directions,
        bodies: &[fn() -> Surface],
        is_turned: bool,
    ) -> Self {
        let mut surface = pick(random, bodies)();
        let axis = random.next_unit();
        let angle = if is_turned { PI * random.signed() } else { 0.0 };
        // Rodrigues' rotation.
        let (sin, cos) = angle.sin_cos();
        place(&mut surface, |p| {
            p * cos + axis.cross(&p) * sin + axis * axis.dot(&p) * (1.0 - cos)
        });
        let bounds = surface.bounds();
        let [low, high] = [bounds.min, bounds.max].map(|c| Vec3::from(c.map(f64::from)));
        Self {
            step: surface.mean_edge_length() * log_between(random, 0.25, 4.0),
            snap: pick(random, &[0.0, 0.1]),
            random,
            paths: vec![Path::new()],
            count: None,
            is_full: false,
            is_gaping: false,
            center: (low + high) / 2.0,
            // A sheet has none along its normal.
            half_extents: ((high - low) / 2.0).sup(&Vec3::repeat(0.1)),
            surface,
        }
    }

    /// Returns a random number between two.
    pub(super) fn between(&mut self, low: f64, high: f64) -> f64 {
        between(self.random, low, high)
    }

    /// Returns a position \[m\].
    fn at(&self, relative: [f64; 3]) -> Vec3 {
        self.center + Vec3::from(relative).component_mul(&self.half_extents)
    }

    /// Limits the motion between two poses, so that they follow a curved path \[m\].
    pub(super) fn limit_step(&mut self, step: f64) {
        self.step = self.step.min(step);
    }

    /// Moves the blade on; `pose` has its relative positions from 0 to 1.
    pub(super) fn walk<const N: usize>(&mut self, pose: impl Fn(f64) -> [[f64; 3]; N]) {
        let pose = |t: f64| pose(t).map(|p| self.at(p));
        let samples = |i: u32| pose(f64::from(i) / f64::from(SAMPLES));
        let motion = |i: u32| {
            let pairs = samples(i).into_iter().zip(samples(i + 1));
            pairs.map(|(p, q)| (q - p).norm()).fold(0.0, f64::max)
        };
        let length: f64 = (0..SAMPLES).map(motion).sum();
        let steps = self
            .count
            .unwrap_or_else(|| whole((length / self.step).ceil()).max(1));
        let poses = (0..=steps).map(|i| pose(f64::from(i) / f64::from(steps)).map(to_f32).to_vec());
        let poses: Path = poses.collect();
        if let Some(path) = self.paths.last_mut() {
            path.extend(poses);
        }
    }

    /// Lifts the blade; the next path is that of another one.
    pub(super) fn lift(&mut self) {
        self.paths.push(Path::new());
    }

    /// Cuts the body.
    pub(super) fn run(mut self, trial: &mut Trial) {
        trial.begin(&self.surface);
        trial.is_full = self.is_full;
        trial.is_at_rest = !self.is_gaping;
        let params = CutParams {
            snap: self.snap,
            ..CutParams::default()
        };
        let mut cutter = Cutter::new(&self.surface);
        for path in std::mem::take(&mut self.paths) {
            let mut incision = Incision::default();
            for (i, pose) in path.iter().enumerate() {
                trial.steps += usize::from(i > 0 && *pose != path[i - 1]);
                let outcome = cutter.advance(&mut self.surface, &mut incision, pose, &params);
                trial.record(&outcome);
                if self.is_gaping {
                    let tip = f64::from(pose[0][2]);
                    self.open_gap(tip, f64::from(pose[0][0]));
                    cutter.refit(&self.surface);
                }
            }
        }
        trial.surface = self.surface;
    }

    /// Moves the sides of a slit in the plane x = `plane` apart behind the blade at z = `tip`.
    fn open_gap(&mut self, tip: f64, plane: f64) {
        let surface = &mut self.surface;
        let topology = surface.topology();
        // By vertex: the area of its triangles, positive above the plane.
        let mut sides = vec![0.0; topology.vertex_slots()];
        for t in topology.triangles() {
            let corners = topology.triangle(t).map(|v| surface.rest_position(v));
            let normal = area_vector(corners);
            let is_wall = surface.material(t) == CutParams::default().cap_material;
            let height = (corners[0] + corners[1] + corners[2]).x / 3.0 - plane;
            // The body is behind its wall.
            let side = if is_wall { -normal.x } else { height };
            for v in topology.triangle(t) {
                sides[v.index()] += side.signum() * normal.norm();
            }
        }
        let vertices: Vec<_> = topology.vertices().collect();
        for v in vertices {
            let mut p = surface.rest_position(v);
            p.x += GAP * sides[v.index()].signum() * ((tip - p.z) / GAP_LENGTH).clamp(0.0, 1.0);
            let [x, y, z] = to_f32(p);
            let mass = surface.positions()[v.index()][3];
            surface.positions_mut()[v.index()] = [x, y, z, mass];
        }
    }
}
