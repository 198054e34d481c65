//! [`Incision`]: a blade's pose and the tip at which its cut goes on in the next frame.

mod columns;
mod lead;
mod line;
mod map;
mod path;
mod piercings;

use crate::error::CutError;
use crate::intersection::facets::ContinuedTip;
use crate::sweep::Sweep;
use columns::{Column, Poses, is_at_boundary, spread};
use incise_mesh::geometry::{to_f32, to_f64};
use incise_mesh::{Aabb, HalfEdge, Surface, TriangleId, Vec3, VertexId};
use lead::{MIN_MOTION, has_moved, is_ahead, standing};
use line::{offset, point_at};
use map::BladeMap;
use path::{Path, do_vanish};
use piercings::piercings;

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
    state: IncisionState,
    /// Number of refused steps since the last step that cut.
    refused_steps: u32,
    /// The places to which the last of them would have moved the tip's vertices \[m\].
    refused: Vec<Vec3>,
}

/// Where a blade is after its last step, see [`Incision::state`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum IncisionState {
    /// Outside of the body, and it has cut nothing since it was inside.
    #[default]
    Outside,
    /// In the body, at the tip of its cut or behind it.
    Inside,
    /// Ahead of the tip, because the last step was refused. It is tried again from the same tip.
    Blocked,
    /// Outside, and its cut is complete.
    Finished,
    /// Outside, and the tip of its cut is in the body.
    Abandoned,
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

/// How a blade goes on from a tip in one step.
#[derive(Debug, Default)]
pub(crate) struct Approach {
    pub(crate) map: BladeMap,
    /// The tip, with the parameters of the nearest points of the new pose.
    tip: Vec<TipPoint>,
    /// By vertex of the tip, whether it keeps its place, and the unit vector ahead.
    stands: Vec<bool>,
    ahead: Vec<Vec3>,
    /// Whether the blade is outside of the body, so that its front must be.
    leaves: bool,
    /// The next places of the tip's vertices \[m\].
    targets: Vec<Vec3>,
}

/// Displacements of the front ahead of a blade that has left the body, tried in turn until the
/// front is outside as well [local edge lengths].
///
/// In the rest shape the blade's place is known up to second order in its motion.
const REACHES: [f64; 5] = [0.0, 0.125, 0.25, 0.5, 1.0];

/// The sweep of one step, the tip that it continues, and its points' parameters on the blade.
pub(crate) struct Stroke {
    pub(crate) sweep: Sweep,
    /// The sweep in the present shape.
    pub(crate) present: Sweep,
    pub(crate) tip: ContinuedTip,
    pub(crate) parameters: Vec<f64>,
}

impl Incision {
    /// Returns whether the blade is inside the body.
    #[must_use]
    pub fn is_inside(&self) -> bool {
        !self.tip.is_empty()
    }

    /// Returns where the blade is after its last step.
    #[must_use]
    pub fn state(&self) -> IncisionState {
        self.state
    }

    /// Returns the number of refused steps since the last one that cut.
    #[must_use]
    pub fn refused_steps(&self) -> u32 {
        self.refused_steps
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
        self.take_pose(pose);
        self.leave();
    }

    /// Ends the incision where it is; the next motion of the blade starts at its last pose.
    fn leave(&mut self) {
        self.state = if self.tip.is_empty() {
            IncisionState::Outside
        } else {
            IncisionState::Abandoned
        };
        self.tip.clear();
        self.path.clear();
        self.back = None;
        self.refused.clear();
        self.refused_steps = 0;
    }

    /// Sets the pose and the tip after a step through edges of length `local` \[m\].
    ///
    /// `moved` has the vertices of the tip where it has moved. Those that keep their places stay.
    /// `copies` returns the two vertices that a step has made of one of the last tip.
    pub(crate) fn finish_step(
        &mut self,
        pose: &[[f32; 3]],
        moved: Vec<TipPoint>,
        sweep: Sweep,
        local: f64,
        approach: &Approach,
        copies: impl Fn(VertexId) -> Option<[VertexId; 2]>,
    ) {
        let tip = with_standing(moved, &approach.tip, &approach.stands);
        self.path.open_tip(copies);
        if self.tip.is_empty() {
            self.path.start(&self.pose);
            self.local = 0.0;
        }
        // Edges beside the tip are short, because the last step split them.
        self.local = local.max(self.local * MIN_LOCAL_RATIO);
        self.take_pose(pose);
        self.back = None;
        self.refused.clear();
        self.refused_steps = 0;
        if tip.is_empty() {
            self.state = IncisionState::Finished;
            self.path.clear();
        } else {
            self.state = IncisionState::Inside;
            self.path.push(&tip);
        }
        self.tip = tip;
        self.sweep = Some(sweep);
    }

    /// Stores rest positions after a step in the rest shape.
    pub(crate) fn finish_exchange(&mut self, surface: &Surface) {
        for point in &mut self.tip {
            point.rest = surface.rest_position(point.vertex);
        }
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

    /// Returns how a motion to a new pose cuts, or none if it does not.
    ///
    /// None for the first pose, for a motion that is too small, and for one back along the path.
    /// `near` finds the triangles in a box, and `is_inside` whether a point is in the body.
    ///
    /// # Errors
    /// [`CutError::PolylineLength`] and [`CutError::SweepNotFinite`].
    pub(crate) fn begin_step(
        &mut self,
        surface: &Surface,
        blade: &[[f32; 3]],
        near: impl FnOnce(&Aabb) -> Vec<TriangleId>,
        is_inside: impl FnOnce([f32; 3]) -> bool,
    ) -> Result<Option<Approach>, CutError> {
        if blade.len() < 2 {
            let [previous, current] = [blade.len(); 2];
            return Err(CutError::PolylineLength { previous, current });
        }
        if let Some(corner) = (blade.iter()).position(|p| !p.iter().all(|x| x.is_finite())) {
            return Err(CutError::SweepNotFinite { corner });
        }
        if self.pose.len() != blade.len() {
            self.restart(blade);
            return Ok(None);
        }
        self.check_tip(surface);
        if !self.is_inside() {
            return Ok(Some(Approach::default()));
        }
        let near = near(&Aabb::around(blade.iter().copied()));
        let piercings = piercings(blade, surface, &near);
        #[expect(clippy::cast_precision_loss, reason = "few points")]
        let last = (blade.len() - 1) as f64;
        let map = BladeMap::new(surface, &self.tip, &piercings, last, self.local);
        let (tip, leads) = self.leads(surface, &map, blade, &piercings);
        let is_ahead = is_ahead(&leads);
        let is_outside = piercings.is_empty() && !is_inside(blade[0]);
        if !has_moved(&leads) && !is_outside {
            return Ok(None);
        }
        if !is_ahead && self.goes_back(surface, blade) {
            self.take_pose(blade);
            self.state = IncisionState::Inside;
            return Ok(None);
        }
        let was_out = self.state == IncisionState::Abandoned;
        if is_outside && (was_out || !is_ahead) {
            self.take_pose(blade);
            self.state = IncisionState::Abandoned;
            return Ok(None);
        }
        let width = PATH_WIDTH * self.local;
        let is_off = self.back.is_some() && !is_ahead && !self.passes_tip(surface, blade, width);
        if was_out || is_off {
            self.leave();
            return Ok(Some(Approach::default()));
        }
        let targets: Vec<Vec3> = leads.iter().map(|lead| lead.target).collect();
        if self.is_refused_at(&targets) {
            return Ok(None);
        }
        Ok(Some(Approach {
            map,
            tip,
            stands: standing(&leads, is_outside),
            ahead: leads.iter().map(|lead| lead.ahead).collect(),
            leaves: is_outside,
            targets,
        }))
    }

    /// Stores the blade's pose.
    fn take_pose(&mut self, blade: &[[f32; 3]]) {
        self.pose.clear();
        self.pose.extend_from_slice(blade);
    }

    /// Returns whether a blade is on its way through the body, behind the tip, and stores where.
    fn goes_back(&mut self, surface: &Surface, blade: &[[f32; 3]]) -> bool {
        let width = PATH_WIDTH * self.local;
        let moved = self.pose.iter().zip(blade);
        let moved = moved.map(|(&p, &q)| (to_f64(q) - to_f64(p)).norm());
        let motion = moved.fold(0.0, f64::max);
        let back = self.back.unwrap_or(0.0);
        let found = self.path.find(surface, blade, back, motion, width);
        self.back = found.or(self.back);
        found.is_some()
    }

    /// Returns whether the last step to these positions of the tip was refused \[m\].
    fn is_refused_at(&self, targets: &[Vec3]) -> bool {
        let is_near = |(a, b): (&Vec3, &Vec3)| (a - b).norm() < MIN_MOTION * self.local;
        self.refused.len() == targets.len()
            && !targets.is_empty()
            && self.refused.iter().zip(targets).all(is_near)
    }

    /// Stores that a step was refused.
    pub(crate) fn refuse(&mut self, approach: Approach) {
        self.refused = approach.targets;
        self.refused_steps += 1;
        self.state = IncisionState::Blocked;
    }

    /// Returns the sweep from the tip, or from the last pose, to a new pose.
    ///
    /// Beside the tip it rises from the surface by up to `rise` local edge lengths. None for a
    /// motion along the blade's edge. `near` finds the triangles in a box.
    ///
    /// # Errors
    /// As [`Sweep::strip`].
    pub(crate) fn stroke(
        &mut self,
        surface: &Surface,
        approach: &Approach,
        blade: &[[f32; 3]],
        rise: f64,
        near: impl FnMut(&Aabb) -> Vec<TriangleId>,
    ) -> Result<Option<Stroke>, CutError> {
        let map = &approach.map;
        let Some(columns) = self.front(surface, approach, blade, rise, near) else {
            return Ok(None);
        };
        let points = |of: fn(&Column) -> Vec3| -> Vec<[f32; 3]> {
            columns.iter().map(|column| to_f32(of(column))).collect()
        };
        let sweep = Sweep::strip(&points(|c| c.previous), &points(|c| c.current));
        let sweep = match sweep {
            Err(CutError::BladeDegenerate) => {
                if !self.is_inside() {
                    self.restart(blade);
                }
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
        let mut present = sweep.clone();
        if !map.is_identity() {
            let current = columns.iter().map(|c| point_at(blade, c.parameter));
            tip.present.extend(current);
            let previous = columns.iter().map(|c| {
                let place = (!c.vertex.is_null()).then(|| surface.rest_position(c.vertex));
                to_f32(place.unwrap_or_else(|| point_at(&self.pose, c.parameter)))
            });
            let previous: Vec<[f32; 3]> = previous.collect();
            let current: Vec<[f32; 3]> = tip.present.iter().map(|&p| to_f32(p)).collect();
            present = Sweep::strip(&previous, &current).unwrap_or(present);
        }
        Ok(Some(Stroke {
            sweep,
            present,
            tip,
            parameters: columns.iter().map(|c| c.parameter).collect(),
        }))
    }

    /// Returns the points of the next sweep; none if a blade outside has its front inside.
    fn front(
        &self,
        surface: &Surface,
        approach: &Approach,
        blade: &[[f32; 3]],
        rise: f64,
        mut near: impl FnMut(&Aabb) -> Vec<TriangleId>,
    ) -> Option<Vec<Column>> {
        let reaches = if approach.leaves {
            &REACHES[..]
        } else {
            &REACHES[..1]
        };
        let mut first = None;
        for reach in reaches {
            let offsets: Vec<Vec3> = (approach.ahead.iter())
                .map(|ahead| ahead * (reach * self.local))
                .collect();
            let poses = Poses {
                map: &approach.map,
                tip: &approach.tip,
                stands: &approach.stands,
                offsets: &offsets,
                last: &self.pose,
                new: blade,
            };
            let mut columns = self.columns(surface, &poses, rise);
            if !self.is_inside() {
                return Some(columns);
            }
            let points = columns.iter().map(|column| to_f32(column.current));
            let near = near(&Aabb::around(points));
            spread(&mut columns, surface, &near, &poses);
            if !approach.leaves || !columns::is_inside(&columns, surface, &near) {
                return Some(columns);
            }
            first = first.or(Some(columns));
        }
        first
    }

    /// Returns whether the blade is at the tip on its way to a new pose, up to `width` \[m\].
    fn passes_tip(&self, surface: &Surface, blade: &[[f32; 3]], width: f64) -> bool {
        let ends = [self.tip[0], self.tip[self.tip.len() - 1]];
        let off = |pose: &[[f32; 3]]| ends.map(|end| offset(pose, surface.position(end.vertex)));
        do_vanish(off(&self.pose), off(blade), 0.0, [[width; 2]; 2])
    }
}

/// Returns a tip with the vertices of the last one that keep their places, in order.
///
/// A part that has moved begins and ends at such vertices, or where the last tip did.
fn with_standing(moved: Vec<TipPoint>, last: &[TipPoint], stands: &[bool]) -> Vec<TipPoint> {
    let mut tip = moved;
    let is_kept = |i: usize| {
        let stays = |i: usize| stands.get(i) == Some(&true);
        stays(i) && last[i].is_joined && stays(i + 1)
    };
    for i in (0..last.len().saturating_sub(1)).filter(|&i| is_kept(i)) {
        let place = |tip: &[TipPoint], v: VertexId| tip.iter().position(|p| p.vertex == v);
        let [from, to] = [last[i], last[i + 1]];
        match (place(&tip, from.vertex), place(&tip, to.vertex)) {
            (Some(at), None) => {
                tip[at].is_joined = true;
                tip.insert(
                    at + 1,
                    TipPoint {
                        is_joined: false,
                        ..to
                    },
                );
            }
            (None, Some(at)) => tip.insert(at, from),
            (Some(at), Some(_)) => tip[at].is_joined = true,
            (None, None) => {
                let at = tip.partition_point(|p| p.parameter <= from.parameter);
                let end = TipPoint {
                    is_joined: false,
                    ..to
                };
                tip.splice(at..at, [from, end]);
            }
        }
    }
    tip
}
