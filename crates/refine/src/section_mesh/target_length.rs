//! Target edge lengths of a section, by corner.

use super::loop_triangulation::LoopTriangulation;
use super::loops::SectionLoops;
use super::refinement::off_center::distance_squared;
use super::{MIN_TARGET, SectionMeshParams};
use crate::error::RefineError;

/// Growth of the target with the distance from a rim with shorter edges \[m/m\].
const GROWTH: f64 = 0.5;
/// Number of edges on each side of a corner that its rim length is the mean of.
pub(super) const RIM_WINDOW: usize = 2;
/// Maximum ratio of the mean target to the smallest one for a single lattice.
const MAX_MEAN_TO_MIN: f64 = 1.6;
/// Maximum ratio of the largest target to the mean one for a single lattice.
const MAX_MAX_TO_MEAN: f64 = 2.0;

/// One in this many corners may have targets below the finest spacing of a graded lattice.
const FINEST_SHARE: usize = 4;

/// The spacing of a section's lattice.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Spacing {
    /// The same everywhere.
    Uniform(f64),
    /// By local targets, from this spacing on.
    Graded(f64),
}

/// The target edge length of a section mesh.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum SectionMeshSize<'a> {
    /// No target: a Steiner point is added only where no triangulation exists without it.
    #[default]
    Any,
    /// One target everywhere \[m\].
    Uniform(f64),
    /// A target for each point of the section \[m\], interpolated inside.
    ///
    /// Shape: [`Section::points`](super::Section::points).
    Local(&'a [f64]),
}

/// Minimum angles below which refinement acts on a triangle, as cos^2 of the angle.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct AngleBounds {
    /// Smoothing moves corners to the mean of their neighbors.
    pub(crate) smooth: f64,
    /// Refinement inserts a point.
    pub(crate) insert: f64,
    /// Smoothing searches around corners for a better position.
    pub(crate) search: f64,
    /// Refinement inserts a point after smoothing.
    pub(crate) insert_after_smoothing: f64,
}

impl AngleBounds {
    /// Derives the bounds from the minimum angle of the parameters \[degrees\].
    fn new(min_angle: f64) -> Self {
        let cos2 = |degrees: f64| degrees.max(0.0).to_radians().cos().powi(2);
        Self {
            smooth: cos2(min_angle + 3.0),
            insert: cos2(min_angle),
            search: cos2(min_angle - 1.0),
            insert_after_smoothing: cos2(min_angle - 6.0),
        }
    }
}

/// The target lengths of a section's corners, in its scale.
#[derive(Debug, Clone, Default)]
pub(crate) struct TargetLengths {
    /// Target of each corner; empty for [`SectionMeshSize::Any`].
    by_corner: Vec<f64>,
    /// Growth of the target with the distance from the rim \[m/m\].
    pub(crate) grading: f64,
    pub(crate) bounds: AngleBounds,
}

impl TargetLengths {
    /// Reads, checks and scales the targets.
    pub(crate) fn read(
        &mut self,
        loops: &SectionLoops,
        params: &SectionMeshParams<'_>,
    ) -> Result<(), RefineError> {
        self.by_corner.clear();
        self.grading = params.grading;
        if !(params.grading >= 0.0 && params.grading.is_finite()) {
            return Err(RefineError::NegativeGrading {
                grading: params.grading,
            });
        }
        if !(0.0..=60.0).contains(&params.min_angle) {
            return Err(RefineError::InvalidMinAngle {
                degrees: params.min_angle,
            });
        }
        self.bounds = AngleBounds::new(params.min_angle);
        let scaled = |length: f64| {
            if length > 0.0 && length.is_finite() {
                // A target beyond the largest float is larger than any section.
                Ok((length * loops.scale).clamp(4.0 * MIN_TARGET, f64::MAX))
            } else {
                Err(RefineError::NonPositiveLength { length })
            }
        };
        match params.size {
            SectionMeshSize::Any => {}
            SectionMeshSize::Uniform(length) => {
                self.by_corner
                    .resize(loops.point_ids.len(), scaled(length)?);
            }
            SectionMeshSize::Local(lengths) => {
                for &point in &loops.point_ids {
                    let length = lengths.get(point as usize);
                    let length = length.ok_or(RefineError::MissingTarget { point })?;
                    self.by_corner.push(scaled(*length)?);
                }
            }
        }
        Ok(())
    }

    /// Returns whether there is no target.
    pub(crate) fn is_any(&self) -> bool {
        self.by_corner.is_empty()
    }

    /// Returns the target at a corner.
    pub(crate) fn at(&self, corner: u32) -> f64 {
        self.by_corner[corner as usize]
    }

    /// Returns [`graded_length`] with the section's grading.
    pub(crate) fn graded(&self, near: f64, far: f64, way: f64) -> f64 {
        graded_length(near, far, way, self.grading)
    }

    /// Appends the targets at the vertices of the loops, limited by the edges of the rim there.
    pub(crate) fn along_rim(&self, triangulation: &LoopTriangulation, out: &mut Vec<f64>) {
        for (v, &corner) in (0..).zip(&triangulation.corner_of) {
            let mut at = (0..RIM_WINDOW).fold(v, |v, _| triangulation.prev(v));
            let own = rim_length_at(|_| {
                let from = at;
                at = triangulation.next[from as usize];
                distance_squared(triangulation.cdt.point(from), triangulation.cdt.point(at)).sqrt()
            });
            out.push(self.at(corner).min(own));
        }
    }

    /// Returns the lattice for these corners, unless there is no target.
    ///
    /// Without grading and with similar targets, one spacing serves the whole section.
    #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^53 corners")]
    pub(crate) fn spacing(&self, corners: &[u32], scratch: &mut Vec<f64>) -> Option<Spacing> {
        if self.is_any() || corners.is_empty() {
            return None;
        }
        let (mut low, mut high, mut sum) = (f64::INFINITY, 0.0f64, 0.0);
        for target in corners.iter().map(|&corner| self.at(corner)) {
            low = low.min(target);
            high = high.max(target);
            sum += target;
        }
        let mean = if low == high {
            low
        } else {
            sum / corners.len() as f64
        };
        let is_similar = mean <= MAX_MEAN_TO_MIN * low && high <= MAX_MAX_TO_MEAN * mean;
        if is_similar && self.grading > 0.0 {
            return Some(Spacing::Graded(mean));
        }
        if is_similar {
            return Some(Spacing::Uniform(mean));
        }
        scratch.clear();
        scratch.extend(corners.iter().map(|&corner| self.at(corner)));
        let place = scratch.len() / FINEST_SHARE;
        let (_, &mut finest, _) = scratch.select_nth_unstable_by(place, f64::total_cmp);
        Some(Spacing::Graded(finest))
    }
}

/// Returns the rim length at a corner: the mean length of the edges `0..2 * RIM_WINDOW` around it.
#[expect(clippy::cast_precision_loss, reason = "a handful of edges")]
pub(super) fn rim_length_at(edge: impl FnMut(usize) -> f64) -> f64 {
    (0..2 * RIM_WINDOW).map(edge).sum::<f64>() / (2 * RIM_WINDOW) as f64
}

/// Returns the target at distance `way` from a point with target `near`.
///
/// It grows by [`GROWTH`] up to `far`, the target far from the rim, and by `grading` beyond.
pub(super) fn graded_length(near: f64, far: f64, way: f64, grading: f64) -> f64 {
    let slow = way - ((far - near) / GROWTH).max(0.0);
    if slow < 0.0 {
        near + GROWTH * way
    } else {
        near.max(far) + grading * slow
    }
}
