//! Times of frames in batches, and of two functions in turns.

use crate::statistics::median;
use std::time::{Duration, Instant};

/// Batches of a measurement; the median counts.
const BATCHES: u32 = 7;
/// Smallest number of batches.
const MIN_BATCHES: u32 = 3;
/// Largest number of frames in a batch.
const MAX_BATCH: u32 = 256;
/// Number of frames that are waited for one by one.
const SINGLE_FRAMES: u32 = 9;
/// Frames before a measurement.
const WARM_UP: u32 = 2;
/// Length of a sample in turns: far above the clock's resolution, below a scheduler's time slice.
const SAMPLE: Duration = Duration::from_millis(1);

/// Length of a measurement.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Budget {
    Frames(u32),
    /// An approximate time \[s\].
    Seconds(f64),
}

/// Times of frames.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FrameTimes {
    /// Time of a frame in a batch, median over batches \[s\].
    pub(crate) per_frame: f64,
    /// Time of a single frame, median \[s\].
    pub(crate) latency: f64,
    /// Number of frames in all batches.
    pub(crate) frames: u32,
}

/// Times `run`, which executes a number of frames and returns at the end of the last.
///
/// # Errors
/// The error of `run`.
pub(crate) fn frame_times<E>(
    budget: Budget,
    mut run: impl FnMut(u32) -> Result<(), E>,
) -> Result<FrameTimes, E> {
    let mut timed = |frames: u32| -> Result<f64, E> {
        let begin = Instant::now();
        run(frames)?;
        Ok(begin.elapsed().as_secs_f64())
    };
    for _ in 0..WARM_UP {
        timed(1)?;
    }
    let mut single = vec![timed(1)?];
    let (most, quarter) = match budget {
        Budget::Seconds(seconds) => (SINGLE_FRAMES, seconds / 4.0),
        Budget::Frames(frames) => (SINGLE_FRAMES.min(frames), f64::INFINITY),
    };
    for _ in 1..most {
        if single.iter().sum::<f64>() > quarter {
            break;
        }
        single.push(timed(1)?);
    }
    let latency = median(single);
    let (batches, frames) = plan(budget, latency);
    let mut times = Vec::new();
    for _ in 0..batches {
        times.push(timed(frames)? / f64::from(frames));
    }
    Ok(FrameTimes {
        per_frame: median(times),
        latency,
        frames: batches * frames,
    })
}

/// Returns the number of batches and of frames in each.
fn plan(budget: Budget, latency: f64) -> (u32, u32) {
    match budget {
        Budget::Frames(frames) => {
            let batches = frames.clamp(1, BATCHES).max(frames.div_ceil(MAX_BATCH));
            (batches, (frames / batches).max(1))
        }
        Budget::Seconds(seconds) => {
            let frames = seconds / latency.max(1e-9);
            if frames < f64::from(BATCHES) {
                return (MIN_BATCHES.max(whole(frames)), 1);
            }
            let batch = whole(frames / f64::from(BATCHES)).clamp(1, MAX_BATCH);
            (whole(frames / f64::from(batch)).clamp(BATCHES, 1000), batch)
        }
    }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a saturating cast of a positive number"
)]
fn whole(x: f64) -> u32 {
    x as u32
}

/// Medians of pairs of times.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pairs {
    /// Median ratio of the first time to the second.
    pub(crate) ratio: f64,
    /// Median times of one run \[s\].
    pub(crate) seconds: [f64; 2],
}

/// Times two functions in turns, so that changes of the machine's speed affect both.
///
/// # Errors
/// The error of a run.
pub(crate) fn pairs<E>(
    count: u32,
    mut first: impl FnMut() -> Result<(), E>,
    mut second: impl FnMut() -> Result<(), E>,
) -> Result<Pairs, E> {
    let runs = [runs_per_sample(&mut first)?, runs_per_sample(&mut second)?];
    let (mut times, mut ratios) = ([Vec::new(), Vec::new()], Vec::new());
    for pair in 0..count {
        let (a, b);
        if pair % 2 == 0 {
            a = sample(&mut first, runs[0])?;
            b = sample(&mut second, runs[1])?;
        } else {
            b = sample(&mut second, runs[1])?;
            a = sample(&mut first, runs[0])?;
        }
        times[0].push(a);
        times[1].push(b);
        ratios.push(a / b);
    }
    Ok(Pairs {
        ratio: median(ratios),
        seconds: times.map(median),
    })
}

/// Returns the number of runs per sample; warms up too.
fn runs_per_sample<E>(function: &mut impl FnMut() -> Result<(), E>) -> Result<u32, E> {
    let mut runs = 1;
    loop {
        // The fastest of several: other programs disturb the rest.
        let mut fastest = f64::INFINITY;
        for _ in 0..5 {
            fastest = fastest.min(sample(function, runs)? * f64::from(runs));
        }
        if fastest >= SAMPLE.as_secs_f64() {
            return Ok(runs);
        }
        // A function that was optimized away takes no time.
        let Some(more) = runs.checked_mul(2) else {
            return Ok(runs);
        };
        runs = more;
    }
}

/// Returns the mean time of one run \[s\].
fn sample<E>(function: &mut impl FnMut() -> Result<(), E>, runs: u32) -> Result<f64, E> {
    let begin = Instant::now();
    for _ in 0..runs {
        function()?;
    }
    Ok(begin.elapsed().as_secs_f64() / f64::from(runs))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_frame_of_the_budget_runs_in_small_batches() {
        for asked in [1, 2, 7, 100, 5000] {
            let (mut largest, mut all) = (0, 0);
            let times = frame_times(Budget::Frames(asked), |n| {
                largest = largest.max(n);
                all += n;
                Ok::<(), ()>(())
            });
            let times = times.unwrap();
            assert!(largest <= MAX_BATCH, "{largest}");
            assert!(times.frames <= asked && times.frames > asked / 2, "{asked}");
            assert_eq!(all, times.frames + WARM_UP + SINGLE_FRAMES.min(asked));
        }
    }

    #[test]
    fn slow_frames_run_a_few_times_and_fast_ones_in_batches() {
        assert_eq!(plan(Budget::Seconds(1.0), 5.0), (3, 1));
        assert_eq!(plan(Budget::Seconds(1.0), 0.2), (5, 1));
        assert_eq!(plan(Budget::Seconds(1.0), 0.01), (7, 14));
        let (batches, frames) = plan(Budget::Seconds(1.0), 1e-5);
        assert!(frames == MAX_BATCH && batches > BATCHES, "{batches}");
    }

    #[test]
    fn a_function_without_work_is_timed() {
        let nothing = || Ok::<(), ()>(());
        let found = pairs(3, nothing, nothing).unwrap();
        let is_fast = found.seconds.iter().all(|s| (0.0..1e-6).contains(s));
        assert!(is_fast, "{found:?}");
    }
}
