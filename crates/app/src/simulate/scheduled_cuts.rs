//! [`ScheduledCuts`]: the cuts of a simulation, by planes and by blades that move along poses.

use super::bodies::Bodies;
use super::scene_file::{SceneFile, SceneFileError};
use crate::cut_options::plane_sweep;
use crate::failure::Failure;
use crate::input::in_file;
use crate::numbers::Numbers;
use crate::stroke::check_start;
use incise_cut::Sweep;
use incise_mesh::geometry::to_f32;
use incise_mesh::{Aabb, Vec3};
use incise_scene::{BladeId, FailedCut, Scene, SceneError};
use std::path::PathBuf;
use toml::Spanned;

mod poses;

use poses::{Pose, poses, position_at};

/// A blade of the scene.
struct Blade {
    motion: Motion,
    /// Its id, from its first frame on.
    id: Option<BladeId>,
    /// Triangles hit.
    hits: usize,
    /// Frames in which it cut.
    cutting_frames: usize,
    /// Whether a cut could not be made.
    is_refused: bool,
}

/// The motion of a blade.
enum Motion {
    /// Along a plane through all bodies, in one frame.
    Plane { plane: Numbers<4>, frame: u32 },
    /// Straight from pose to pose.
    Poses {
        /// The file that has the poses.
        file: PathBuf,
        /// Two or more, ascending by their frames.
        poses: Vec<Pose>,
        /// Vector from the edge to the back of its face \[m\].
        face: Option<[f32; 3]>,
    },
}

/// The cuts of a simulation.
pub(super) struct ScheduledCuts {
    blades: Vec<Blade>,
    /// Triangles hit so far.
    pub(super) hits: usize,
    /// A message for every cut that could not be made.
    pub(super) refusals: Vec<String>,
    /// Bounding box of the bodies at the first cut.
    pub(super) bounds_at_start: Aabb,
}

impl ScheduledCuts {
    /// Creates the cuts of a scene; all times must be within it.
    pub(super) fn new(file: &SceneFile) -> Result<Self, Failure> {
        let mut motions = Vec::new();
        for cut in &file.cuts {
            let (frame, plane) = (frame_of(file, cut, cut.get_ref().at)?, cut.get_ref().plane);
            motions.push(Motion::Plane { plane, frame });
        }
        for blade in &file.blades {
            let (poses_file, poses) = poses(file, blade)?;
            motions.push(Motion::Poses {
                file: poses_file,
                poses,
                face: (blade.get_ref().face).map(|Numbers(face)| to_f32(Vec3::from(face))),
            });
        }
        let blade = |motion| Blade {
            motion,
            id: None,
            hits: 0,
            cutting_frames: 0,
            is_refused: false,
        };
        Ok(Self {
            blades: motions.into_iter().map(blade).collect(),
            hits: 0,
            refusals: Vec::new(),
            bounds_at_start: Aabb::default(),
        })
    }

    /// Returns true without cuts.
    pub(super) fn is_empty(&self) -> bool {
        self.blades.is_empty()
    }

    /// Moves the blades for a frame of the scene.
    pub(super) fn before_frame(
        &mut self,
        frame: u32,
        scene: &mut Scene,
        bodies: &Bodies,
    ) -> Result<(), Failure> {
        let mut bounds = Aabb::default();
        if self
            .blades
            .iter()
            .any(|blade| blade.motion.begins_in(frame))
        {
            for (surface, _) in bodies.surfaces(scene)? {
                bounds = bounds.union(surface.bounds());
            }
            if self.hits == 0 {
                self.bounds_at_start = in_file(bodies.origin, &bounds);
            }
        }
        for blade in &mut self.blades {
            match &blade.motion {
                &Motion::Plane { plane, frame: own } if own == frame => {
                    let path = bodies.all_paths();
                    let sweep = plane_sweep(plane, bodies.origin, &bounds, &path)?;
                    let [before, after] = sweep.ends();
                    let id = scene.add_blade(before);
                    blade.id = Some(id);
                    scene.move_blade(id, after)
                }
                Motion::Plane { .. } => Ok(()),
                Motion::Poses { poses, face, .. } => {
                    let edge = position_at(poses, frame, bodies.origin);
                    move_blade(scene, &mut blade.id, edge, *face)
                }
            }
            .map_err(|source| bodies.failed(source))?;
        }
        Ok(())
    }

    /// Counts the cuts of a frame, and returns a message for each one that could not be made.
    pub(super) fn after_frame(
        &mut self,
        frame: u32,
        scene: &mut Scene,
        bodies: &Bodies,
    ) -> Result<&[String], Failure> {
        let first = self.refusals.len();
        let hit_triangles = scene.stats().hit_triangles;
        self.hits += hit_triangles;
        for blade in &mut self.blades {
            let Some(id) = blade.id else { continue };
            let failed = scene.failed_cuts().iter().filter(|cut| cut.blade == id);
            let before = self.refusals.len();
            let at = f64::from(frame) * f64::from(scene.params.dt);
            let failed = failed.filter_map(|cut| blade.refusal(frame, at, cut, bodies));
            self.refusals
                .extend(failed.map(|failure| failure.to_string()));
            blade.is_refused |= self.refusals.len() > before;
            let own = scene.cuts().iter().filter(|result| result.blade == id);
            let cuts = own.filter_map(|result| result.cut.as_ref());
            let mut has_cut = false;
            for (_, cut) in cuts {
                blade.hits += cut.report.hits;
                has_cut = true;
            }
            blade.cutting_frames += usize::from(has_cut);
            if hit_triangles == 0 {
                blade.check_start(frame, scene, bodies)?;
            }
        }
        Ok(&self.refusals[first..])
    }

    /// Returns the edges of the blades that move from pose to pose \[m\].
    pub(super) fn edges(&self, scene: &Scene) -> impl Iterator<Item = [[f32; 3]; 2]> {
        let moving =
            (self.blades.iter()).filter(|blade| matches!(blade.motion, Motion::Poses { .. }));
        let ids = moving.filter_map(|blade| blade.id);
        ids.filter_map(|id| Some(scene.blade(id).ok()?.edge()))
    }

    /// Returns a message for every blade that hit nothing.
    pub(super) fn misses(&self) -> impl Iterator<Item = String> {
        let is_miss = |blade: &&Blade| blade.hits == 0 && !blade.is_refused;
        let missed = self.blades.iter().filter(is_miss);
        missed.map(|blade| match &blade.motion {
            Motion::Plane {
                plane: Numbers([x, y, z, d]),
                ..
            } => format!("the plane {x},{y},{z},{d} misses all bodies"),
            Motion::Poses { file, poses, .. } => {
                let (file, line) = (file.display(), poses[0].line);
                format!("{file}: line {line}: the blade cuts no body")
            }
        })
    }

    /// Returns the frames in which blades move from pose to pose; none for planes alone.
    pub(super) fn steps(&self) -> Option<usize> {
        let steps = self.blades.iter().filter_map(|blade| match &blade.motion {
            Motion::Plane { .. } => None,
            Motion::Poses { poses, .. } => {
                let [first, last] = [poses.first()?, poses.last()?].map(|pose| pose.frame);
                usize::try_from(last - first).ok()
            }
        });
        steps.reduce(|a, b| a + b)
    }

    /// Returns the number of steps that cut; none for planes alone.
    pub(super) fn cutting_steps(&self) -> Option<usize> {
        let moving = (self.blades.iter())
            .filter(|blade| matches!(blade.motion, Motion::Poses { .. }))
            .map(|blade| blade.cutting_frames);
        moving.reduce(|a, b| a + b)
    }
}

impl Motion {
    /// Returns whether it begins in a frame.
    fn begins_in(&self, frame: u32) -> bool {
        match self {
            Self::Plane { frame: own, .. } => *own == frame,
            Self::Poses { poses, .. } => poses[0].frame == frame,
        }
    }
}

impl Blade {
    /// Returns the failure of a cut of this blade in a frame, at a time \[s\]; none of one at its
    /// last pose.
    fn refusal(&self, frame: u32, at: f64, failed: &FailedCut, bodies: &Bodies) -> Option<Failure> {
        let source = failed.error;
        match &self.motion {
            Motion::Plane { .. } => Some(Failure::SkippedCut {
                path: bodies.path(failed.body),
                at,
                source,
            }),
            Motion::Poses { file, poses, .. } => {
                let target = poses.iter().find(|pose| pose.frame >= frame)?;
                Some(Failure::SkippedStep {
                    path: file.clone(),
                    at,
                    line: target.line,
                    source,
                })
            }
        }
    }

    /// Refuses a blade whose first step, in this frame, has hit nothing and is inside a body.
    fn check_start(&self, frame: u32, scene: &mut Scene, bodies: &Bodies) -> Result<(), Failure> {
        let Motion::Poses { file, poses, .. } = &self.motion else {
            return Ok(());
        };
        if frame != poses[0].frame + 1 || self.hits > 0 {
            return Ok(());
        }
        let edges = [frame - 1, frame].map(|frame| position_at(poses, frame, bodies.origin));
        if let [Some(before), Some(after)] = edges
            && let Ok(sweep) = Sweep::new(before, after)
        {
            for (surface, _) in bodies.surfaces(scene)? {
                check_start(surface, &sweep, file, poses[1].line)?;
            }
        }
        Ok(())
    }
}

/// Moves a blade to an edge, or adds it there.
fn move_blade(
    scene: &mut Scene,
    id: &mut Option<BladeId>,
    edge: Option<[[f32; 3]; 2]>,
    face: Option<[f32; 3]>,
) -> Result<(), SceneError> {
    match (edge, *id) {
        (Some(edge), Some(id)) => scene.move_blade(id, edge),
        (Some(edge), None) => {
            let new = scene.add_blade(edge);
            *id = Some(new);
            scene.set_blade_face(new, face)
        }
        (None, _) => Ok(()),
    }
}

/// Returns the frame of a time, which must be within the simulation.
fn frame_of<T>(file: &SceneFile, value: &Spanned<T>, at: f64) -> Result<u32, Failure> {
    let frame = file.frame_at(at);
    if at >= 0.0 && frame < file.frames() {
        return Ok(frame);
    }
    Err(match file.line(value) {
        None => Failure::CutAfterEnd,
        Some(line) => file.refuse(SceneFileError::TimeOutside {
            line,
            at,
            seconds: file.seconds,
        }),
    })
}
