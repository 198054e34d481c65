//! [`Excursion`]: the displacement of a body in contact while it is observed.
//!
//! Contacts of resting bodies may alternate from frame to frame. Their vertices then move back and
//! forth, faster than [`SleepParams::speed`](super::SleepParams::speed), without a net
//! displacement. So positions are compared every [`INTERVAL`] frames. A body that turns around in
//! its motion moves in some of these intervals.

/// Number of frames between compared positions: even, since contacts alternate every frame.
pub(super) const INTERVAL: u32 = 16;

/// The motion of a body since the start of its observation, measured before every frame.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Excursion {
    /// Positions at the start of the interval \[m\], shape [vertex slots].
    start: Vec<[f32; 4]>,
    /// Whether the current frame is measured.
    is_measured: bool,
    /// Whether every frame so far was measured, and the body stayed in place.
    is_in_place: bool,
}

impl Excursion {
    /// Measures before a frame; `frames` counts those since the start of the observation.
    ///
    /// In place, `limits` \[m\] bound the displacement along an axis: at the end of an interval,
    /// and within it.
    pub(super) fn measure(&mut self, positions: &[[f32; 4]], frames: u32, limits: [f64; 2]) {
        self.is_measured = true;
        if frames > 0 {
            self.is_in_place &= self.start.len() == positions.len();
            if !self.is_in_place {
                return;
            }
            let limit = limits[usize::from(!frames.is_multiple_of(INTERVAL))];
            self.is_in_place = f64::from(self.distance(positions)) <= limit;
        } else {
            self.is_in_place = true;
        }
        if frames.is_multiple_of(INTERVAL) {
            self.start.clear();
            self.start.extend_from_slice(positions);
        }
    }

    /// Returns the maximum change of a coordinate since the start of the interval \[m\].
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
        self.is_in_place &= std::mem::take(&mut self.is_measured);
    }

    /// Returns whether every frame was measured, and the body stayed in place.
    pub(super) fn is_in_place(&self) -> bool {
        self.is_in_place
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns whether a vertex stays in place that moves along heights \[m\], one per frame.
    fn stays(height: impl Fn(u32) -> f32) -> bool {
        let mut excursion = Excursion::default();
        for frame in 0..=2 * INTERVAL {
            excursion.measure(
                &[[0.0; 4], [1.0, height(frame), 0.0, 1.0]],
                frame,
                [0.1, 0.5],
            );
            excursion.end_frame();
        }
        excursion.is_in_place()
    }

    #[test]
    fn a_vertex_that_moves_back_and_forth_stays_in_place() {
        assert!(stays(|_| 1.0));
        assert!(stays(|frame| [1.0, 1.4][frame as usize % 2]), "every frame");
        assert!(!stays(|frame| [1.0, 1.6][frame as usize % 2]), "too far");
        assert!(!stays(|frame| 0.02 * frame as f32), "it creeps");
        // Up in the first interval and down in the second one.
        let turn = |frame: u32| 0.02 * frame.min(2 * INTERVAL - frame) as f32;
        assert!(!stays(turn), "it turns around");
    }

    #[test]
    fn motion_is_unknown_after_a_frame_that_was_not_measured() {
        let mut excursion = Excursion::default();
        for _ in 0..2 {
            excursion.measure(&[[0.0; 4]], 0, [0.0; 2]);
            assert!(excursion.is_in_place(), "a new observation");
            excursion.end_frame();
            excursion.end_frame();
            excursion.measure(&[[0.0; 4]], 2, [0.0; 2]);
            assert!(!excursion.is_in_place());
        }
        excursion.measure(&[[0.0; 4]], 0, [0.0; 2]);
        excursion.measure(&[[0.0; 4]; 2], 1, [0.0; 2]);
        assert!(!excursion.is_in_place(), "other vertices");
    }
}
