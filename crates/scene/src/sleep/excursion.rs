//! [`Excursion`]: how far the vertices of a body go while it is observed.
//!
//! Contacts of resting bodies may alternate from frame to frame. Their vertices then move back and
//! forth, faster than [`SleepParams::speed`](super::SleepParams::speed), and get nowhere.

/// The motion of a body since the start of its observation, measured before every frame.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Excursion {
    /// Positions at the start \[m\], shape [vertex slots].
    start: Vec<[f32; 4]>,
    /// Maximum change of a coordinate since the start \[m\].
    distance: f32,
    /// Maximum of the distances so far \[m\].
    farthest: f32,
    /// Whether the current frame is measured.
    is_measured: bool,
    /// Whether every frame so far was measured.
    is_complete: bool,
}

impl Excursion {
    /// Measures before a frame, the first one or a later one.
    pub(super) fn measure(&mut self, positions: &[[f32; 4]], is_first: bool) {
        self.is_measured = true;
        if is_first {
            self.start.clear();
            self.start.extend_from_slice(positions);
            (self.distance, self.farthest) = (0.0, 0.0);
            self.is_complete = true;
            return;
        }
        self.is_complete &= self.start.len() == positions.len();
        if !self.is_complete {
            return;
        }
        let mut distance = 0.0_f32;
        for (from, to) in self.start.iter().zip(positions) {
            for k in 0..3 {
                distance = distance.max((to[k] - from[k]).abs());
            }
        }
        self.distance = distance;
        self.farthest = self.farthest.max(distance);
    }

    /// Ends a frame. After one that was not measured, the motion is unknown.
    pub(super) fn end_frame(&mut self) {
        self.is_complete &= std::mem::take(&mut self.is_measured);
    }

    /// Returns the distance from the start along an axis, now and the farthest so far \[m\].
    ///
    /// `None` if a frame was not measured.
    pub(super) fn distances(&self) -> Option<[f64; 2]> {
        let distances = [self.distance, self.farthest].map(f64::from);
        self.is_complete.then_some(distances)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Measures a vertex at heights \[m\], with a frame after each of them.
    fn along(heights: &[f32]) -> Excursion {
        let mut excursion = Excursion::default();
        for (i, &y) in heights.iter().enumerate() {
            excursion.measure(&[[0.0; 4], [1.0, y, 0.0, 1.0]], i == 0);
            excursion.end_frame();
        }
        excursion
    }

    #[test]
    fn motion_back_and_forth_ends_where_it_started() {
        let there_and_back = along(&[1.0, 1.25, 0.5, 1.25, 1.0]);
        assert_eq!(there_and_back.distances(), Some([0.0, 0.5]));
        assert_eq!(along(&[1.0, 1.25]).distances(), Some([0.25, 0.25]));
        let mut again = there_and_back;
        again.measure(&[[0.0; 4]], true);
        assert_eq!(again.distances(), Some([0.0, 0.0]));
    }

    #[test]
    fn motion_is_unknown_after_a_frame_that_was_not_measured() {
        let mut excursion = along(&[1.0, 1.0]);
        excursion.end_frame();
        assert_eq!(excursion.distances(), None);
        excursion.measure(&[[0.0; 4], [1.0; 4]], false);
        assert_eq!(excursion.distances(), None, "until the next start");
        let mut more_vertices = along(&[1.0]);
        more_vertices.measure(&[[0.0; 4]; 3], false);
        assert_eq!(more_vertices.distances(), None);
    }
}
