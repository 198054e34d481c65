//! Frame rates second by second: the paper's Figure 11.

use std::time::Duration;

/// Frames and their time, a bin for each simulated second. A frame allocates nothing: room for all is there from the start.
#[derive(Debug, Clone, Default)]
pub(crate) struct Pace {
    frames_a_bin: u32,
    bins: Vec<(u32, Duration)>,
}

impl Pace {
    /// For so many frames, of which so many take a simulated second.
    pub(crate) fn of(frames: u32, a_second: u32) -> Self {
        let frames_a_bin = a_second.max(1);
        let bins = frames.div_ceil(frames_a_bin) as usize;
        Self {
            frames_a_bin,
            bins: vec![(0, Duration::ZERO); bins],
        }
    }

    /// Notes what a frame took; the first is 1.
    pub(crate) fn note(&mut self, frame: u32, work: Duration) {
        let bin = frame.saturating_sub(1) / self.frames_a_bin.max(1);
        if let Some((frames, sum)) = self.bins.get_mut(bin as usize) {
            *frames += 1;
            *sum += work;
        }
    }

    /// Frames a second, bin by bin; none of a bin without frames.
    pub(crate) fn rates(&self) -> Vec<Option<f64>> {
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
        let mut pace = Pace::of(7, 3);
        for frame in 1..=6 {
            let work = if frame <= 3 { 10 } else { 20 };
            pace.note(frame, Duration::from_millis(work));
        }
        pace.note(99, Duration::from_millis(1));
        let rates = pace.rates();
        assert_eq!(rates.len(), 3, "the last second is not full");
        let [first, second] = [0, 1].map(|i| rates[i].unwrap());
        assert!((first - 100.0).abs() < 1e-9 && (second - 50.0).abs() < 1e-9);
        assert_eq!(rates[2], None, "nothing was timed there");
    }
}
