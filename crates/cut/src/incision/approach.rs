//! [`Approach`]: whether and how a motion of the blade goes on from the tip.

use super::closing::Closing;
use super::lead::{
    MIN_MOTION, has_cut_through, has_moved, is_ahead, is_at_tip, release_isolated, standing,
};
use super::line::{offset, point_at};
use super::map::{BladeMap, is_at_rest};
use super::piercings::{Piercing, ends_in_body, is_pierced, piercings};
use super::{Incision, IncisionState, PATH_WIDTH, TipPoint, motion_scale};
use crate::blade_position::is_in_body;
use crate::error::CutError;
use crate::search::Search;
use incise_mesh::geometry::{to_f32, to_f64};
use incise_mesh::{Aabb, Surface, TriangleId, Vec3};

/// How a blade goes on from a tip in one step.
#[derive(Debug, Default)]
pub(crate) struct Approach {
    pub(crate) map: BladeMap,
    /// The tip, with parameters of the new pose.
    pub(super) tip: Vec<TipPoint>,
    /// By vertex of the tip, whether it keeps its place, and the unit vector ahead.
    pub(super) stands: Vec<bool>,
    pub(super) ahead: Vec<Vec3>,
    /// By vertex, the displacement of its next place from the blade \[m\].
    pub(super) offsets: Vec<Vec3>,
    /// Whether the blade is outside of the body, so that its front must be.
    pub(super) leaves: bool,
    /// Whether a blade without a tip is in the body at its last pose.
    pub(super) starts_inside: bool,
    /// How the step closes the cut, if it does.
    pub(super) closing: Option<Closing>,
    /// The next places of the tip's vertices \[m\].
    targets: Vec<Vec3>,
}

impl Incision {
    /// Returns how a motion to a new pose cuts, or none if it cuts nothing.
    ///
    /// `sheets` are the pieces without an inside. Nothing is cut by
    /// - the first pose,
    /// - a motion that is too short, or along the blade's edge alone,
    /// - a motion back along the path, or out of the body beside it,
    /// - a repetition of the step that was just refused,
    /// - a blade that meets nothing but folds of the skin.
    ///
    /// # Errors
    /// [`CutError::PolylineLength`] and [`CutError::SweepNotFinite`].
    pub(crate) fn begin_step(
        &mut self,
        surface: &Surface,
        blade: &[[f32; 3]],
        search: &mut Search<'_>,
        sheets: &[bool],
    ) -> Result<Option<Approach>, CutError> {
        check_blade(blade)?;
        if self.pose.len() != blade.len() {
            self.restart(blade);
            return Ok(None);
        }
        self.check_tip(surface);
        if !self.is_inside() && !self.try_swap_tips(surface, blade) {
            return Ok(self.begin_entry(surface, blade, search, sheets));
        }
        let line: Vec<Vec3> = blade.iter().map(|&p| to_f64(p)).collect();
        let near = search.along(surface, &line);
        let piercings = piercings(blade, surface, &near);
        let starts_inside = starts_inside(surface, blade, &piercings, sheets);
        let is_outside = piercings.is_empty() && !starts_inside;
        let map = if is_at_rest(surface) {
            BladeMap::default()
        } else {
            let ends = ends_in_body(surface, &piercings, sheets, starts_inside);
            if ends.is_empty() && !piercings.is_empty() {
                return Ok(None);
            }
            BladeMap::new(surface, &self.tip, &ends, self.local)
        };
        let (tip, leads) = self.leads(surface, &map, blade, &piercings);
        let is_ahead = is_ahead(&leads);
        let closing = self.closing(surface, &map, &leads, blade);
        if !has_moved(&leads) && !is_outside && closing.is_none() {
            if self.state != IncisionState::Abandoned {
                return Ok(None);
            }
            // The blade was put in again.
            if is_at_tip(&leads) {
                self.place_at_tip(surface, blade);
                self.state = IncisionState::Inside;
                self.back = None;
                return Ok(None);
            }
        }
        if is_ahead && closing.is_none() && self.finish_at_crossing(surface, &tip, blade) {
            return Ok(None);
        }
        let is_ahead = is_ahead || closing.is_some();
        if !is_ahead && self.try_swap_tips(surface, blade) {
            return self.begin_step(surface, blade, search, sheets);
        }
        if !is_ahead && self.try_retract(surface, blade, is_outside) {
            self.store_pose(blade);
            self.state = if is_outside {
                IncisionState::Abandoned
            } else {
                IncisionState::Inside
            };
            return Ok(None);
        }
        let was_off = self.state == IncisionState::Abandoned && self.back.is_none();
        if is_outside && (was_off || !has_cut_through(&leads)) {
            self.store_pose(blade);
            self.back = None;
            self.state = IncisionState::Abandoned;
            return Ok(None);
        }
        let width = PATH_WIDTH * self.local;
        let is_off = self.back.is_some() && !is_ahead && !self.passes_tip(surface, blade, width);
        if was_off || is_off {
            self.leave();
            return Ok(Some(Approach::default()));
        }
        if self.state == IncisionState::Abandoned {
            self.place_at_tip(surface, blade);
        }
        let targets: Vec<Vec3> = leads.iter().map(|lead| lead.target).collect();
        if self.is_refused_at(&targets) {
            return Ok(None);
        }
        let mut stands = match closing {
            Some(_) => vec![false; leads.len()],
            None => standing(&leads, is_outside),
        };
        Ok(Some(Approach {
            offsets: release_isolated(&leads, &tip, &mut stands, self.local),
            tip,
            stands,
            ahead: leads.iter().map(|lead| lead.ahead).collect(),
            leaves: is_outside,
            starts_inside: false,
            closing,
            map,
            targets,
        }))
    }

    /// Returns how the motion of a blade without a tip cuts, or none if it does not.
    fn begin_entry(
        &mut self,
        surface: &Surface,
        blade: &[[f32; 3]],
        search: &mut Search<'_>,
        sheets: &[bool],
    ) -> Option<Approach> {
        self.store_blade(blade);
        let near = search.in_box(surface, &Aabb::around(blade.iter().copied()));
        let piercings = piercings(blade, surface, &near);
        let is_outside = || piercings.is_empty() && !is_in_body(surface, sheets, blade[0]);
        if !self.path.is_empty() && self.try_retrace(surface, blade, is_outside()) {
            return None;
        }
        if self.try_slide_pose(surface, blade, &near) {
            return None;
        }
        if piercings.is_empty() || is_at_rest(surface) {
            return Some(Approach {
                leaves: self.state == IncisionState::Blocked && is_outside(),
                starts_inside: self.pierces(surface, search),
                ..Approach::default()
            });
        }
        let starts_inside = starts_inside(surface, blade, &piercings, sheets);
        let ends = ends_in_body(surface, &piercings, sheets, starts_inside);
        (!ends.is_empty()).then(|| Approach {
            map: BladeMap::of_entry(surface, blade, &ends, &self.bends(blade), self.local),
            starts_inside: self.pierces(surface, search),
            ..Approach::default()
        })
    }

    /// Slides the last pose along with a blade that moves along its edge. Returns whether it does.
    ///
    /// For blades without a tip that move across by less than [`MIN_MOTION`] near the surface. A
    /// stab has no width: it cuts from where it went in, once the blade moves across.
    fn try_slide_pose(
        &mut self,
        surface: &Surface,
        blade: &[[f32; 3]],
        near: &[TriangleId],
    ) -> bool {
        if near.is_empty() {
            return false;
        }
        let edges = surface.mean_edge_length_of(near.iter().copied());
        self.local = motion_scale(surface, edges);
        let width = MIN_MOTION * self.local;
        let offsets = blade.iter().map(|&p| offset(&self.pose, to_f64(p)));
        let offsets: Vec<Vec3> = offsets.collect();
        if offsets.iter().any(|off| off.norm() >= width) {
            return false;
        }
        for ((place, &p), off) in self.pose.iter_mut().zip(blade).zip(offsets) {
            *place = to_f32(to_f64(p) + off);
        }
        true
    }

    /// Returns whether the last pose pierces the surface.
    fn pierces(&self, surface: &Surface, search: &mut Search<'_>) -> bool {
        let line: Vec<Vec3> = self.pose.iter().map(|&p| to_f64(p)).collect();
        let near = search.along(surface, &line);
        is_pierced(&line, surface, &near)
    }

    /// Moves the last pose of a blade that was elsewhere to the tip, from where it goes on.
    ///
    /// The blade is displaced so that the same points of its edge are at the tip as before. A blade
    /// that is put in again has another part of its edge there.
    fn place_at_tip(&mut self, surface: &Surface, blade: &[[f32; 3]]) {
        let [first, last] = [self.tip[0], self.tip[self.tip.len() - 1]];
        let to_tip = |end: TipPoint| surface.position(end.vertex) - point_at(blade, end.parameter);
        let [from, to] = [first, last].map(to_tip);
        self.store_pose(blade);
        for (i, place) in (0u32..).zip(&mut self.pose) {
            let part = (f64::from(i) - first.parameter) / (last.parameter - first.parameter);
            let part = if part.is_nan() {
                0.5
            } else {
                part.clamp(0.0, 1.0)
            };
            *place = to_f32(to_f64(*place) + from.lerp(&to, part));
        }
    }

    /// Returns whether the last step to these positions \[m\] of the tip was refused.
    fn is_refused_at(&self, targets: &[Vec3]) -> bool {
        let is_near = |(a, b): (&Vec3, &Vec3)| (a - b).norm() < MIN_MOTION * self.local;
        self.refused.len() == targets.len()
            && !targets.is_empty()
            && self.refused.iter().zip(targets).all(is_near)
    }

    /// Stores a refused step to a pose, or restarts there a blade without a tip that has left.
    pub(crate) fn refuse(&mut self, approach: Approach, blade: &[[f32; 3]]) {
        if approach.leaves && !self.is_inside() {
            self.restart(blade);
            return;
        }
        self.refused = approach.targets;
        self.refused_steps += 1;
        self.state = IncisionState::Blocked;
    }
}

/// Returns whether a blade begins in the body. O(n) unless it pierces the surface and goes in there
/// first.
fn starts_inside(
    surface: &Surface,
    blade: &[[f32; 3]],
    piercings: &[Piercing],
    sheets: &[bool],
) -> bool {
    let goes_in = piercings.first().is_some_and(|first| first.enters);
    !goes_in && is_in_body(surface, sheets, blade[0])
}

/// Checks the points of a blade.
fn check_blade(blade: &[[f32; 3]]) -> Result<(), CutError> {
    if blade.len() < 2 {
        let [previous, current] = [blade.len(); 2];
        return Err(CutError::PolylineLength { previous, current });
    }
    match (blade.iter()).position(|p| !p.iter().all(|x| x.is_finite())) {
        Some(corner) => Err(CutError::SweepNotFinite { corner }),
        None => Ok(()),
    }
}
