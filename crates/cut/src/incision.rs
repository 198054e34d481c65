//! [`Incision`]: a blade's pose and the tip at which its cut goes on in the next frame.

mod approach;
mod closing;
mod columns;
mod entry;
mod lead;
mod line;
mod map;
mod path;
mod piercings;
mod retract;
mod rise;
mod segment;
mod step_sweep;
mod tip;

#[cfg(feature = "serde")]
use crate::error::CutError;
use crate::exact::RimMove;
use crate::sweep::Sweep;
pub(crate) use approach::Approach;
pub(crate) use columns::Extent;
use incise_mesh::{Surface, Vec3, VertexId};
use path::Path;
pub(crate) use step_sweep::StepSweep;
use tip::{extend_border, remove_cut, with_standing};

/// Minimum motion of the blade for a step [local edge lengths].
///
/// Smaller steps add up, so that walls do not get triangles far smaller than the surface's.
const MIN_STEP: f64 = 0.5;

/// Minimum ratio of the local edge length of a step to that of the step before.
const MIN_LOCAL_RATIO: f64 = 0.7;

/// Maximum of the edge length that scales motion [diagonals of the surface].
///
/// A step is half of it, so that a circle across a third of a coarse body takes twenty.
const MAX_LOCAL: f64 = 0.1;

/// Maximum distance of a retracting blade from its path [local edge lengths].
const PATH_WIDTH: f64 = 0.25;

/// A blade that moves through a surface from frame to frame, see [`crate::Cutter::advance`].
///
/// The blade's edge is a polyline. Where its last motion ended inside the body, the incision's tip
/// consists of vertices of the surface. They move with the body, and the next motion starts from
/// them.
///
/// A blade that retracts along its path cuts nothing until it is at the tip again. Off the path it
/// cuts a branch.
///
/// The undo of a cut does not restore it: keep a clone from before each step and put that back, or
/// call [`Self::restart`].
///
/// With the feature `serde`, `validate` must follow its `Deserialize`.
#[derive(Debug, Clone, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Incision {
    pose: Vec<[f32; 3]>,
    /// The blade at the last call without a tip. Its pose lags while it moves along its edge.
    last_blade: Vec<[f32; 3]>,
    tip: Vec<TipPoint>,
    /// The second tip of a slit that began in the body, from which the cut can continue.
    start_tip: Vec<TipPoint>,
    path: Path,
    /// By end of the blade, the vertices behind it at which both walls meet, up to the tip.
    ///
    /// Empty for an end that is outside of the body.
    borders: [Vec<VertexId>; 2],
    /// The distance by which the blade has moved back from the tip \[m\].
    back: Option<f64>,
    /// Edge length of the surface around the tip, see [`motion_scale`] \[m\].
    local: f64,
    sweep: Option<Sweep>,
    state: IncisionState,
    /// Number of refused steps since the last step that cut.
    refused_steps: u32,
    /// Target positions of the tip's vertices in the last refused step \[m\].
    refused: Vec<Vec3>,
}

/// Where a blade is after its last step, see [`Incision::state`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum IncisionState {
    /// Outside of the body, and it has cut nothing since it was inside.
    #[default]
    Outside,
    /// Inside the body: at the tip of its cut, or behind it in its own slit.
    Inside,
    /// The last step was refused. The next one starts from the same tip or, without one, pose.
    Blocked,
    /// The cut is complete. The blade is outside, or in its own slit if that is closed.
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
    /// Whether it is in the body and not on its surface.
    pub(crate) is_inner: bool,
}

/// The data of a step that has cut something.
pub(crate) struct Step<'a> {
    pub(crate) approach: &'a Approach,
    /// The largest length of edges along it, see [`motion_scale`] \[m\].
    pub(crate) local: f64,
    /// See `Exact::borders`.
    pub(crate) borders: [Vec<VertexId>; 2],
    /// The tip along the last pose of a blade that had none and was in the body.
    pub(crate) start: Vec<TipPoint>,
}

impl Incision {
    /// Returns whether the cut has a tip in the body.
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

    /// Returns the sweep of the last step that cut, unless it has no area in the present shape.
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
        if !self.tip.is_empty() && self.pose.len() < 2 {
            let [previous, current] = [self.pose.len(); 2];
            return Err(CutError::PolylineLength { previous, current });
        }
        self.sweep.as_ref().map_or(Ok(()), Sweep::check)
    }

    /// Ends the incision where it is; the next motion of the blade starts at `pose` \[m\].
    pub fn restart(&mut self, pose: &[[f32; 3]]) {
        self.store_pose(pose);
        self.store_blade(pose);
        self.leave();
    }

    /// Ends the incision where it is; the next motion of the blade starts at its last pose.
    fn leave(&mut self) {
        self.state = if self.tip.is_empty() {
            IncisionState::Outside
        } else {
            IncisionState::Abandoned
        };
        self.leave_tip();
        self.start_tip.clear();
        self.path.clear();
        self.back = None;
    }

    /// Forgets the tip, the border behind it, and refused steps.
    fn leave_tip(&mut self) {
        self.tip.clear();
        self.borders = Default::default();
        self.refused.clear();
        self.refused_steps = 0;
    }

    /// Moves to `pose` \[m\] a blade without a tip that was elsewhere at the last call.
    ///
    /// For callers that skip calls while a blade is far from the body.
    pub fn resume(&mut self, pose: &[[f32; 3]]) {
        let waits = self.is_inside() || self.state == IncisionState::Blocked;
        if !waits && self.last_blade != pose {
            self.move_without_cut(pose);
        }
    }

    /// Moves a blade without a tip to `pose` \[m\] without a cut.
    pub(crate) fn move_without_cut(&mut self, pose: &[[f32; 3]]) {
        self.store_pose(pose);
        self.store_blade(pose);
        self.leave_tip();
        self.back = None;
        self.state = IncisionState::Outside;
    }

    /// Stores the blade of a call.
    fn store_blade(&mut self, blade: &[[f32; 3]]) {
        self.last_blade.clear();
        self.last_blade.extend_from_slice(blade);
    }

    /// Stores the blade's pose.
    fn store_pose(&mut self, blade: &[[f32; 3]]) {
        self.pose.clear();
        self.pose.extend_from_slice(blade);
    }

    /// Follows the vertices of the last tip and of the slit through a step.
    ///
    /// `copies` returns the two vertices that the step has made of one of the last tip.
    pub(crate) fn open_path(
        &mut self,
        step: &Step<'_>,
        copies: impl Fn(VertexId) -> Option<[VertexId; 2]>,
        moves: &[RimMove],
    ) {
        if let Some(closing) = &step.approach.closing {
            self.path.push(closing.ends(&step.approach.tip));
            self.path.open(copies);
        } else {
            self.path.open_tip(copies);
        }
        self.path.follow(moves);
    }

    /// Sets the pose and the tip after a step.
    ///
    /// `moved` is the tip along the blade, without the vertices that kept their places.
    pub(crate) fn finish_step(
        &mut self,
        pose: &[[f32; 3]],
        moved: Vec<TipPoint>,
        sweep: Option<Sweep>,
        step: &Step<'_>,
    ) {
        let Approach {
            tip: last,
            stands,
            leaves,
            closing,
            starts_inside,
            ..
        } = step.approach;
        // Where a blade has cut through, vertices that stand are beyond its ends, and no longer of
        // its tip.
        let tip = if *leaves && moved.is_empty() {
            moved
        } else {
            with_standing(moved, last, stands)
        };
        let ends = |tip: &[TipPoint]| match tip {
            [first, .., last] => [first.parameter, last.parameter],
            [only] => [only.parameter; 2],
            #[expect(clippy::cast_precision_loss, reason = "few points")]
            [] => [0.0, (pose.len() - 1) as f64],
        };
        if self.tip.is_empty() {
            if self.back.is_none() || self.path.ends_inside() {
                self.path.clear();
                self.start_tip.clone_from(&step.start);
            }
            self.path.enter(&self.pose, ends(&tip), *starts_inside);
            self.local = 0.0;
        }
        // Edges beside the tip are short, because the last step split them.
        self.local = step.local.max(self.local * MIN_LOCAL_RATIO);
        self.store_pose(pose);
        self.back = None;
        self.refused.clear();
        self.refused_steps = 0;
        for (k, border) in self.borders.iter_mut().enumerate() {
            let end = if k == 0 { tip.first() } else { tip.last() };
            extend_border(border, &step.borders[k], end);
        }
        if tip.is_empty() {
            self.store_blade(pose);
            self.state = IncisionState::Finished;
            if closing.is_some() {
                self.start_tip.clear();
                self.back = Some(0.0);
            } else {
                self.path.leave(pose, ends(last));
            }
        } else {
            self.state = if *leaves {
                self.back = Some(0.0);
                IncisionState::Abandoned
            } else {
                IncisionState::Inside
            };
            self.path.push([0, tip.len() - 1].map(|i| tip[i].vertex));
        }
        self.tip = tip;
        self.sweep = sweep;
    }

    /// Stores the rest positions of the tip, by which it is recognized.
    ///
    /// Call it after a step that cut, if a solver sets the rest positions of new vertices, as it
    /// does for a body with a lattice. Otherwise the tip is lost, and the next step starts a new
    /// cut. Vertices that the surface does not have end the incision at its next step.
    pub fn follow_rest(&mut self, surface: &Surface) {
        for point in self.tip.iter_mut().chain(&mut self.start_tip) {
            if point.vertex.index() < surface.topology().vertex_slots() {
                point.rest = surface.rest_position(point.vertex);
            }
        }
    }

    /// Removes the parts of the tip that other cuts have removed.
    fn check_tip(&mut self, surface: &Surface) {
        remove_cut(&mut self.tip, surface);
        let count = self.start_tip.len();
        remove_cut(&mut self.start_tip, surface);
        if self.start_tip.len() < count {
            self.start_tip.clear();
        }
    }

    /// Continues from the other tip of a slit that began in the body.
    fn swap_tips(&mut self) {
        let ends = |tip: &[TipPoint]| [0, tip.len() - 1].map(|i| tip[i].vertex);
        self.path.reverse(ends(&self.start_tip));
        std::mem::swap(&mut self.tip, &mut self.start_tip);
        self.borders = Default::default();
        self.back = None;
    }
}

/// Returns the length by which motion near edges of some length is measured \[m\].
pub(crate) fn motion_scale(surface: &Surface, edges: f64) -> f64 {
    edges.min(MAX_LOCAL * surface.bounds().diagonal())
}
