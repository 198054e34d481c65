//! How long frames take.

use std::time::Instant;

/// Parts that a measurement is divided into; the median of them counts.
const BATCHES: u32 = 7;
/// Fewest batches of which a median is taken.
const FEWEST: u32 = 3;
/// Most frames that are handed to a device at once.
const MOST: u32 = 256;
/// Frames of which each is waited for, where there is time.
const ALONE: u32 = 9;
/// Frames before anything is measured: the first makes what later ones find ready.
const WARM_UP: u32 = 2;

/// How long a measurement goes on.
#[derive(Debug, Clone, Copy)]
pub(super) enum Budget {
    /// So many frames.
    Frames(u32),
    /// About so many seconds.
    Seconds(f64),
}

/// What was measured.
#[derive(Debug, Clone, Copy)]
pub(super) struct Times {
    /// Of a frame in a batch: the median over batches \[s\].
    pub(super) per_frame: f64,
    /// Of one frame from its start to its end: the median \[s\].
    pub(super) latency: f64,
    /// Frames in all batches.
    pub(super) frames: u32,
}

/// Times `run`, which has so many frames done and returns when the last of them is.
pub(super) fn measure<E>(
    budget: Budget,
    mut run: impl FnMut(u32) -> Result<(), E>,
) -> Result<Times, E> {
    let mut timed = |frames: u32| -> Result<f64, E> {
        let begin = Instant::now();
        run(frames)?;
        Ok(begin.elapsed().as_secs_f64())
    };
    for _ in 0..WARM_UP {
        timed(1)?;
    }
    let mut alone = vec![timed(1)?];
    let (most, quarter) = match budget {
        Budget::Seconds(seconds) => (ALONE, seconds / 4.0),
        Budget::Frames(frames) => (ALONE.min(frames), f64::INFINITY),
    };
    for _ in 1..most {
        if alone.iter().sum::<f64>() > quarter {
            break;
        }
        alone.push(timed(1)?);
    }
    let latency = median(&mut alone);
    let (batches, frames) = plan(budget, latency);
    let mut times = Vec::new();
    for _ in 0..batches {
        times.push(timed(frames)? / f64::from(frames));
    }
    Ok(Times {
        per_frame: median(&mut times),
        latency,
        frames: batches * frames,
    })
}

/// How many batches of how many frames.
fn plan(budget: Budget, latency: f64) -> (u32, u32) {
    match budget {
        Budget::Frames(frames) => {
            let batches = frames.clamp(1, BATCHES);
            let batches = batches.max(frames.div_ceil(MOST));
            (batches, (frames / batches).max(1))
        }
        Budget::Seconds(seconds) => {
            let frames = seconds / latency.max(1e-9);
            if frames < f64::from(BATCHES) {
                return (FEWEST.max(whole(frames)), 1);
            }
            let batch = whole(frames / f64::from(BATCHES)).clamp(1, MOST);
            (whole(frames / f64::from(batch)).clamp(BATCHES, 1000), batch)
        }
    }
}

/// The middle value; of two middle ones the smaller.
fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    let middle = values.len().saturating_sub(1) / 2;
    values.get(middle).copied().unwrap_or(f64::NAN)
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a saturating cast of a positive number"
)]
fn whole(x: f64) -> u32 {
    x as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_frame_of_the_budget_is_run_and_no_batch_is_too_large() {
        for asked in [1, 2, 7, 100, 5000] {
            let mut largest = 0;
            let mut all = 0;
            let times = measure(Budget::Frames(asked), |n| {
                largest = largest.max(n);
                all += n;
                Ok::<(), ()>(())
            });
            let times = times.unwrap();
            assert!(largest <= MOST, "{largest}");
            assert!(times.frames <= asked && times.frames > asked / 2, "{asked}");
            assert_eq!(all, times.frames + WARM_UP + ALONE.min(asked), "of {asked}");
        }
    }

    #[test]
    fn a_slow_frame_is_run_a_few_times_and_a_fast_one_in_batches() {
        assert_eq!(plan(Budget::Seconds(1.0), 5.0), (3, 1));
        assert_eq!(plan(Budget::Seconds(1.0), 0.2), (5, 1));
        assert_eq!(plan(Budget::Seconds(1.0), 0.01), (7, 14));
        let (batches, frames) = plan(Budget::Seconds(1.0), 1e-5);
        assert_eq!(frames, MOST);
        assert!(batches > BATCHES, "{batches}");
    }

    #[test]
    fn an_error_ends_the_measurement() {
        let mut left = 4;
        let done = measure(Budget::Frames(100), |_| {
            left -= 1;
            if left == 0 { Err("lost") } else { Ok(()) }
        });
        assert_eq!(done.unwrap_err(), "lost");
    }

    #[test]
    fn the_median_is_one_of_the_values() {
        assert_eq!(median(&mut [3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(&mut [4.0, 1.0, 3.0, 2.0]), 2.0);
    }
}
