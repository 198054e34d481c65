//! [`RestDrift`]: the displacement of a body in contact while it is observed.
//!
//! Contacts of resting bodies may alternate from frame to frame. Their vertices then move in a
//! cycle of some frames, faster than [`SleepParams::speed`](super::SleepParams::speed), without a
//! net displacement. A body counts as at rest if it comes back to where its observation started, in
//! each of two windows of frames. A body that turns around comes back once.

use std::ops::RangeInclusive;

/// Frames in which a body at rest returns, once in each window.
///
/// A cycle of up to 12 frames returns in both. The first frames are too few to tell creep from
/// rest.
const WINDOWS: [RangeInclusive<u32>; 2] = [8..=20, 21..=LAST];

/// Last frame of an observation in which a body may return.
pub(super) const LAST: u32 = 32;

/// The motion of a body since the start of its observation, measured before every frame.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct RestDrift {
    /// Positions at the start of the observation \[m\], shape [vertex slots].
    start: Vec<[f32; 4]>,
    /// Whether the current frame is measured.
    is_measured: bool,
    /// Whether every frame so far was measured, and the body stayed near its start.
    stays: bool,
    /// Whether it was back at its start in each window.
    has_returned: [bool; 2],
}

impl RestDrift {
    /// Measures before a frame; `frames` counts those since the start of the observation.
    ///
    /// `limits` \[m\] bound the displacement along an axis: of a body that is back, and of one
    /// that stays near its start.
    pub(super) fn measure(&mut self, positions: &[[f32; 4]], frames: u32, limits: [f64; 2]) {
        self.is_measured = true;
        if frames == 0 {
            self.start.clear();
            self.start.extend_from_slice(positions);
            self.stays = true;
            self.has_returned = [false; 2];
            return;
        }
        self.stays &= self.start.len() == positions.len();
        if !self.stays {
            return;
        }
        let distance = f64::from(self.distance(positions));
        self.stays = distance <= limits[1];
        for (has_returned, window) in self.has_returned.iter_mut().zip(WINDOWS) {
            *has_returned |= window.contains(&frames) && distance <= limits[0];
        }
    }

    /// Returns the maximum change of a coordinate since the start of the observation \[m\].
    fn distance(&self, positions: &[[f32; 4]]) -> f32 {
        let vertices = self.start.iter().zip(positions);
        let along = |(from, to): (&[f32; 4], &[f32; 4])| {
            let [x, y, z] = [0, 1, 2].map(|k| (to[k] - from[k]).abs());
            x.max(y).max(z)
        };
        vertices.map(along).fold(0.0, f32::max)
    }

    /// Ends a frame. After one that was not measured, the motion is unknown.
    pub(super) fn end_frame(&mut self) {
        self.stays &= std::mem::take(&mut self.is_measured);
    }

    /// Returns whether the body stayed near its start and returned to it in both windows.
    pub(super) fn is_in_place(&self) -> bool {
        self.stays && self.has_returned == [true; 2]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns whether a vertex stays in place that moves along heights \[m\], one per frame.
    fn stays(height: impl Fn(u32) -> f32) -> bool {
        let mut excursion = RestDrift::default();
        for frame in 0..=LAST {
            let positions = [[0.0; 4], [1.0, height(frame), 0.0, 1.0]];
            excursion.measure(&positions, frame, [0.01 * f64::from(frame), 0.5]);
            excursion.end_frame();
        }
        excursion.is_in_place()
    }

    #[test]
    fn a_vertex_that_moves_back_and_forth_stays_in_place() {
        assert!(stays(|_| 1.0));
        assert!(stays(|frame| [1.0, 1.4][frame as usize % 2]), "every frame");
        assert!(!stays(|frame| [1.0, 1.6][frame as usize % 2]), "too far");
        for period in [3, 7, 12] {
            let part = |frame: u32| (frame % period) as f32 / period as f32;
            assert!(stays(|frame| 0.4 * part(frame)), "a cycle of {period}");
        }
        assert!(!stays(|frame| 0.02 * frame as f32), "it creeps");
        // Up in the first window and down in the second one.
        let turn = |frame: u32| 0.02 * frame.min(LAST - frame) as f32;
        assert!(!stays(turn), "it turns around");
    }

    #[test]
    fn motion_is_unknown_after_a_frame_that_was_not_measured() {
        let mut excursion = RestDrift::default();
        for _ in 0..2 {
            for frame in 0..=LAST {
                excursion.measure(&[[0.0; 4]], frame, [0.0; 2]);
                excursion.end_frame();
            }
            assert!(excursion.is_in_place(), "all is measured");
            excursion.end_frame();
            assert!(!excursion.is_in_place());
        }
        for frame in 0..=LAST {
            let vertices = [[0.0; 4]; 2];
            let count = if frame < 5 { 1 } else { 2 };
            excursion.measure(&vertices[..count], frame, [0.0; 2]);
            excursion.end_frame();
        }
        assert!(!excursion.is_in_place(), "other vertices");
    }
}
