//! [`Segment`]: a step of the path of a blade through a body.

use super::line::{offset, part_along};
use incise_mesh::Vec3;

/// A step of the path.
#[derive(Debug, Clone, Copy)]
pub(super) struct Segment {
    /// Distance from its end to that of the path, and its length \[m\].
    pub(super) behind: f64,
    pub(super) length: f64,
    /// The stations before and after it, each end with its distance from the walls \[m\].
    pub(super) from: [(Vec3, f64); 2],
    pub(super) to: [(Vec3, f64); 2],
    /// Whether the path begins, and ends, with it outside of the body.
    pub(super) enters: bool,
    pub(super) leaves: bool,
    /// Whether the blade was outside of the body in it, so that nothing is cut.
    pub(super) is_gap: bool,
}

impl Segment {
    /// Returns whether a blade is on it, up to `widths` at the ends of the tip \[m\].
    ///
    /// `extends` is whether the path continues straight beyond its ends outside of the body.
    pub(super) fn has(&self, blade: &[[f32; 3]], widths: [f64; 2], extends: bool) -> bool {
        // The distances of the blade from the tip's ends change linearly along the path.
        let both = [self.from, self.to];
        let offsets = both.map(|ends| ends.map(|end| offset(blade, end.0)));
        let beyond = |is_outside: bool| match extends && is_outside {
            true => f64::INFINITY,
            false => 0.0,
        };
        let (earliest, latest) = (-beyond(self.enters), 1.0 + beyond(self.leaves));
        let widths = both.map(|ends| [0, 1].map(|k| widths[k] + ends[k].1));
        come_within(offsets, [earliest, latest], widths)
    }

    /// Returns, for each end of the tip, the fraction of the step at which a blade is nearest.
    pub(super) fn parts(&self, blade: &[[f32; 3]]) -> [f64; 2] {
        [0, 1].map(|k| {
            let [from, to] = [self.from, self.to].map(|ends| offset(blade, ends[k].0));
            part_along(to - from, -from).unwrap_or(1.0)
        })
    }

    /// Returns the displacement of an end of the tip.
    pub(super) fn displacement(&self, k: usize) -> Vec3 {
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

/// Returns the sagitta of an arc \[m\], given its chord \[m\] and its angle [rad].
///
/// Up to second order in the angle.
pub(super) fn sagitta(chord: f64, turn: f64) -> f64 {
    chord * turn / 8.0
}

/// Returns the sagitta of the arc of each end of the tip in step `i` \[m\].
///
/// The arc turns in a step as the path does from step to step: of both neighbors the lesser turn,
/// since a corner of the path is no arc.
pub(super) fn sagittas(segments: &[Segment], i: usize) -> [f64; 2] {
    let beside = [i.checked_sub(1), Some(i + 1)].map(|i| segments.get(i?));
    [0, 1].map(|k| {
        let way = segments[i].displacement(k);
        let turns =
            beside.map(|other| other.map_or(0.0, |other| other.displacement(k).angle(&way)));
        sagitta(way.norm(), turns[0].min(turns[1]))
    })
}

/// Returns whether both of two vectors that change linearly become as short as their widths.
///
/// Vectors and widths are interpolated from 0 to 1, in a range of times. The two times may differ,
/// since the ends of a blade that turned are level with other parts of the path.
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
