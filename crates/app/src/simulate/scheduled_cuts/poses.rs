//! Poses of blades by frame: timed poses of a scene file, or the path of a file.

use super::frame_of;
use crate::blade_path::BladePath;
use crate::failure::Failure;
use crate::numbers::Numbers;
use crate::simulate::scene_file::{BladeFile, SceneFile, SceneFileError, TimedPose};
use incise_mesh::Vec3;
use incise_mesh::geometry::to_f32;
use std::path::{Path, PathBuf};
use toml::Spanned;

/// A pose of a straight blade.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pose {
    /// The frame that ends with it.
    pub(super) frame: u32,
    /// Its line in the file.
    pub(super) line: usize,
    /// Start and end of the edge in the file's coordinates \[m\].
    pub(super) edge: [[f64; 3]; 2],
}

/// Returns the poses of a blade, ascending by frames, and the file that has them.
pub(super) fn poses(
    file: &SceneFile,
    blade: &Spanned<BladeFile>,
) -> Result<(PathBuf, Vec<Pose>), Failure> {
    match blade.get_ref() {
        BladeFile {
            poses: Some(timed),
            path: None,
            at: None,
            ..
        } => Ok((file.path(), timed_poses(file, blade, timed)?)),
        BladeFile {
            poses: None,
            path: Some(path),
            at,
            ..
        } => {
            let start = frame_of(file, blade, at.unwrap_or_default())?;
            Ok((path.clone(), poses_of_path(file, blade, path, start)?))
        }
        _ => {
            let line = file.line(blade).unwrap_or_default();
            Err(file.refuse(SceneFileError::BladeMotion { line }))
        }
    }
}

fn timed_poses(
    file: &SceneFile,
    blade: &Spanned<BladeFile>,
    timed: &[Spanned<TimedPose>],
) -> Result<Vec<Pose>, Failure> {
    let mut poses: Vec<Pose> = Vec::new();
    for pose in timed {
        let &TimedPose { at, edge } = pose.get_ref();
        let frame = frame_of(file, pose, at)?;
        let line = file.line(pose).unwrap_or_default();
        if poses.last().is_some_and(|last| frame <= last.frame) {
            let dt = file.dt;
            return Err(file.refuse(SceneFileError::PoseOrder { line, at, dt }));
        }
        poses.push(Pose {
            frame,
            line,
            edge: edge.map(|Numbers(p)| p),
        });
    }
    if poses.len() < 2 {
        let line = file.line(blade).unwrap_or_default();
        return Err(file.refuse(SceneFileError::FewPoses { line }));
    }
    Ok(poses)
}

/// Reads the path of a file, one pose per frame; it must end before the simulation.
fn poses_of_path(
    file: &SceneFile,
    blade: &Spanned<BladeFile>,
    path: &Path,
    start: u32,
) -> Result<Vec<Pose>, Failure> {
    let read = BladePath::read(path)?;
    let poses = read.len();
    let end = u32::try_from(poses)
        .unwrap_or(u32::MAX)
        .saturating_add(start);
    if end > file.frames() {
        let seconds = f64::from(end) * file.dt;
        return Err(match file.line(blade) {
            None => Failure::PathAfterEnd { poses, seconds },
            Some(line) => file.refuse(SceneFileError::TimeOutside {
                line,
                at: f64::from(end - 1) * file.dt,
                seconds: file.seconds,
            }),
        });
    }
    let straight = read.straight_poses().map_err(|source| Failure::Path {
        path: path.to_owned(),
        source,
    })?;
    let poses = (start..).zip(straight);
    let poses = poses.map(|(frame, (line, edge))| Pose { frame, line, edge });
    Ok(poses.collect())
}

/// Returns the edge in a frame relative to an origin \[m\]; none before the first pose and after
/// the last one.
///
/// Between two poses the ends of the edge move straight and evenly.
pub(super) fn position_at(poses: &[Pose], frame: u32, origin: [f64; 3]) -> Option<[[f32; 3]; 2]> {
    let next = poses.partition_point(|pose| pose.frame < frame);
    let after = poses.get(next)?;
    let edge = if after.frame == frame {
        after.edge.map(Vec3::from)
    } else {
        let before = poses.get(next.checked_sub(1)?)?;
        let part = f64::from(frame - before.frame) / f64::from(after.frame - before.frame);
        [0, 1].map(|k| Vec3::from(before.edge[k]).lerp(&after.edge[k].into(), part))
    };
    Some(edge.map(|p| to_f32(p - Vec3::from(origin))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_blade_moves_evenly_between_its_poses() {
        let pose = |frame, x: f64| Pose {
            frame,
            line: 1,
            edge: [[x, 0.0, -1.0], [x, 0.0, 1.0]],
        };
        let poses = [pose(3, 0.0), pose(7, 1.0), pose(8, 3.0)];
        let x = |frame| position_at(&poses, frame, [10.0, 0.0, 0.0]).map(|[p, _]| p[0]);
        let found = [2, 3, 4, 6, 7, 8, 9].map(x);
        let expected = [
            None,
            Some(-10.0),
            Some(-9.75),
            Some(-9.25),
            Some(-9.0),
            Some(-7.0),
            None,
        ];
        assert_eq!(found, expected);
    }
}
