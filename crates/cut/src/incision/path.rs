//! The way of a blade through a body, in which it may move back without a cut.

use super::TipPoint;
use super::line::{offset, part_along, point_at};
use crate::exact::RimMove;
use incise_mesh::{Surface, Vec3, VertexId};

/// The way of a blade since it entered the body: the pose before, then the ends of each tip.
#[derive(Debug, Clone, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Path {
    pub(super) entry: Vec<[f32; 3]>,
    pub(super) tips: Vec<[PathPoint; 2]>,
}

/// An end of a tip, once the blade has moved on: a point on each side of the slit.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct PathPoint {
    sides: [RimPoint; 2],
    /// See [`TipPoint::parameter`].
    parameter: f64,
}

/// A point of a rim, between two of its vertices.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct RimPoint {
    ends: [VertexId; 2],
    /// Part of the way from the first to the second one.
    part: f32,
}

impl RimPoint {
    fn at(vertex: VertexId) -> Self {
        Self {
            ends: [vertex; 2],
            part: 0.0,
        }
    }

    fn position(&self, surface: &Surface) -> Vec3 {
        let [a, b] = self.ends.map(|v| surface.position(v));
        a + (b - a) * f64::from(self.part)
    }

    /// Keeps its place where one of its vertices moves along the rim.
    fn follow(&mut self, moved: &RimMove) {
        let Some(k) = self.ends.iter().position(|&v| v == moved.gone) else {
            return;
        };
        let end = self.ends[1 - k];
        let from_gone = if k == 0 { self.part } else { 1.0 - self.part };
        let part = if end == moved.kept {
            moved.part * (1.0 - from_gone)
        } else if end == moved.other {
            moved.part + from_gone * (1.0 - moved.part)
        } else {
            moved.part
        };
        *self = Self {
            ends: [moved.kept, moved.other],
            part,
        };
    }
}

impl PathPoint {
    /// Returns the middle between both sides, and its distance from them \[m\].
    fn middle(&self, surface: &Surface) -> (Vec3, f64) {
        let [a, b] = self.sides.map(|point| point.position(surface));
        ((a + b) / 2.0, (b - a).norm() / 2.0)
    }
}

fn open(tips: &mut [[PathPoint; 2]], copies: impl Fn(VertexId) -> Option<[VertexId; 2]>) {
    for end in tips
        .iter_mut()
        .flatten()
        .filter(|end| end.sides[0] == end.sides[1])
    {
        if let Some(own) = copies(end.sides[0].ends[0]) {
            end.sides = own.map(RimPoint::at);
        }
    }
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
        let ends = [tip[0], tip[tip.len() - 1]];
        self.push_ends(ends.map(|end| (end.vertex, end.parameter)));
    }

    /// Adds the ends of a tip, each with its parameter.
    pub(super) fn push_ends(&mut self, ends: [(VertexId, f64); 2]) {
        self.tips.push(ends.map(|(vertex, parameter)| PathPoint {
            sides: [RimPoint::at(vertex); 2],
            parameter,
        }));
    }

    /// Replaces the ends of the last tip by the two vertices that a step has made of each.
    pub(super) fn open_tip(&mut self, copies: impl Fn(VertexId) -> Option<[VertexId; 2]>) {
        let last = self.tips.len().saturating_sub(1);
        open(&mut self.tips[last..], copies);
    }

    /// Replaces all ends by the two vertices that a step has made of each.
    pub(super) fn open(&mut self, copies: impl Fn(VertexId) -> Option<[VertexId; 2]>) {
        open(&mut self.tips, copies);
    }

    /// Keeps the ends of all tips in place where vertices of the slit's rim move along it.
    pub(super) fn follow(&mut self, moves: &[RimMove]) {
        for moved in moves {
            let ends = self.tips.iter_mut().flatten();
            let points = ends.flat_map(|end| &mut end.sides);
            points.for_each(|point| point.follow(moved));
        }
    }

    /// Returns how far behind the tip a blade is, if it is on the way or behind its start, up to
    /// `width` and the distance of the walls \[m\].
    ///
    /// The blade was `back` behind the tip and has moved by `motion` \[m\]. So it cannot be where
    /// the way crosses itself. If `back` is infinite, it is at the place nearest to the start.
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
        // A segment counts from the place of its end on, so the one before may begin far ahead.
        let (mut behind, mut previous) = (0.0, 0.0);
        let mut found = None;
        for (i, tip) in self.tips.iter().enumerate().rev() {
            let before = i.checked_sub(1).map(|i| self.tips[i]);
            let mut ends = tip.iter().chain(before.iter().flatten());
            let is_gone = ends.any(|end| {
                let mut used = end.sides.iter().flat_map(|point| point.ends);
                used.any(|v| v.index() >= slots)
            });
            if behind > back + reach + previous || is_gone {
                break;
            }
            let to = tip.map(|end| end.middle(surface));
            let from = match before {
                Some(before) => before.map(|end| end.middle(surface)),
                None => tip.map(|end| (point_at(&self.entry, end.parameter), 0.0)),
            };
            // The distances of the blade from the tip's ends change linearly along the way.
            let [first, last] = [from, to].map(|ends| ends.map(|end| offset(blade, end.0)));
            let earliest = if before.is_some() {
                0.0
            } else {
                f64::NEG_INFINITY
            };
            let length = (0..2).fold(0.0, |m, k| (to[k].0 - from[k].0).norm().max(m));
            let widths = [from, to].map(|ends| ends.map(|end| width + end.1));
            let is_near = back.is_infinite() || behind + length >= back - reach;
            if is_near && come_within(first, last, earliest, widths) {
                found = Some(behind);
                if back.is_finite() {
                    break;
                }
            }
            behind += length;
            previous = length;
        }
        found
    }
}

/// Returns whether two vectors that change linearly each become as short as `widths`, which change
/// with them, at a time from `earliest` to 1.
///
/// Their times may differ: the ends of a blade that turned are level with other parts of the way.
pub(super) fn come_within(
    from: [Vec3; 2],
    to: [Vec3; 2],
    earliest: f64,
    [first, last]: [[f64; 2]; 2],
) -> bool {
    (0..2).all(|k| {
        let change = to[k] - from[k];
        let part = part_along(change, -from[k]).map_or(1.0, |part| part.clamp(earliest, 1.0));
        let width = first[k] + (last[k] - first[k]) * part.max(0.0);
        (from[k] + change * part).norm() <= width
    })
}
