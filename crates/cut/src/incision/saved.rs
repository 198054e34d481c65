//! [`SavedIncision`]: a blade's pose, tip and path, for files.

use super::path::Path;
use super::{Incision, TipPoint};
use crate::error::CutError;
use crate::sweep::Sweep;
use incise_mesh::VertexId;
use incise_mesh::geometry::Vec3;
use serde::{Deserialize, Serialize};

/// The state of an [`Incision`], as it is saved.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct SavedIncision {
    pose: Vec<[f32; 3]>,
    tip: Vec<SavedTipPoint>,
    entry: Vec<[f32; 3]>,
    tips: Vec<[SavedTipPoint; 2]>,
    back: Option<f64>,
    local: f64,
    /// The points of the last sweep.
    sweep: Option<Vec<[f32; 3]>>,
}

/// See [`TipPoint`].
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
struct SavedTipPoint {
    vertex: VertexId,
    rest: [f64; 3],
    parameter: f64,
    is_joined: bool,
    meets_next: bool,
}

impl From<&TipPoint> for SavedTipPoint {
    fn from(point: &TipPoint) -> Self {
        Self {
            vertex: point.vertex,
            rest: point.rest.into(),
            parameter: point.parameter,
            is_joined: point.is_joined,
            meets_next: point.meets_next,
        }
    }
}

impl From<SavedTipPoint> for TipPoint {
    fn from(point: SavedTipPoint) -> Self {
        Self {
            vertex: point.vertex,
            rest: Vec3::from(point.rest),
            parameter: point.parameter,
            is_joined: point.is_joined,
            meets_next: point.meets_next,
        }
    }
}

impl Incision {
    /// Returns the state as plain data for a file.
    #[must_use]
    pub fn to_saved(&self) -> SavedIncision {
        let (entry, tips) = self.path.parts();
        SavedIncision {
            pose: self.pose.clone(),
            tip: self.tip.iter().map(SavedTipPoint::from).collect(),
            entry: entry.to_vec(),
            tips: tips
                .iter()
                .map(|tip| tip.each_ref().map(SavedTipPoint::from))
                .collect(),
            back: self.back,
            local: self.local,
            sweep: self.sweep.as_ref().map(|sweep| sweep.points().to_vec()),
        }
    }

    /// Returns a saved incision.
    ///
    /// Vertices of its tip that the surface does not have end the incision at its next step.
    ///
    /// # Errors
    /// [`CutError::PolylineLength`] for a blade of less than two points, and as [`Sweep::strip`].
    pub fn from_saved(saved: SavedIncision) -> Result<Self, CutError> {
        let is_cut_off = |line: &[[f32; 3]], is_used: bool| is_used && line.len() < 2;
        if is_cut_off(&saved.pose, !saved.tip.is_empty())
            || is_cut_off(&saved.entry, !saved.tips.is_empty())
        {
            let (previous, current) = (saved.entry.len(), saved.pose.len());
            return Err(CutError::PolylineLength { previous, current });
        }
        let sweep = saved.sweep.map(|points| {
            let (previous, current) = points.split_at(points.len() / 2);
            Sweep::strip(previous, current)
        });
        let tips = saved.tips.into_iter().map(|tip| tip.map(TipPoint::from));
        Ok(Self {
            pose: saved.pose,
            tip: saved.tip.into_iter().map(TipPoint::from).collect(),
            path: Path::new(saved.entry, tips.collect()),
            back: saved.back,
            local: saved.local,
            sweep: sweep.transpose()?,
        })
    }
}
