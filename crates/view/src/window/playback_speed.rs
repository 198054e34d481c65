//! Measures the playback speed, which is below real time on a slow machine.

use std::time::{Duration, Instant};

/// The ratio of simulated to real time, measured once per second.
#[derive(Debug)]
pub(super) struct PlaybackSpeed {
    since: Instant,
    frames: u64,
    ratio: Option<f32>,
}

impl PlaybackSpeed {
    const INTERVAL: Duration = Duration::from_secs(1);

    pub(super) fn new(now: Instant) -> Self {
        Self {
            since: now,
            frames: 0,
            ratio: None,
        }
    }

    /// Records the number of frames of `dt` so far. The ratio is unknown while the body is at rest.
    pub(super) fn record(&mut self, now: Instant, frames: u64, dt: Duration, is_moving: bool) {
        let passed = now - self.since;
        if is_moving && passed < Self::INTERVAL {
            return;
        }
        let stepped = frames.saturating_sub(self.frames) as f32;
        let ratio = stepped * dt.as_secs_f32() / passed.as_secs_f32();
        *self = Self {
            since: now,
            frames,
            ratio: is_moving.then_some(ratio),
        };
    }

    /// Formats the ratio for the panel; a dash if it is unknown.
    pub(super) fn text(&self) -> String {
        match self.ratio {
            None => "-".to_owned(),
            // Redraws and frames are not synchronized.
            Some(ratio) if ratio > 0.9 => "real time".to_owned(),
            Some(ratio) => format!("{:.0} % of real time", ratio * 100.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn speed_is_simulated_over_real_time() {
        let begin = Instant::now();
        let dt = Duration::from_secs(1) / 60;
        let at = |seconds: f32| begin + Duration::from_secs_f32(seconds);
        let mut speed = PlaybackSpeed::new(begin);
        assert_eq!(speed.text(), "-");
        speed.record(at(0.5), 15, dt, true);
        assert_eq!(speed.text(), "-", "less than a second");
        speed.record(at(1.0), 30, dt, true);
        assert_eq!(speed.text(), "50 % of real time");
        speed.record(at(2.0), 90, dt, true);
        assert_eq!(speed.text(), "real time");
        speed.record(at(2.1), 90, dt, false);
        assert_eq!(speed.text(), "-", "the body is at rest");
        speed.record(at(3.0), 90, dt, true);
        assert_eq!(speed.text(), "-", "the body has just started to move");
    }
}
