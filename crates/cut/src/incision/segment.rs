//! [`Segment`]: a step of the way of a blade through a body.

use super::line::{offset, part_along};
use incise_mesh::Vec3;

/// A step of the way.
#[derive(Debug, Clone, Copy)]
pub(super) struct Segment {
    /// Distance from its end to that of the way, and its length \[m\].
    pub(super) behind: f64,
    pub(super) length: f64,
    /// The stations before and after it, each end with its distance from the walls \[m\].
    pub(super) from: [(Vec3, f64); 2],
    pub(super) to: [(Vec3, f64); 2],
    /// Whether the way begins, and ends, with it outside of the body.
    pub(super) enters: bool,
    pub(super) leaves: bool,
    /// Whether the blade was outside of the body in it, so that nothing is cut.
    pub(super) is_gap: bool,
}

impl Segment {
    /// Returns whether a blade is on it, up to `widths` at the ends of the tip \[m\].
    ///
    /// The way `goes_on` straight beyond its ends outside of the body, or it does not.
    pub(super) fn has(&self, blade: &[[f32; 3]], widths: [f64; 2], goes_on: bool) -> bool {
        // The distances of the blade from the tip's ends change linearly along the way.
        let both = [self.from, self.to];
        let offsets = both.map(|ends| ends.map(|end| offset(blade, end.0)));
        let goes_on = |is_outside: bool| {
            if goes_on && is_outside {
                f64::INFINITY
            } else {
                0.0
            }
        };
        let (earliest, latest) = (-goes_on(self.enters), 1.0 + goes_on(self.leaves));
        let widths = both.map(|ends| [0, 1].map(|k| widths[k] + ends[k].1));
        come_within(offsets, [earliest, latest], widths)
    }

    /// Returns the part of it, by end of the tip, at which a blade is nearest.
    pub(super) fn parts(&self, blade: &[[f32; 3]]) -> [f64; 2] {
        [0, 1].map(|k| {
            let [from, to] = [self.from, self.to].map(|ends| offset(blade, ends[k].0));
            part_along(to - from, -from).unwrap_or(1.0)
        })
    }

    /// Returns the way of an end of the tip.
    pub(super) fn way(&self, k: usize) -> Vec3 {
        self.to[k].0 - self.from[k].0
    }

    /// Returns whether an end of the tip crosses another step, seen along the tip.
    pub(super) fn crosses(&self, other: &Self, k: usize) -> bool {
        let along = self.to[1].0 - self.to[0].0;
        let side = |[a, b]: [Vec3; 2], c: Vec3| along.dot(&(b - a).cross(&(c - a))) < 0.0;
        let [own, other] = [self, other].map(|step| [step.from[k].0, step.to[k].0]);
        let parts = |line: [Vec3; 2], [a, b]: [Vec3; 2]| side(line, a) != side(line, b);
        parts(own, other) && parts(other, own)
    }
}

/// Returns the distance of two stations across the blade \[m\].
///
/// Where the body is wider or has another part, their ends are elsewhere along the blade.
pub(super) fn length(from: [Vec3; 2], to: [Vec3; 2]) -> f64 {
    let distance = |[a, b]: [Vec3; 2], p: Vec3| {
        let part = part_along(b - a, p - a).unwrap_or_default();
        (a + (b - a) * part - p).norm()
    };
    let across = |k: usize| distance(from, to[k]).min(distance(to, from[k]));
    across(0).max(across(1))
}

/// Returns the height of an arc above its chord \[m\], given its turn from end to end [rad].
///
/// Up to second order in the turn.
pub(super) fn arc_height(chord: f64, turn: f64) -> f64 {
    chord * turn / 8.0
}

/// Returns the height of the arc above each end's way in step `i` \[m\].
///
/// The arc turns in a step as the way does from step to step: of both neighbors the lesser turn,
/// since a corner of the way is no arc.
pub(super) fn arc_heights(segments: &[Segment], i: usize) -> [f64; 2] {
    let beside = [i.checked_sub(1), Some(i + 1)].map(|i| segments.get(i?));
    [0, 1].map(|k| {
        let way = segments[i].way(k);
        let turns = beside.map(|other| other.map_or(0.0, |other| other.way(k).angle(&way)));
        arc_height(way.norm(), turns[0].min(turns[1]))
    })
}

/// Returns whether two vectors that change linearly each become as short as `widths`, which change
/// with them from 0 to 1, at a time in a range.
///
/// Their times may differ: the ends of a blade that turned are level with other parts of the way.
pub(super) fn come_within(
    [from, to]: [[Vec3; 2]; 2],
    [earliest, latest]: [f64; 2],
    [first, last]: [[f64; 2]; 2],
) -> bool {
    (0..2).all(|k| {
        let change = to[k] - from[k];
        let part = part_along(change, -from[k]).map_or(1.0, |part| part.clamp(earliest, latest));
        let width = first[k] + (last[k] - first[k]) * part.clamp(0.0, 1.0);
        (from[k] + change * part).norm() <= width
    })
}
