//! Frame rates per simulated second, for the paper's Figure 11.

use std::time::Duration;

/// Frames and their times, one bin per simulated second. Recording allocates nothing.
#[derive(Debug, Clone, Default)]
pub(crate) struct FrameRates {
    frames_a_bin: u32,
    bins: Vec<(u32, Duration)>,
}

impl FrameRates {
    /// Returns bins for `frames`, of which `a_second` are a simulated second.
    pub(crate) fn new(frames: u32, a_second: u32) -> Self {
        let frames_a_bin = a_second.max(1);
        let bins = frames.div_ceil(frames_a_bin) as usize;
        Self {
            frames_a_bin,
            bins: vec![(0, Duration::ZERO); bins],
        }
    }

    /// Records the time of a frame; the first is 1.
    pub(crate) fn record(&mut self, frame: u32, work: Duration) {
        let bin = frame.saturating_sub(1) / self.frames_a_bin.max(1);
        if let Some((frames, sum)) = self.bins.get_mut(bin as usize) {
            *frames += 1;
            *sum += work;
        }
    }

    /// Returns frames per second of every bin; none for an empty bin.
    pub(crate) fn per_second(&self) -> Vec<Option<f64>> {
        let rate = |&(frames, sum): &(u32, Duration)| {
            (sum > Duration::ZERO).then(|| f64::from(frames) / sum.as_secs_f64())
        };
        self.bins.iter().map(rate).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_second_has_the_rate_of_its_frames() {
        let mut rates = FrameRates::new(7, 3);
        for frame in 1..=6 {
            let work = if frame <= 3 { 10 } else { 20 };
            rates.record(frame, Duration::from_millis(work));
        }
        rates.record(99, Duration::from_millis(1));
        let rates = rates.per_second();
        assert_eq!(rates.len(), 3, "the last second is not full");
        let [first, second] = [0, 1].map(|i| rates[i].unwrap());
        assert!((first - 100.0).abs() < 1e-9 && (second - 50.0).abs() < 1e-9);
        assert_eq!(rates[2], None, "nothing was timed there");
    }
}
