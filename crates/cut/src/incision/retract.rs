//! Blades that move back along their path, where nothing is left to cut.

use super::line::{offset, point_at};
use super::path::{PathRange, PathSearch};
use super::segment::come_within;
use super::{Incision, IncisionState, PATH_WIDTH, TipPoint};
use crate::exact::MAX_OFFSET;
use incise_mesh::Surface;
use incise_mesh::geometry::{to_f32, to_f64};

impl Incision {
    /// Returns where a blade is on its path, see [`Path::find`].
    fn find(&self, surface: &Surface, blade: &[[f32; 3]], range: PathRange) -> Option<f64> {
        let moved = self.pose.iter().zip(blade);
        let moved = moved.map(|(&p, &q)| (to_f64(q) - to_f64(p)).norm());
        let search = PathSearch {
            blade,
            motion: moved.fold(0.0, f64::max),
            width: PATH_WIDTH * self.local,
            range,
        };
        self.path.find(surface, &search)
    }

    /// Retracts a blade along its path, behind the tip. Returns whether it is there.
    pub(super) fn try_retract(
        &mut self,
        surface: &Surface,
        blade: &[[f32; 3]],
        is_outside: bool,
    ) -> bool {
        let range = PathRange {
            behind: self.back.unwrap_or(0.0),
            has_gaps: true,
            extends: is_outside,
        };
        let found = self.find(surface, blade, range);
        self.back = found.or(self.back);
        found.is_some()
    }

    /// Continues from the other tip of a slit, if the blade has moved back beyond it.
    ///
    /// Returns whether it does. The slit must have begun in the body.
    pub(super) fn try_swap_tips(&mut self, surface: &Surface, blade: &[[f32; 3]]) -> bool {
        let width = PATH_WIDTH * self.local;
        let turns = self.back.is_some()
            && !self.start_tip.is_empty()
            && self.path.is_before(surface, blade, width);
        if turns {
            self.swap_tips();
        }
        turns
    }

    /// Moves a blade without a tip along its last path, where nothing is left to cut.
    ///
    /// Returns whether it stays there.
    pub(super) fn try_retrace(
        &mut self,
        surface: &Surface,
        blade: &[[f32; 3]],
        is_outside: bool,
    ) -> bool {
        let anywhere = PathRange {
            behind: f64::INFINITY,
            has_gaps: true,
            extends: true,
        };
        let before = self.back;
        let before = before.or_else(|| self.find(surface, &self.pose, anywhere));
        let Some(behind) = before else {
            return false;
        };
        let cut = PathRange {
            behind,
            has_gaps: is_outside,
            extends: false,
        };
        let mut found = self.find(surface, blade, cut);
        if is_outside || self.path.ends_inside() {
            // The path of a cut that is closed goes on at its start.
            let from_start = PathRange {
                behind: f64::INFINITY,
                ..cut
            };
            found = found.or_else(|| self.find(surface, blade, from_start));
        }
        let [was_early, is_early] =
            [&self.pose, blade].map(|pose| self.path.is_nearer_start(surface, pose));
        let leaves = is_outside && (self.back.is_some() || was_early != is_early);
        let near = PathRange { behind, ..anywhere };
        if found.is_none() && leaves && self.find(surface, blade, near).is_some() {
            self.move_without_cut(blade);
            return true;
        }
        self.back = found.or(before);
        if found.is_some() {
            if is_outside && self.pose != blade {
                self.state = IncisionState::Outside;
            }
            self.store_pose(blade);
        }
        found.is_some()
    }

    /// Ends the cut if its tip has crossed the path and the next sweep stays on the path.
    ///
    /// Returns whether it does. `tip` has parameters of the new pose.
    pub(super) fn finish_at_crossing(
        &mut self,
        surface: &Surface,
        tip: &[TipPoint],
        blade: &[[f32; 3]],
    ) -> bool {
        if tip.len() < 2 {
            return false;
        }
        // The offset of a line between two poses is at most that of both and of their middle, up
        // to second order in the turn.
        let lines = [0.0, 0.5, 1.0].map(|part| {
            let points = tip.iter().map(|point| {
                let place = surface.position(point.vertex);
                to_f32(place + (point_at(blade, point.parameter) - place) * part)
            });
            points.collect()
        });
        let width = MAX_OFFSET * self.local;
        let Some(back) = self.path.find_recrossing(surface, &lines, width) else {
            return false;
        };
        self.leave_tip();
        self.store_pose(blade);
        self.store_blade(blade);
        self.state = IncisionState::Finished;
        self.back = Some(back);
        true
    }

    /// Returns whether the blade passes the tip in its motion to a new pose, up to `width` \[m\].
    pub(super) fn passes_tip(&self, surface: &Surface, blade: &[[f32; 3]], width: f64) -> bool {
        let ends = [self.tip[0], self.tip[self.tip.len() - 1]];
        let off = |pose: &[[f32; 3]]| ends.map(|end| offset(pose, surface.position(end.vertex)));
        come_within([off(&self.pose), off(blade)], [0.0, 1.0], [[width; 2]; 2])
    }
}
