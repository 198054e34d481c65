//! [`Stroke`]: the sums of a blade's motion along a path through a surface at rest.

use crate::blade_position::blade_starts_inside;
use crate::cutter::Cutter;
use crate::error::CutError;
use crate::incision::Incision;
use crate::outcome::{CutOutcome, CutReport};
use crate::params::CutParams;
use crate::sweep::Sweep;
use incise_mesh::Surface;

/// Sums over several cuts: the result of [`Cutter::advance_along`].
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct Stroke {
    /// Sums over all steps.
    pub report: CutReport,
    /// Number of steps that cut.
    pub cutting_steps: usize,
    /// Number of vertices of the tip in the body at the end; 0 outside.
    pub tip_vertices: usize,
}

impl Stroke {
    /// Adds the counts and times of a cut.
    pub fn add(&mut self, cut: &CutOutcome) {
        self.report += cut.report;
        self.cutting_steps += usize::from(!cut.is_miss());
    }
}

/// The reason why a blade cannot move along a path. Poses are numbered from 0.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StrokeError {
    /// A step is refused.
    #[error("pose {pose}: {error}")]
    Step {
        /// The pose to which it leads.
        pose: usize,
        /// The reason.
        error: CutError,
    },
    /// The blade starts inside a body and does not leave it.
    #[error(
        "pose {pose}: the blade starts inside the body and does not leave it; let the path begin \
         outside"
    )]
    StartsInside {
        /// The pose to which the step leads.
        pose: usize,
    },
    /// No two poses span an area.
    #[error("the path has no motion; give at least two poses that differ across the blade's edge")]
    NoMotion,
}

impl Cutter {
    /// Moves a blade along a path through a surface at rest, pose by pose \[m\].
    ///
    /// `each` gets the outcome of every step. See [`Self::advance`] for a surface that moves.
    ///
    /// # Errors
    /// [`StrokeError`]; the surface is then cut by the steps before.
    pub fn advance_along<'a>(
        &mut self,
        surface: &mut Surface,
        poses: impl IntoIterator<Item = &'a [[f32; 3]]>,
        params: &CutParams,
        mut each: impl FnMut(&CutOutcome),
    ) -> Result<Stroke, StrokeError> {
        let mut incision = Incision::default();
        let mut stroke = Stroke::default();
        let mut previous: Option<&[[f32; 3]]> = None;
        let mut has_moved = false;
        for (i, pose) in poses.into_iter().enumerate() {
            let step = self.advance(surface, &mut incision, pose, params);
            let outcome = step.map_err(|error| match error {
                CutError::PartialCut { .. } => StrokeError::StartsInside { pose: i },
                error => StrokeError::Step { pose: i, error },
            })?;
            stroke.add(&outcome);
            each(&outcome);
            let sweep = previous.and_then(|previous| Sweep::strip(previous, pose).ok());
            if let Some(sweep) = sweep {
                // A step without an area, and one that misses, leave it open whether the blade
                // started inside.
                let may_be_inside = !has_moved && stroke.report.hits == 0;
                if may_be_inside && blade_starts_inside(surface, &sweep) {
                    return Err(StrokeError::StartsInside { pose: i });
                }
                has_moved = true;
            }
            previous = Some(pose);
        }
        if !has_moved {
            return Err(StrokeError::NoMotion);
        }
        stroke.tip_vertices = incision.tip().count();
        Ok(stroke)
    }
}
