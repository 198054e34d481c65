//! The scenes: bodies, what is done to them, and when.

use super::super::Found;
use super::super::runner::Runner;
use super::bodies::bodies;
use incise_cut::{CutParams, Sweep};
use incise_mesh::geometry::to_f32;
use incise_mesh::{Vec3, VertexId};
use incise_pbd_gpu::{Collider, Material};
use incise_scene::{BladeId, BodyId, ContactParams, Scene, SceneParams};
use incise_test_support::random::Random;
use incise_test_support::surfaces::at_rest;

/// What is done to a body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Drop,
    CutInFlight,
    CutAtRest,
    Knife,
    KnifeWithFace,
    PinnedScalpel,
    HangingScalpel,
    Drag,
    Squeeze,
    Pile,
    Slices,
    Plates,
    LongFrames,
    ShortFrames,
    FineCells,
}

impl Kind {
    pub(super) const ALL: [Self; 15] = [
        Self::Drop,
        Self::CutInFlight,
        Self::CutAtRest,
        Self::Knife,
        Self::KnifeWithFace,
        Self::PinnedScalpel,
        Self::HangingScalpel,
        Self::Drag,
        Self::Squeeze,
        Self::Pile,
        Self::Slices,
        Self::Plates,
        Self::LongFrames,
        Self::ShortFrames,
        Self::FineCells,
    ];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Drop => "drop",
            Self::CutInFlight => "cut in flight",
            Self::CutAtRest => "cut at rest",
            Self::Knife => "knife",
            Self::KnifeWithFace => "knife with a face",
            Self::PinnedScalpel => "scalpel, pinned",
            Self::HangingScalpel => "scalpel, hanging",
            Self::Drag => "drag",
            Self::Squeeze => "squeeze",
            Self::Pile => "pile",
            Self::Slices => "slices",
            Self::Plates => "plates",
            Self::LongFrames => "frames of 1/30 s",
            Self::ShortFrames => "frames of 1/120 s",
            Self::FineCells => "fine cells",
        }
    }

    /// Returns whether blades, pins or colliders move, and so do work.
    fn does_work(self) -> bool {
        matches!(
            self,
            Self::KnifeWithFace
                | Self::PinnedScalpel
                | Self::HangingScalpel
                | Self::Drag
                | Self::Squeeze
        )
    }
}

/// A scene and what happens in it.
#[derive(Debug)]
pub(super) struct Script {
    pub(super) scene: Scene,
    kind: Kind,
    body: BodyId,
    /// Young's modulus \[Pa\].
    young_modulus: f32,
    /// Normals of the cuts to come, in order.
    cuts: Vec<Vec3>,
    /// The moving blade, and the first and last place of its middle \[m\].
    blade: Option<(BladeId, [Vec3; 2])>,
    /// Height of the body before it is squeezed \[m\].
    height: f64,
    time: f64,
}

/// Times of the first cut in flight and at rest, and between two cuts \[s\].
const CUTS: [[f64; 2]; 2] = [[0.1, 0.05], [2.0, 0.5]];
/// Time at which blades, pins and colliders begin to move, and how long they do \[s\].
const MOTION: [f64; 2] = [1.5, 1.0];
/// Distance of a blade from the body at its start and its end \[m\].
const CLEARANCE: f64 = 0.05;

impl Script {
    pub(super) fn new(runner: &Runner, kind: Kind, seed: u32) -> Found<Self> {
        let mut random = Random::new(u64::from(seed) + 100 * kind as u64);
        let mut params = SceneParams {
            contacts: Some(ContactParams::default()),
            ..SceneParams::default()
        };
        params.dt = match kind {
            Kind::LongFrames => 1.0 / 30.0,
            Kind::ShortFrames => 1.0 / 120.0,
            _ => params.dt,
        };
        let mut scene = Scene::new(params);
        let young_modulus = random.log(1e5, 1e7);
        let mut material = Material::solid(young_modulus, 0.45, 1000.0);
        if kind == Kind::FineCells
            && let Some(solid) = &mut material.solid
        {
            solid.cells_across = 16;
        }
        if kind != Kind::HangingScalpel {
            scene.colliders.push(Collider::ground(0.0));
        }
        let mut last = None;
        for (surface, place) in bodies(runner, kind, &mut random)? {
            let low = surface.rest_positions().iter().map(|p| p[1]);
            let low = f64::from(low.fold(f32::INFINITY, f32::min));
            let surface = at_rest(surface, |p| p + place - Vec3::new(0.0, low, 0.0));
            last = Some(scene.add_body(surface, &material)?);
        }
        let body = last.ok_or("no body")?;
        let normal = |_| Vec3::from_fn(|_, _| random.signed());
        let cuts = match kind {
            Kind::CutInFlight | Kind::CutAtRest => (0..=seed % 4).map(normal).collect(),
            Kind::Slices => vec![Vec3::y(); 4],
            _ => Vec::new(),
        };
        let mut script = Self {
            scene,
            kind,
            body,
            young_modulus,
            cuts,
            blade: None,
            height: 0.0,
            time: 0.0,
        };
        match kind {
            Kind::PinnedScalpel => script.pin(|part| part.y < 0.1)?,
            Kind::HangingScalpel => script.pin(|part| part.y > 0.9)?,
            _ => {}
        }
        Ok(script)
    }

    /// Returns the time of the last event \[s\].
    pub(super) fn last_event(&self) -> f64 {
        match self.kind {
            Kind::CutInFlight => CUTS[0][0] + 4.0 * CUTS[0][1],
            Kind::CutAtRest | Kind::Slices => CUTS[1][0] + 4.0 * CUTS[1][1],
            Kind::Squeeze => MOTION[0] + 2.0 * MOTION[1],
            kind if kind == Kind::Knife || kind.does_work() => MOTION[0] + MOTION[1],
            _ => 0.0,
        }
    }

    /// Returns whether no energy is brought in.
    pub(super) fn is_without_work(&self) -> bool {
        !self.kind.does_work()
    }

    /// Returns whether the body lies on the ground at the end.
    pub(super) fn lies(&self) -> bool {
        !matches!(self.kind, Kind::HangingScalpel | Kind::PinnedScalpel)
    }

    /// Returns the strain at the foot of a column of a meter by its own weight.
    pub(super) fn own_weight_strain(&self) -> f64 {
        1000.0 * 9.81 / f64::from(self.young_modulus)
    }

    /// Does what is due before the next frame.
    pub(super) fn drive(&mut self) -> Found<()> {
        let before = self.time;
        self.time += f64::from(self.scene.params.dt);
        match self.kind {
            Kind::CutInFlight | Kind::CutAtRest | Kind::Slices => {
                let [first, next] = CUTS[usize::from(self.kind != Kind::CutInFlight)];
                for i in 0..self.cuts.len() {
                    let at = first + next * i as f64;
                    if before < at && at <= self.time {
                        self.cut(i)?;
                    }
                }
                Ok(())
            }
            Kind::Knife | Kind::KnifeWithFace | Kind::PinnedScalpel | Kind::HangingScalpel => {
                self.move_blade()
            }
            Kind::Drag => self.drag(),
            Kind::Squeeze => self.squeeze(),
            _ => Ok(()),
        }
    }

    /// Returns the lowest and the highest corner of the body's box \[m\].
    fn corners(&self) -> Found<[Vec3; 2]> {
        let bounds = self.scene.body(self.body)?.surface().bounds();
        Ok([bounds.min, bounds.max].map(|p| Vec3::from(p.map(f64::from))))
    }

    /// Returns the part of the motion that is over: from 0 to 1, 2 where it takes twice the time.
    fn progress(&self) -> f64 {
        ((self.time - MOTION[0]) / MOTION[1]).clamp(0.0, 2.0)
    }

    /// Cuts along a plane through the middle of the body's box; slices at their heights.
    fn cut(&mut self, i: usize) -> Found<()> {
        let [low, high] = self.corners()?;
        let part = match self.kind {
            Kind::Slices => (i + 1) as f64 / (self.cuts.len() + 1) as f64,
            _ => 0.5,
        };
        let normal = self.cuts[i];
        let bounds = self.scene.body(self.body)?.surface().bounds();
        let sweep = Sweep::from_plane(normal.into(), normal.dot(&low.lerp(&high, part)), &bounds)?;
        let outcome = self.scene.cut_with(self.body, &sweep, |cutter, surface| {
            cutter.cut(surface, &sweep, &CutParams::default())
        })?;
        let _ = outcome?;
        Ok(())
    }

    /// Moves a knife down through the middle, a scalpel half of the way; into a hanging body from
    /// the side.
    fn move_blade(&mut self) -> Found<()> {
        if self.time < MOTION[0] {
            return Ok(());
        }
        if self.blade.is_none() {
            let [low, high] = self.corners()?;
            let middle = (low + high) / 2.0 + Vec3::repeat(0.013);
            let (axis, start, end) = match self.kind {
                Kind::HangingScalpel => (0, low.x - CLEARANCE, middle.x),
                Kind::PinnedScalpel => (1, high.y + CLEARANCE, middle.y),
                _ => (1, high.y + CLEARANCE, low.y - CLEARANCE),
            };
            let mut path = [middle; 2];
            (path[0][axis], path[1][axis]) = (start, end);
            let blade = self.scene.add_blade(edge(path[0]));
            if self.kind == Kind::KnifeWithFace {
                self.scene.set_blade_face(blade, Some([0.0, 1.5, 0.0]))?;
            }
            self.blade = Some((blade, path));
        }
        if let Some((blade, [start, end])) = self.blade {
            let at = start.lerp(&end, self.progress().min(1.0));
            self.scene.move_blade(blade, edge(at))?;
        }
        Ok(())
    }

    /// Pins the vertices in a part of the body's box.
    fn pin(&mut self, is_held: impl Fn(Vec3) -> bool) -> Found<()> {
        let [low, high] = self.corners()?;
        let (solver, surface) = self.scene.edit(self.body)?.solver_mut();
        let part = |v: &VertexId| (surface.position(*v) - low).component_div(&(high - low));
        let held: Vec<VertexId> = surface
            .topology()
            .vertices()
            .filter(|v| is_held(part(v)))
            .collect();
        for v in held {
            solver.pin(surface, v)?;
        }
        Ok(())
    }

    /// Takes hold of one end, leads it around a circle, and lets go.
    fn drag(&mut self) -> Found<()> {
        let dt = f64::from(self.scene.params.dt);
        if (MOTION[0]..MOTION[0] + dt).contains(&self.time) {
            self.pin(|part| part.x > 0.9)?;
        }
        let pins = self.scene.body(self.body)?.solver().pins().to_vec();
        if self.progress() >= 1.0 {
            let (solver, surface) = self.scene.edit(self.body)?.solver_mut();
            for pin in pins {
                solver.unpin(surface, pin.vertex)?;
            }
            return Ok(());
        }
        let angle = std::f64::consts::TAU * self.progress();
        let velocity = Vec3::new(angle.sin(), 1.0 - angle.cos(), 0.5 * angle.sin());
        for pin in pins {
            let at = Vec3::from(pin.target.map(f64::from)) + velocity * dt;
            self.scene
                .set_pin_target(self.body, pin.vertex, to_f32(at))?;
        }
        Ok(())
    }

    /// Presses the body to 0.6 of its height with a plane, and takes that away.
    fn squeeze(&mut self) -> Found<()> {
        if self.time < MOTION[0] {
            self.height = self.corners()?[1].y;
            return Ok(());
        }
        let part = 1.0 - self.progress().min(2.0 - self.progress());
        self.scene.colliders.truncate(1);
        if self.progress() < 2.0 {
            let point = to_f32(Vec3::new(0.0, self.height * (0.6 + 0.41 * part), 0.0));
            self.scene.colliders.push(Collider::Plane {
                point,
                normal: [0.0, -1.0, 0.0],
            });
        }
        Ok(())
    }
}

/// Returns the edge of a blade around its middle \[m\].
fn edge(middle: Vec3) -> [[f32; 3]; 2] {
    [-1.5, 1.5].map(|z| to_f32(middle + Vec3::new(0.0, 0.0, z)))
}
