//! How fast the body's time passes: a machine that is too slow shows it slowed down, and says so.

use std::time::{Duration, Instant};

/// Frames that were stepped since an instant, again and again for a second.
#[derive(Debug)]
pub(super) struct Pace {
    since: Instant,
    frames: u64,
    share: Option<f32>,
}

impl Pace {
    const WHILE: Duration = Duration::from_secs(1);

    pub(super) fn new(now: Instant) -> Self {
        Self {
            since: now,
            frames: 0,
            share: None,
        }
    }

    /// Notes how many frames of `dt` there have been by now; of a body that does not move there is nothing to tell.
    pub(super) fn note(&mut self, now: Instant, frames: u64, dt: Duration, is_moving: bool) {
        let passed = now - self.since;
        if is_moving && passed < Self::WHILE {
            return;
        }
        let stepped = frames.saturating_sub(self.frames) as f32;
        let share = stepped * dt.as_secs_f32() / passed.as_secs_f32();
        *self = Self {
            since: now,
            frames,
            share: is_moving.then_some(share),
        };
    }

    /// What to tell, if anything is known.
    pub(super) fn text(&self) -> String {
        match self.share {
            None => "-".to_owned(),
            // Pictures and frames do not come in step.
            Some(share) if share > 0.9 => "real time".to_owned(),
            Some(share) => format!("{:.0} % of real time", share * 100.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_the_frames_are_half_the_speed() {
        let begin = Instant::now();
        let dt = Duration::from_secs(1) / 60;
        let at = |seconds: f32| begin + Duration::from_secs_f32(seconds);
        let mut pace = Pace::new(begin);
        assert_eq!(pace.text(), "-");
        pace.note(at(0.5), 15, dt, true);
        assert_eq!(pace.text(), "-", "it is too early to tell");
        pace.note(at(1.0), 30, dt, true);
        assert_eq!(pace.text(), "50 % of real time");
        pace.note(at(2.0), 90, dt, true);
        assert_eq!(pace.text(), "real time");
        pace.note(at(2.1), 90, dt, false);
        assert_eq!(pace.text(), "-", "it rests");
        pace.note(at(3.0), 90, dt, true);
        assert_eq!(pace.text(), "-", "it has just begun to move");
    }
}
