//! [`Knife`]: the cut of a simulation, by a plane in one frame or by a blade along its path.

use crate::blade_path::{BladePath, StraightPose};
use crate::cut_options::plane_sweep;
use crate::failure::Failure;
use crate::input::file_bounds;
use crate::numbers::Numbers;
use crate::stroke::{check_start, step_failure};
use incise_cut::Sweep;
use incise_mesh::Aabb;
use incise_scene::{BladeId, BodyId, Scene, SceneError};
use std::path::Path;

/// The motion of the blade.
enum Motion<'a> {
    /// Through the whole body in one frame.
    Plane(Numbers<4>),
    /// One pose per frame.
    Path {
        file: &'a Path,
        poses: Vec<StraightPose>,
    },
}

/// The cut of a simulation.
pub(super) struct Knife<'a> {
    /// The body's file, for errors.
    input: &'a Path,
    motion: Motion<'a>,
    /// The first frame of the motion.
    start: u32,
    blade: Option<BladeId>,
    /// Triangles hit so far.
    pub(super) triangles_hit: usize,
    /// Frames with a cut so far.
    cutting_frames: usize,
    /// Bounding box of the body at the start.
    pub(super) bounds_at_start: Aabb,
}

impl<'a> Knife<'a> {
    /// Creates the cut along a plane in frame `start`; `input` names the body in errors.
    pub(super) fn from_plane(input: &'a Path, plane: Numbers<4>, start: u32) -> Self {
        Self::new(input, Motion::Plane(plane), start)
    }

    /// Creates the cut along the path of a file, relative to an origin, from frame `start` on.
    pub(super) fn from_path(
        input: &'a Path,
        (file, path): &(&'a Path, BladePath),
        origin: [f64; 3],
        start: u32,
    ) -> Result<Self, Failure> {
        let poses = path.straight_poses(origin);
        let poses = poses.map_err(|source| Failure::Path {
            path: (*file).to_owned(),
            source,
        })?;
        Ok(Self::new(input, Motion::Path { file, poses }, start))
    }

    fn new(input: &'a Path, motion: Motion<'a>, start: u32) -> Self {
        Self {
            input,
            motion,
            start,
            blade: None,
            triangles_hit: 0,
            cutting_frames: 0,
            bounds_at_start: Aabb::default(),
        }
    }

    /// Moves the blade for a frame of the scene.
    pub(super) fn before_frame(
        &mut self,
        frame: u32,
        scene: &mut Scene,
        body: BodyId,
    ) -> Result<(), Failure> {
        let input = self.input;
        let failed = |source| scene_failure(input, source);
        if frame == self.start {
            scene.read_back(body).map_err(failed)?;
            let surface = scene.body(body).map_err(failed)?.surface();
            self.bounds_at_start = file_bounds(surface);
            if let Motion::Plane(plane) = self.motion {
                let sweep = plane_sweep(plane, surface, input)?;
                let [before, after] = sweep.ends();
                let blade = scene.add_blade(before);
                return scene.move_blade(blade, after).map_err(failed);
            }
        }
        let Some((_, pose)) = self.pose(frame) else {
            return Ok(());
        };
        if let Some(blade) = self.blade {
            return scene.move_blade(blade, pose).map_err(failed);
        }
        self.blade = Some(scene.add_blade(pose));
        Ok(())
    }

    /// Counts the cuts of a frame, and reports one that failed.
    pub(super) fn after_frame(
        &mut self,
        frame: u32,
        scene: &mut Scene,
        body: BodyId,
    ) -> Result<(), Failure> {
        let stats = *scene.stats();
        self.triangles_hit += stats.hit_triangles;
        self.cutting_frames += usize::from(stats.cuts > 0);
        let failed_cut = scene.failed_cuts().first().map(|cut| cut.error);
        let Motion::Path { file, poses } = &self.motion else {
            let path = self.input.to_owned();
            return failed_cut.map_or(Ok(()), |source| Err(Failure::Cut { path, source }));
        };
        // A blade at rest at its last pose cuts no more.
        let Some((line, _)) = self.pose(frame) else {
            return Ok(());
        };
        if let Some(error) = failed_cut {
            return Err(step_failure(file, line, error));
        }
        if frame == self.start + 1
            && self.triangles_hit == 0
            && let Ok(sweep) = Sweep::new(poses[0].1, poses[1].1)
        {
            let failed = |source| scene_failure(self.input, source);
            scene.read_back(body).map_err(failed)?;
            let surface = scene.body(body).map_err(failed)?.surface();
            check_start(surface, &sweep, file, line)?;
        }
        Ok(())
    }

    /// Returns the number of motions from pose to pose; none for a plane.
    pub(super) fn steps(&self) -> Option<usize> {
        match &self.motion {
            Motion::Plane(_) => None,
            Motion::Path { poses, .. } => Some(poses.len() - 1),
        }
    }

    /// Returns the number of steps that cut; none for a plane.
    pub(super) fn cutting_steps(&self) -> Option<usize> {
        self.steps().map(|_| self.cutting_frames)
    }

    /// Returns the pose of a frame, and its line; none before and after the path.
    fn pose(&self, frame: u32) -> Option<StraightPose> {
        let Motion::Path { poses, .. } = &self.motion else {
            return None;
        };
        let i = frame.checked_sub(self.start)?;
        poses.get(usize::try_from(i).ok()?).copied()
    }
}

fn scene_failure(input: &Path, source: SceneError) -> Failure {
    Failure::Scene {
        path: input.to_owned(),
        source,
    }
}
