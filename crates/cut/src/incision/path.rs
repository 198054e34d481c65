//! The way of a blade through a body, in which it may move back without a cut.

use super::TipPoint;
use super::columns::point_at;
use incise_mesh::{Surface, Vec3};

/// The way of a blade since it entered the body: the pose before, then the ends of each tip.
#[derive(Debug, Clone, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Path {
    pub(super) entry: Vec<[f32; 3]>,
    pub(super) tips: Vec<[TipPoint; 2]>,
}

impl Path {
    pub(super) fn clear(&mut self) {
        self.entry.clear();
        self.tips.clear();
    }

    pub(super) fn start(&mut self, pose: &[[f32; 3]]) {
        self.clear();
        self.entry.extend_from_slice(pose);
    }

    pub(super) fn push(&mut self, tip: &[TipPoint]) {
        self.tips.push([tip[0], tip[tip.len() - 1]]);
    }

    /// Returns how far behind the tip a blade is, if it is on the way or behind its start, up to
    /// `width` \[m\].
    ///
    /// The blade was `back` behind the tip and has moved by `motion` \[m\]. So it cannot be where
    /// the way crosses itself.
    pub(super) fn find(
        &self,
        surface: &Surface,
        blade: &[[f32; 3]],
        back: f64,
        motion: f64,
        width: f64,
    ) -> Option<f64> {
        let slots = surface.topology().vertex_slots();
        let reach = 2.0 * (motion + width);
        let mut behind = 0.0;
        for (i, tip) in self.tips.iter().enumerate().rev() {
            let before = i.checked_sub(1).map(|i| self.tips[i]);
            let mut ends = tip.iter().chain(before.iter().flatten());
            if behind > back + reach || ends.any(|end| end.vertex.index() >= slots) {
                return None;
            }
            let to = tip.map(|end| surface.position(end.vertex));
            let (parameters, from) = match before {
                Some(before) => (
                    before.map(|end| end.parameter),
                    before.map(|end| surface.position(end.vertex)),
                ),
                None => (
                    tip.map(|end| end.parameter),
                    tip.map(|end| point_at(&self.entry, end.parameter)),
                ),
            };
            // The distances of the blade from the tip's ends change linearly along the way.
            let first = [0, 1].map(|k| point_at(blade, parameters[k]) - from[k]);
            let last = [0, 1].map(|k| point_at(blade, tip[k].parameter) - to[k]);
            let earliest = if before.is_some() {
                0.0
            } else {
                f64::NEG_INFINITY
            };
            let length = (0..2).fold(0.0, |m, k| (to[k] - from[k]).norm().max(m));
            if behind + length >= back - reach && do_vanish(first, last, earliest, width) {
                return Some(behind);
            }
            behind += length;
        }
        None
    }
}

/// Returns whether two vectors that change linearly are both at most as long as `width` at a time
/// from `earliest` to 1.
pub(super) fn do_vanish(from: [Vec3; 2], to: [Vec3; 2], earliest: f64, width: f64) -> bool {
    let change = [0, 1].map(|k| to[k] - from[k]);
    let along: f64 = (0..2).map(|k| change[k].dot(&from[k])).sum();
    let length: f64 = change.iter().map(Vec3::norm_squared).sum();
    let part = if length > 0.0 {
        (-along / length).clamp(earliest, 1.0)
    } else {
        1.0
    };
    (0..2).all(|k| (from[k] + change[k] * part).norm() <= width)
}
