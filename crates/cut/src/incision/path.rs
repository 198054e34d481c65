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
        let reach = 2.0 * (motion + width);
        // A segment counts from the place of its end on, so the one before may begin far ahead.
        let mut previous = 0.0;
        let mut found = None;
        for segment in self.segments(surface) {
            if segment.behind > back + reach + previous {
                break;
            }
            let is_near = back.is_infinite() || segment.behind + segment.length >= back - reach;
            if is_near && segment.has(blade, [width; 2]) {
                found = Some(segment.behind);
                if back.is_finite() {
                    break;
                }
            }
            previous = segment.length;
        }
        found
    }

    /// Returns the way of an end of the tip in the last step \[m\].
    pub(super) fn last_way(&self, surface: &Surface, k: usize) -> Option<Vec3> {
        self.segments(surface).next().map(|segment| segment.way(k))
    }

    /// Returns how far behind the tip the last of some lines is, if the last step has crossed the
    /// way before it and each line is there \[m\].
    ///
    /// Lines are there up to `width` \[m\], the distance of the walls, and the height of the arc
    /// on which the blade has moved above its step.
    pub(super) fn find_again(
        &self,
        surface: &Surface,
        lines: &[Vec<[f32; 3]>],
        width: f64,
    ) -> Option<f64> {
        let segments: Vec<Segment> = self.segments(surface).collect();
        let [last, _, before @ ..] = &segments[..] else {
            return None;
        };
        let has_crossed = |k: usize| before.iter().any(|segment| last.crosses(segment, k));
        if !(0..2).all(has_crossed) {
            return None;
        }
        let find = |line: &Vec<[f32; 3]>| {
            let is_there = |&i: &usize| {
                let heights = arc_heights(&segments, i).map(|height| width + height);
                segments[i].has(line, heights)
            };
            (1..segments.len()).find(is_there)
        };
        let places = lines.iter().map(find).collect::<Option<Vec<usize>>>()?;
        places.last().map(|&i| segments[i].behind)
    }

    /// Iterates over the steps of the way, from the tip to the start.
    fn segments<'a>(&'a self, surface: &'a Surface) -> impl Iterator<Item = Segment> + 'a {
        let slots = surface.topology().vertex_slots();
        let is_known = move |tip: &[PathPoint; 2]| {
            let mut used = tip
                .iter()
                .flat_map(|end| end.sides)
                .flat_map(|side| side.ends);
            used.all(|v| v.index() < slots)
        };
        let middles = |tip: [PathPoint; 2]| tip.map(|end| end.middle(surface));
        let mut behind = 0.0;
        let steps = self.tips.iter().enumerate().rev();
        steps.map_while(move |(i, tip)| {
            let before = i.checked_sub(1).map(|i| self.tips[i]);
            if !is_known(tip) || before.is_some_and(|before| !is_known(&before)) {
                return None;
            }
            let to = middles(*tip);
            let from = before.map_or_else(
                || tip.map(|end| (point_at(&self.entry, end.parameter), 0.0)),
                middles,
            );
            let length = (0..2).fold(0.0, |m, k| (to[k].0 - from[k].0).norm().max(m));
            let segment = Segment {
                behind,
                length,
                from,
                to,
                is_first: before.is_none(),
            };
            behind += length;
            Some(segment)
        })
    }
}

/// A step of the way.
#[derive(Debug, Clone, Copy)]
struct Segment {
    /// Distance from its end to the tip, and its length \[m\].
    behind: f64,
    length: f64,
    /// The ends of the tip before and after it, each with its distance from the walls \[m\].
    from: [(Vec3, f64); 2],
    to: [(Vec3, f64); 2],
    /// Whether the way begins with it.
    is_first: bool,
}

impl Segment {
    /// Returns whether a blade is on it, or behind the start of the way, up to `widths` at the ends
    /// of the tip \[m\].
    fn has(&self, blade: &[[f32; 3]], widths: [f64; 2]) -> bool {
        // The distances of the blade from the tip's ends change linearly along the way.
        let both = [self.from, self.to];
        let [first, last] = both.map(|ends| ends.map(|end| offset(blade, end.0)));
        let earliest = if self.is_first {
            f64::NEG_INFINITY
        } else {
            0.0
        };
        let widths = both.map(|ends| [0, 1].map(|k| widths[k] + ends[k].1));
        come_within(first, last, earliest, widths)
    }

    /// Returns the way of an end of the tip.
    fn way(&self, k: usize) -> Vec3 {
        self.to[k].0 - self.from[k].0
    }

    /// Returns whether an end of the tip crosses another step, seen along the tip.
    fn crosses(&self, other: &Self, k: usize) -> bool {
        let along = self.to[1].0 - self.to[0].0;
        let side = |[a, b]: [Vec3; 2], c: Vec3| along.dot(&(b - a).cross(&(c - a))) < 0.0;
        let [own, other] = [self, other].map(|step| [step.from[k].0, step.to[k].0]);
        let parts = |line: [Vec3; 2], [a, b]: [Vec3; 2]| side(line, a) != side(line, b);
        parts(own, other) && parts(other, own)
    }
}

/// Returns the height of the arc above each end's way in step `i` \[m\].
///
/// The arc turns in a step as the way does from step to step: of both neighbors the lesser turn,
/// since a corner of the way is no arc. An arc that turns by `t` is `t / 8` of its chord high.
fn arc_heights(segments: &[Segment], i: usize) -> [f64; 2] {
    let beside = [i.checked_sub(1), Some(i + 1)].map(|i| segments.get(i?));
    [0, 1].map(|k| {
        let way = segments[i].way(k);
        let turns = beside.map(|other| other.map_or(0.0, |other| other.way(k).angle(&way)));
        way.norm() * turns[0].min(turns[1]) / 8.0
    })
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
