//! [`Incision`]: a blade's pose and the tip at which its cut goes on in the next frame.

mod columns;
mod path;

use crate::error::CutError;
use crate::intersection::facets::ContinuedTip;
use crate::sweep::Sweep;
use columns::{Column, is_at_boundary, point_at, spread};
use incise_mesh::geometry::{to_f32, to_f64};
use incise_mesh::{Bvh, HalfEdge, Surface, Vec3, VertexId};
use path::{Path, do_vanish};

/// Motion of the blade after which the cut goes on [local edge lengths].
///
/// Smaller steps add up, so that walls do not get triangles far smaller than the surface's.
const MIN_STEP: f64 = 0.5;

/// Minimum ratio of the local edge length of a step to that of the step before.
const MIN_LOCAL_RATIO: f64 = 0.7;

/// Distance from its path within which the blade moves back in its own slit [local edge lengths].
const PATH_WIDTH: f64 = 0.25;

/// A blade that moves through a surface from frame to frame, see [`crate::Cutter::advance`].
///
/// The blade's edge is a polyline. Where its last motion ended inside the body, the incision's tip
/// consists of vertices of the surface. They move with the body, and the next motion starts at
/// their present positions.
///
/// A blade that moves back the way it came cuts nothing until it is at the tip again. Where it
/// leaves that way, it cuts a branch.
///
/// The undo of a cut does not restore it: keep a clone from before each step and put that back, or
/// call [`Self::restart`].
///
/// With the feature `serde`, `validate` must follow its `Deserialize`.
#[derive(Debug, Clone, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Incision {
    pose: Vec<[f32; 3]>,
    tip: Vec<TipPoint>,
    path: Path,
    /// The distance by which the blade has moved back from the tip \[m\].
    back: Option<f64>,
    /// Edge length of the surface around the tip \[m\].
    local: f64,
    sweep: Option<Sweep>,
}

/// A vertex of the tip.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct TipPoint {
    pub(crate) vertex: VertexId,
    /// Its rest position, by which it is recognized \[m\].
    pub(crate) rest: Vec3,
    /// Its parameter on the blade's polyline: the number of a point plus the part of the way to the
    /// next one.
    pub(crate) parameter: f64,
    /// Whether an edge of the tip joins it to the next point.
    pub(crate) is_joined: bool,
    /// Whether the next part of the tip begins at the same parameter, across two coincident walls.
    pub(crate) meets_next: bool,
}

/// The sweep of one step, the tip that it continues, and its points' parameters on the blade.
pub(crate) struct Stroke {
    pub(crate) sweep: Sweep,
    pub(crate) tip: ContinuedTip,
    pub(crate) parameters: Vec<f64>,
}

impl Incision {
    /// Returns whether the blade is inside the body.
    #[must_use]
    pub fn is_inside(&self) -> bool {
        !self.tip.is_empty()
    }

    /// Iterates over the vertices of the tip, along the blade.
    pub fn tip(&self) -> impl Iterator<Item = VertexId> + '_ {
        self.tip.iter().map(|point| point.vertex)
    }

    /// Returns the sweep of the last step that cut.
    #[must_use]
    pub fn sweep(&self) -> Option<&Sweep> {
        self.sweep.as_ref()
    }

    /// Checks an incision that was read with serde.
    ///
    /// Vertices of its tip that the surface does not have end the incision at its next step.
    ///
    /// # Errors
    /// [`CutError::PolylineLength`] for a blade of less than two points, and as [`Sweep::strip`].
    #[cfg(feature = "serde")]
    pub fn validate(&self) -> Result<(), CutError> {
        let Path { entry, tips } = &self.path;
        let is_cut_off = |line: &[[f32; 3]], is_used: bool| is_used && line.len() < 2;
        if is_cut_off(&self.pose, !self.tip.is_empty()) || is_cut_off(entry, !tips.is_empty()) {
            let (previous, current) = (entry.len(), self.pose.len());
            return Err(CutError::PolylineLength { previous, current });
        }
        self.sweep.as_ref().map_or(Ok(()), Sweep::check)
    }

    /// Ends the incision where it is; the next motion of the blade starts at `pose` \[m\].
    pub fn restart(&mut self, pose: &[[f32; 3]]) {
        self.pose.clear();
        self.pose.extend_from_slice(pose);
        self.leave();
    }

    /// Ends the incision where it is; the next motion of the blade starts at its last pose.
    fn leave(&mut self) {
        self.tip.clear();
        self.path.clear();
        self.back = None;
    }

    /// Sets the pose and the tip after a step through edges of length `local` \[m\].
    pub(crate) fn finish_step(
        &mut self,
        pose: &[[f32; 3]],
        tip: Vec<TipPoint>,
        sweep: Sweep,
        local: f64,
    ) {
        if self.tip.is_empty() {
            self.path.start(&self.pose);
            self.local = 0.0;
        }
        // Edges beside the tip are short, because the last step split them.
        self.local = local.max(self.local * MIN_LOCAL_RATIO);
        self.pose.clear();
        self.pose.extend_from_slice(pose);
        self.back = None;
        if tip.is_empty() {
            self.path.clear();
        } else {
            self.path.push(&tip);
        }
        self.tip = tip;
        self.sweep = Some(sweep);
    }

    /// Removes the parts of the tip that other cuts have removed.
    fn check_tip(&mut self, surface: &Surface) {
        let topology = surface.topology();
        self.tip.retain(|point| {
            point.vertex.index() < topology.vertex_slots()
                && !topology.outgoing(point.vertex).is_null()
                && surface.rest_position(point.vertex) == point.rest
        });
        for i in 0..self.tip.len() {
            let next = self.tip.get(i + 1).map(|next| next.vertex);
            let own = self.tip[i].vertex;
            self.tip[i].is_joined &=
                next.is_some_and(|next| topology.find_half_edge(own, next).is_some());
        }
        for i in 0..self.tip.len() {
            let next = self.tip.get(i + 1).map(|next| next.parameter);
            self.tip[i].meets_next &= next == Some(self.tip[i].parameter);
        }
        // A single vertex is the tip of a sheet.
        let joined: Vec<bool> = self.tip.iter().map(|point| point.is_joined).collect();
        let mut i = 0;
        self.tip.retain(|point| {
            i += 1;
            joined[i - 1] || (i > 1 && joined[i - 2]) || is_at_boundary(surface, point.vertex)
        });
    }

    /// Returns whether a motion to a new pose cuts.
    ///
    /// False for the first pose, for a motion that is too small, and for one back along the path.
    ///
    /// # Errors
    /// [`CutError::PolylineLength`] and [`CutError::SweepNotFinite`].
    pub(crate) fn begin_step(
        &mut self,
        surface: &Surface,
        blade: &[[f32; 3]],
    ) -> Result<bool, CutError> {
        if blade.len() < 2 {
            let [previous, current] = [blade.len(); 2];
            return Err(CutError::PolylineLength { previous, current });
        }
        if let Some(corner) = (blade.iter()).position(|p| !p.iter().all(|x| x.is_finite())) {
            return Err(CutError::SweepNotFinite { corner });
        }
        if self.pose.len() != blade.len() {
            self.restart(blade);
            return Ok(false);
        }
        self.check_tip(surface);
        if self.is_inside() {
            if !self.has_moved(surface, blade) {
                return Ok(false);
            }
            let width = PATH_WIDTH * self.local;
            let moved = self.pose.iter().zip(blade);
            let moved = moved.map(|(&p, &q)| (to_f64(q) - to_f64(p)).norm());
            let motion = moved.fold(0.0, f64::max);
            let back = self.back.unwrap_or(0.0);
            if let Some(back) = self.path.find(surface, blade, back, motion, width) {
                self.pose.clear();
                self.pose.extend_from_slice(blade);
                self.back = Some(back);
                return Ok(false);
            }
            if self.back.is_some() && !self.passes_tip(surface, blade, width) {
                self.leave();
            }
        }
        Ok(true)
    }

    /// Returns the sweep from the tip, or from the last pose, to a new pose.
    ///
    /// Beside the tip it rises from the surface by up to `rise` local edge lengths. None for a
    /// motion along the blade's edge, which leaves the tip.
    ///
    /// # Errors
    /// As [`Sweep::strip`].
    pub(crate) fn stroke(
        &mut self,
        surface: &Surface,
        bvh: &Bvh,
        blade: &[[f32; 3]],
        rise: f64,
    ) -> Result<Option<Stroke>, CutError> {
        let mut columns = self.columns(surface, blade, rise);
        if self.is_inside() {
            spread(&mut columns, surface, bvh, blade);
        }
        let previous: Vec<[f32; 3]> = columns.iter().map(|c| to_f32(c.previous)).collect();
        let parameters: Vec<f64> = columns.iter().map(|c| c.parameter).collect();
        let current = parameters
            .iter()
            .map(|&parameter| to_f32(point_at(blade, parameter)));
        let current: Vec<[f32; 3]> = current.collect();
        let sweep = match Sweep::strip(&previous, &current) {
            Err(CutError::BladeDegenerate) => {
                self.restart(blade);
                return Ok(None);
            }
            sweep => sweep?,
        };
        let mut tip = ContinuedTip::default();
        if self.is_inside() {
            (tip.vertices).extend(columns.iter().map(|c| [c.vertex, c.begins]));
            let topology = surface.topology();
            let half_edge = |pair: &[Column]| {
                let [a, b] = [pair[0].begins, pair[1].vertex];
                let found = pair[0].is_joined.then(|| topology.find_half_edge(a, b));
                found.flatten().unwrap_or(HalfEdge::NULL)
            };
            tip.half_edges.extend(columns.windows(2).map(half_edge));
        }
        Ok(Some(Stroke {
            sweep,
            tip,
            parameters,
        }))
    }

    /// Returns whether the blade is at the tip on its way to a new pose, up to `width` \[m\].
    fn passes_tip(&self, surface: &Surface, blade: &[[f32; 3]], width: f64) -> bool {
        let ends = [self.tip[0], self.tip[self.tip.len() - 1]];
        let off = |pose: &[[f32; 3]]| {
            ends.map(|end| point_at(pose, end.parameter) - surface.position(end.vertex))
        };
        do_vanish(off(&self.pose), off(blade), 0.0, width)
    }

    /// Returns whether a part of the blade is far enough from the tip for the next step.
    fn has_moved(&self, surface: &Surface, blade: &[[f32; 3]]) -> bool {
        self.tip.iter().any(|point| {
            let motion = point_at(blade, point.parameter) - surface.position(point.vertex);
            motion.norm() >= MIN_STEP * self.local
        })
    }
}
