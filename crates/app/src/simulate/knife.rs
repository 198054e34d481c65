//! [`Knife`]: the cuts of a simulation, by planes or by a blade along its path.

use super::bodies::Bodies;
use crate::blade_path::{BladePath, StraightPose};
use crate::cut_options::plane_sweep;
use crate::failure::Failure;
use crate::input::in_file;
use crate::numbers::Numbers;
use crate::stroke::{check_start, step_failure};
use incise_cut::Sweep;
use incise_mesh::Aabb;
use incise_scene::{BladeId, Scene};
use std::path::Path;

/// A cut along a plane through all bodies in one frame.
pub(super) struct PlaneCut {
    plane: Numbers<4>,
    frame: u32,
    blade: Option<BladeId>,
    /// Triangles hit.
    hits: usize,
}

/// The motion of the blades.
enum Motion<'a> {
    /// Each through the bodies in one frame; in that frame the first one cuts first.
    Planes(Vec<PlaneCut>),
    /// One pose per frame.
    Path {
        file: &'a Path,
        poses: Vec<StraightPose>,
        /// The frame of the first pose.
        start: u32,
        blade: Option<BladeId>,
    },
}

/// The cuts of a simulation.
pub(super) struct Knife<'a> {
    motion: Motion<'a>,
    /// Triangles hit so far.
    pub(super) triangles_hit: usize,
    /// Frames with a cut so far.
    cutting_frames: usize,
    /// Bounding box of the bodies at the first cut.
    pub(super) bounds_at_start: Aabb,
}

impl<'a> Knife<'a> {
    /// Creates cuts along planes, each with its frame.
    pub(super) fn from_planes(planes: impl Iterator<Item = (Numbers<4>, u32)>) -> Self {
        let cut = |(plane, frame)| PlaneCut {
            plane,
            frame,
            blade: None,
            hits: 0,
        };
        Self::new(Motion::Planes(planes.map(cut).collect()))
    }

    /// Creates the cut along the path of a file, relative to an origin, from frame `start` on.
    pub(super) fn from_path(
        (file, path): &(&'a Path, BladePath),
        origin: [f64; 3],
        start: u32,
    ) -> Result<Self, Failure> {
        let poses = path.straight_poses(origin);
        let poses = poses.map_err(|source| Failure::Path {
            path: (*file).to_owned(),
            source,
        })?;
        Ok(Self::new(Motion::Path {
            file,
            poses,
            start,
            blade: None,
        }))
    }

    fn new(motion: Motion<'a>) -> Self {
        Self {
            motion,
            triangles_hit: 0,
            cutting_frames: 0,
            bounds_at_start: Aabb::default(),
        }
    }

    /// Returns whether a motion begins in a frame.
    fn begins_in(&self, frame: u32) -> bool {
        match &self.motion {
            Motion::Planes(cuts) => cuts.iter().any(|cut| cut.frame == frame),
            Motion::Path { start, .. } => *start == frame,
        }
    }

    /// Moves the blades for a frame of the scene.
    pub(super) fn before_frame(
        &mut self,
        frame: u32,
        scene: &mut Scene,
        bodies: &Bodies,
    ) -> Result<(), Failure> {
        let mut bounds = Aabb::default();
        if self.begins_in(frame) {
            for (surface, _) in bodies.surfaces(scene)? {
                bounds = bounds.union(surface.bounds());
            }
            if self.triangles_hit == 0 {
                self.bounds_at_start = in_file(bodies.origin, &bounds);
            }
        }
        let pose = self.pose(frame);
        match &mut self.motion {
            Motion::Planes(cuts) => {
                for cut in cuts.iter_mut().filter(|cut| cut.frame == frame) {
                    let path = bodies.all_paths();
                    let sweep = plane_sweep(cut.plane, bodies.origin, &bounds, &path)?;
                    let [before, after] = sweep.ends();
                    let blade = scene.add_blade(before);
                    let moved = scene.move_blade(blade, after);
                    moved.map_err(|source| bodies.failed(source))?;
                    cut.blade = Some(blade);
                }
            }
            Motion::Path { blade, .. } => match (pose, *blade) {
                (Some((_, pose)), Some(blade)) => {
                    let moved = scene.move_blade(blade, pose);
                    moved.map_err(|source| bodies.failed(source))?;
                }
                (Some((_, pose)), None) => *blade = Some(scene.add_blade(pose)),
                (None, _) => {}
            },
        }
        Ok(())
    }

    /// Counts the cuts of a frame, and reports one that failed.
    pub(super) fn after_frame(
        &mut self,
        frame: u32,
        scene: &mut Scene,
        bodies: &Bodies,
    ) -> Result<(), Failure> {
        let stats = *scene.stats();
        self.triangles_hit += stats.hit_triangles;
        self.cutting_frames += usize::from(stats.cuts > 0);
        let failed = scene.failed_cuts().first().map(|cut| (cut.body, cut.error));
        let pose = self.pose(frame);
        match &mut self.motion {
            Motion::Planes(cuts) => {
                if let Some((body, source)) = failed {
                    let path = bodies.path(body);
                    return Err(Failure::Cut { path, source });
                }
                for result in scene.cuts() {
                    let made = result.cut.as_ref().map_or(0, |(_, cut)| cut.report.hits);
                    let own = cuts.iter_mut().find(|cut| cut.blade == Some(result.blade));
                    if let Some(cut) = own {
                        cut.hits += made;
                    }
                }
            }
            Motion::Path {
                file, poses, start, ..
            } => {
                // A blade at rest at its last pose cuts no more.
                let Some((line, _)) = pose else {
                    return Ok(());
                };
                if let Some((_, error)) = failed {
                    return Err(step_failure(file, line, error));
                }
                if frame == *start + 1
                    && self.triangles_hit == 0
                    && let Ok(sweep) = Sweep::new(poses[0].1, poses[1].1)
                {
                    for (surface, _) in bodies.surfaces(scene)? {
                        check_start(surface, &sweep, file, line)?;
                    }
                }
            }
        }
        Ok(())
    }

    /// Returns the planes that hit nothing.
    pub(super) fn missed_planes(&self) -> impl Iterator<Item = Numbers<4>> {
        let cuts = match &self.motion {
            Motion::Planes(cuts) => cuts.as_slice(),
            Motion::Path { .. } => &[],
        };
        let missed = cuts.iter().filter(|cut| cut.hits == 0);
        missed.map(|cut| cut.plane)
    }

    /// Returns the number of motions from pose to pose; none for planes.
    pub(super) fn steps(&self) -> Option<usize> {
        match &self.motion {
            Motion::Planes(_) => None,
            Motion::Path { poses, .. } => Some(poses.len() - 1),
        }
    }

    /// Returns the number of steps that cut; none for planes.
    pub(super) fn cutting_steps(&self) -> Option<usize> {
        self.steps().map(|_| self.cutting_frames)
    }

    /// Returns the pose of a frame, and its line; none before and after the path.
    fn pose(&self, frame: u32) -> Option<StraightPose> {
        let Motion::Path { poses, start, .. } = &self.motion else {
            return None;
        };
        let i = frame.checked_sub(*start)?;
        poses.get(usize::try_from(i).ok()?).copied()
    }
}
