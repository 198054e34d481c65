//! Points along a chain, spaced by the target lengths at its ends.

/// Points along a segment at distances that grow from both ends.
#[derive(Debug, Clone, Copy)]
pub(super) struct Spacing {
    /// Target lengths at the ends, relative to the segment.
    ends: [f64; 2],
    grading: f64,
    /// Length of the segment \[m\].
    distance: f64,
    /// Place at which the lengths from both ends are equal.
    middle: f64,
    /// Number of parts.
    pub(super) count: u32,
}

/// Maximum number of parts of a chain.
const MAX_PARTS: f64 = 65536.0;

impl Spacing {
    pub(super) fn new(lengths: [f64; 2], grading: f64, distance: f64, min_count: u32) -> Self {
        // The ends may have the same position.
        let distance = if distance > 0.0 { distance } else { lengths[0] };
        let ends = lengths.map(|l| (l / distance).max(1.0 / MAX_PARTS));
        let [a, b] = ends;
        // Without grading, lengths change linearly from end to end.
        let grading = grading.max((b - a).abs()).max(1e-6);
        let mut spacing = Self {
            ends,
            grading,
            distance,
            middle: ((b - a + grading) / (2.0 * grading)).clamp(0.0, 1.0),
            count: min_count,
        };
        let parts = spacing.parts_before(1.0).round();
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "at least 1 and at most MAX_PARTS"
        )]
        if parts > f64::from(min_count) {
            spacing.count = parts.min(MAX_PARTS) as u32;
        }
        spacing
    }

    /// Returns the target length at a parameter \[m\].
    pub(super) fn length(&self, parameter: f64) -> f64 {
        let [a, b] = self.ends;
        let relative = (a + self.grading * parameter).min(b + self.grading * (1.0 - parameter));
        relative * self.distance
    }

    /// Returns the integral of 1 / length from the start to a parameter.
    fn parts_before(&self, parameter: f64) -> f64 {
        let [a, b] = self.ends;
        let g = self.grading;
        let rising = (1.0 + g * parameter.min(self.middle) / a).ln() / g;
        if parameter <= self.middle {
            return rising;
        }
        let high = b + g * (1.0 - self.middle);
        rising + (high / (b + g * (1.0 - parameter))).ln() / g
    }

    /// Returns the parameter of point `k`.
    pub(super) fn parameter(&self, k: u32) -> f64 {
        let [a, b] = self.ends;
        let g = self.grading;
        let target = self.parts_before(1.0) * f64::from(k) / f64::from(self.count);
        let rising = self.parts_before(self.middle);
        if target <= rising {
            return a * (g * target).exp_m1() / g;
        }
        let high = b + g * (1.0 - self.middle);
        1.0 + b / g - high * (-g * (target - rising)).exp() / g
    }
}
