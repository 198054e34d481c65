//! [`cut_along_path`]: moves a blade through a mesh, pose by pose, for `incise cut --path`; and the
//! failures of its steps, which `incise simulate --path` shares.

use crate::blade_path::{BladePath, BladePathError};
use crate::clock::timed;
use crate::failure::Failure;
use incise_cut::{
    CutError, CutOutcome, CutParams, CutReport, Cutter, Incision, Sweep, blade_starts_inside,
};
use incise_mesh::{Surface, TriangleId};
use std::collections::HashSet;
use std::path::Path;
use std::time::Duration;

/// The result of cuts along sweeps, or of moving a blade along a path.
#[derive(Default)]
pub(crate) struct Stroke {
    /// Sums over all steps.
    pub(crate) report: CutReport,
    /// Triangles of the walls and caps.
    pub(crate) walls: Vec<TriangleId>,
    /// Number of steps that cut.
    pub(crate) cutting_steps: usize,
    /// Numbers of the sweeps that missed, from 1; empty for a path.
    pub(crate) missed: Vec<usize>,
    /// Number of vertices of the tip at the end.
    pub(crate) tips: usize,
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
) -> Result<Stroke, Failure> {
    let marked = Marked::new(surface, params);
    let (bvh_build, mut cutter) = timed(|| Cutter::new(surface));
    let mut incision = Incision::default();
    let mut stroke = Stroke {
        bvh_build,
        ..Stroke::default()
    };
    let mut previous: Option<Vec<[f32; 3]>> = None;
    // A step without an area, and one that misses, leave it open whether the blade began inside.
    let (mut has_moved, mut has_hit) = (false, false);
    for (line, pose) in path.poses(surface.origin()) {
        let step = cutter.advance(surface, &mut incision, &pose, &marked.params);
        let outcome = step.map_err(|error| step_failure(file, line, error))?;
        stroke.add(&outcome);
        has_hit |= outcome.report.hits > 0;
        let sweep = previous.and_then(|previous| Sweep::strip(&previous, &pose).ok());
        if let Some(sweep) = sweep {
            if !has_moved && !has_hit {
                check_start(surface, &sweep, file, line)?;
            }
            has_moved = true;
        }
        previous = Some(pose);
    }
    if !has_moved {
        return Err(Failure::Path {
            path: file.to_owned(),
            source: BladePathError::NoMotion,
        });
    }
    stroke.walls = marked.take(surface);
    stroke.tips = incision.tip().count();
    Ok(stroke)
}

/// A material that tells the walls of a stroke from caps that the mesh already has.
pub(crate) struct Marked {
    /// Parameters of cuts whose walls have it.
    pub(crate) params: CutParams,
    cap_material: u32,
}

impl Marked {
    /// Chooses a material that no triangle has.
    pub(crate) fn new(surface: &Surface, params: &CutParams) -> Self {
        let used: HashSet<u32> = (surface.topology().triangles())
            .map(|t| surface.material(t))
            .collect();
        let cap_material = params.cap_material;
        let free = (cap_material..).find(|material| !used.contains(material));
        Self {
            params: CutParams {
                cap_material: free.unwrap_or(cap_material),
                ..*params
            },
            cap_material,
        }
    }

    /// Returns the marked triangles, and gives them the material of caps.
    pub(crate) fn take(&self, surface: &mut Surface) -> Vec<TriangleId> {
        let is_wall = |&t: &TriangleId| surface.material(t) == self.params.cap_material;
        let walls: Vec<TriangleId> = surface.topology().triangles().filter(is_wall).collect();
        for &t in &walls {
            surface.set_material(t, self.cap_material);
        }
        walls
    }
}

impl Stroke {
    /// Adds the counts and times of a step.
    pub(crate) fn add(&mut self, step: &CutOutcome) {
        self.report += step.report;
        self.cutting_steps += usize::from(!step.is_miss());
    }
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
