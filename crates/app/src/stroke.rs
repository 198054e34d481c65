//! [`cut_along_path`]: moves a blade through a mesh, pose by pose, for `incise cut --path`; and the
//! failures of its steps, which `incise simulate --path` shares.

use crate::blade_path::{BladePath, BladePathError};
use crate::clock::timed;
use crate::failure::Failure;
use incise_cut::{
    CapMarker, CutError, CutParams, Cutter, Stroke, StrokeError, Sweep, blade_starts_inside,
};
use incise_mesh::{Surface, TriangleId};
use std::path::Path;
use std::time::Duration;

/// The result of cuts along sweeps, or of moving a blade along a path.
#[derive(Default)]
pub(crate) struct CutSums {
    pub(crate) stroke: Stroke,
    /// Triangles of the walls and caps.
    pub(crate) walls: Vec<TriangleId>,
    /// Numbers of the sweeps that missed, from 1; empty for a path.
    pub(crate) missed: Vec<usize>,
    /// Time of building the BVH.
    pub(crate) bvh_build: Duration,
}

/// Moves a blade along a path through a surface at rest.
///
/// `file` names the path in errors. The surface of a failed stroke is cut in part.
pub(crate) fn cut_along_path(
    surface: &mut Surface,
    path: &BladePath,
    params: &CutParams,
    file: &Path,
) -> Result<CutSums, Failure> {
    let marker = CapMarker::new(surface, params);
    let (lines, poses): (Vec<usize>, Vec<_>) = path.poses(surface.origin()).unzip();
    let (bvh_build, mut cutter) = timed(|| Cutter::new(surface));
    let poses = poses.iter().map(Vec::as_slice);
    let stroke = cutter.advance_along(surface, poses, marker.params(), |_| ());
    let stroke = stroke.map_err(|error| match error {
        StrokeError::Step { pose, error } => step_failure(file, lines[pose], error),
        StrokeError::StartsInside { pose } => inside(file, lines[pose]),
        _ => Failure::Path {
            path: file.to_owned(),
            source: BladePathError::NoMotion,
        },
    })?;
    Ok(CutSums {
        stroke,
        walls: marker.take(surface),
        missed: Vec::new(),
        bvh_build,
    })
}

/// Refuses the first sweep of a blade, to the pose of a line, if it lies inside the body.
///
/// It must not hit the surface.
pub(crate) fn check_start(
    surface: &Surface,
    sweep: &Sweep,
    file: &Path,
    line: usize,
) -> Result<(), Failure> {
    if blade_starts_inside(surface, sweep) {
        return Err(inside(file, line));
    }
    Ok(())
}

/// Returns the failure of the step to the pose of a line.
pub(crate) fn step_failure(file: &Path, line: usize, error: CutError) -> Failure {
    match error {
        CutError::PartialCut { .. } => inside(file, line),
        source => Failure::Step {
            path: file.to_owned(),
            line,
            source,
        },
    }
}

fn inside(file: &Path, line: usize) -> Failure {
    Failure::BladeInside {
        path: file.to_owned(),
        line,
    }
}
