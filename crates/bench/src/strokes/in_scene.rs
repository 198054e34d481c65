//! [`Setting`]: strokes through bodies of a scene that are held, pulled apart or hang.

use super::at_rest::{between, pick};
use super::kinds::bunny;
use super::trial::Trial;
use incise_cut::CutParams;
use incise_mesh::geometry::to_f32;
use incise_mesh::{Surface, Vec3, VertexId, icosphere};
use incise_models::place;
use incise_models::scenes::Directions;
use incise_pbd_gpu::{Collider, Material, SolverParams};
use incise_scene::{ContactParams, Scene, SceneError, SceneParams};
use std::f64::consts::{PI, TAU};
use std::num::NonZeroUsize;

/// Part of the body's extent that is pinned at an end.
const PINNED: f64 = 0.1;
/// Frames in which the ends are pulled apart, and then come to rest.
const PULLING: u16 = 60;
const SETTLING: u16 = 60;
/// Frames in which a swinging blade goes to and fro.
const PERIOD: f64 = 16.0;
/// Distance of the path's ends from the body \[m\].
const MARGIN: f64 = 0.05;

/// The parts of a body that are pinned.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Pins {
    /// Both ends along x.
    Ends,
    /// The upper end.
    Top,
}

/// The direction in which a blade moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Motion {
    /// In any direction across x.
    Across,
    Down,
    Horizontal,
}

/// How a body is held and cut.
#[derive(Debug, Clone, Copy)]
pub(super) struct Setting {
    /// Ratio of the body's length along x to that at rest.
    factor: f64,
    /// Angle by which the blade turns about its motion to both sides \[rad\].
    swing: f64,
    pins: Pins,
    motion: Motion,
    has_gravity: bool,
    has_ground: bool,
    has_contacts: bool,
    /// Whether bodies collide with the blade's face.
    has_face: bool,
}

impl Setting {
    /// A weightless body, held at its ends, that a knife with a face cuts from above.
    pub(super) const FACE: Self = Self {
        has_contacts: true,
        has_face: true,
        motion: Motion::Down,
        ..Self::pulled(1.0, 0.0)
    };
    /// A body, held at its ends, that rests on the ground.
    pub(super) const GROUND: Self = Self {
        has_gravity: true,
        has_ground: true,
        has_contacts: true,
        motion: Motion::Down,
        ..Self::pulled(1.0, 0.0)
    };
    /// A body that hangs from its upper end.
    pub(super) const HANGING: Self = Self {
        has_gravity: true,
        pins: Pins::Top,
        motion: Motion::Horizontal,
        ..Self::pulled(1.0, 0.0)
    };

    /// Returns a weightless body that is pulled apart along x and cut across.
    pub(super) const fn pulled(factor: f64, swing: f64) -> Self {
        Self {
            factor,
            swing,
            pins: Pins::Ends,
            motion: Motion::Across,
            has_gravity: false,
            has_ground: false,
            has_contacts: false,
            has_face: false,
        }
    }

    /// Holds a body and moves a blade through it.
    ///
    /// # Errors
    /// An error of the scene.
    pub(super) fn run(&self, random: &mut Directions, trial: &mut Trial) -> Result<(), SceneError> {
        let bodies: [fn() -> Surface; 2] = [|| icosphere(3, 0.5), bunny];
        let mut surface = pick(random, &bodies)();
        let bounds = surface.bounds();
        let length = f64::from(bounds.max[0]) - f64::from(bounds.min[0]);
        place(&mut surface, |p| {
            p - Vec3::new(0.0, f64::from(bounds.min[1]), 0.0)
        });
        trial.begin(&surface);
        trial.is_full = true;
        let mut scene = Scene::new(self.params(pick(random, &[0.0, 0.1])));
        if self.has_ground {
            scene.colliders.push(Collider::ground(0.0));
        }
        let body = scene.add_body(surface, &Material::soft_body())?;
        let pins = self.pin(&mut scene)?;
        for frame in 1..=PULLING + SETTLING {
            let part = f64::from(frame.min(PULLING)) / f64::from(PULLING);
            let displacement = 0.5 * (self.factor - 1.0) * length * part;
            for &(v, from) in &pins {
                let to = from + Vec3::x() * (displacement * from.x.signum());
                scene.set_pin_target(body, v, to_f32(to))?;
            }
            scene.step()?;
        }
        let speed = pick(random, &[0.25, 0.5, 1.0, 2.0, 4.0]);
        let speed = speed * scene.body(body)?.solver().mean_rest_length();
        let poses = self.poses(random, scene.body(body)?.surface(), speed);
        let blade = scene.add_blade(poses[0]);
        if self.has_face {
            scene.set_blade_face(blade, Some([0.0, 0.5, 0.0]))?;
        }
        for pose in poses {
            scene.move_blade(blade, pose)?;
            let stats = scene.step()?;
            trial.steps += stats.sweeps as usize;
            trial.cutting += stats.cuts as usize;
            for failed in scene.failed_cuts() {
                trial.fail(&failed.error);
            }
        }
        trial.surface = scene.body(body)?.surface().clone();
        Ok(())
    }

    fn params(&self, snap: f64) -> SceneParams {
        let mut params = SceneParams {
            cut: CutParams {
                snap,
                ..CutParams::default()
            },
            contacts: self.has_contacts.then(ContactParams::default),
            solver: SolverParams {
                threads: NonZeroUsize::new(1),
                ..SolverParams::default()
            },
            ..SceneParams::default()
        };
        if !self.has_gravity {
            params.solver.gravity = [0.0; 3];
        }
        params
    }

    /// Pins the body, and returns the pinned vertices with their positions \[m\].
    fn pin(&self, scene: &mut Scene) -> Result<Vec<(VertexId, Vec3)>, SceneError> {
        let mut pins = Vec::new();
        for body in scene.bodies().collect::<Vec<_>>() {
            let (solver, surface) = scene.edit(body)?.solver_mut();
            let bounds = surface.bounds();
            let part = |p: Vec3, axis: usize| {
                let [low, high] = [bounds.min, bounds.max].map(|c| f64::from(c[axis]));
                (p[axis] - low) / (high - low)
            };
            let vertices: Vec<VertexId> = surface.topology().vertices().collect();
            for v in vertices {
                let p = surface.position(v);
                let is_pinned = match self.pins {
                    Pins::Ends => (part(p, 0) - 0.5).abs() >= 0.5 - PINNED,
                    Pins::Top => part(p, 1) >= 1.0 - PINNED,
                };
                if is_pinned {
                    solver.pin(surface, v)?;
                    pins.push((v, p));
                }
            }
        }
        Ok(pins)
    }

    /// Returns the poses of a blade that passes through the whole body, `speed` apart \[m\].
    fn poses(&self, random: &mut Directions, surface: &Surface, speed: f64) -> Vec<[[f32; 3]; 2]> {
        let bounds = surface.bounds();
        let [low, high] = [bounds.min, bounds.max].map(|c| Vec3::from(c.map(f64::from)));
        let (mut middle, half) = ((low + high) / 2.0, (high - low) / 2.0);
        let (sin, cos) = (PI * random.signed()).sin_cos();
        // Unit vectors of the motion and of the edge; the offset is across both.
        let [along, edge] = match self.motion {
            Motion::Across => [Vec3::new(0.0, cos, sin), Vec3::new(0.0, -sin, cos)],
            Motion::Down => {
                let (sin, cos) = between(random, -0.3, 0.3).sin_cos();
                [-Vec3::y(), Vec3::new(sin, 0.0, cos)]
            }
            Motion::Horizontal => [Vec3::new(cos, 0.0, sin), Vec3::new(-sin, 0.0, cos)],
        };
        let across = along.cross(&edge);
        middle += across * (0.3 * random.signed() * across.abs().dot(&half));
        let reach = along.abs().dot(&half) + MARGIN;
        let length = 1.3 * half.norm();
        let phase = TAU * random.signed();
        let steps = (0_u32..).map(f64::from);
        let steps = steps.take_while(|k| (k - 1.0) * speed < 2.0 * reach);
        let poses = steps.map(|k| {
            let (sin, cos) = (self.swing * (TAU * k / PERIOD + phase).sin()).sin_cos();
            let at = middle + along * (k * speed - reach);
            let edge = (edge * cos + across * sin) * length;
            [at - edge, at + edge].map(to_f32)
        });
        poses.collect()
    }
}
