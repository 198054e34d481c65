//! Repeated runs and their times: warm-up, budget and statistics.

use serde::Serialize;
use stats_alloc::INSTRUMENTED_SYSTEM;
use std::time::{Duration, Instant};

/// Batches of frames in a measurement; the median counts.
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

/// Number of runs of a measurement.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Budget {
    /// Runs before the measurement.
    pub(crate) warm_up: u32,
    /// Smallest and largest number of runs.
    pub(crate) runs: [u32; 2],
    /// Time after which the smallest number is enough, and after which one run is \[s\].
    pub(crate) seconds: [f64; 2],
}

impl Budget {
    /// Returns a fixed number of runs without a warm-up.
    pub(crate) const fn runs(count: u32) -> Self {
        Self {
            warm_up: 0,
            runs: [count; 2],
            seconds: [f64::INFINITY; 2],
        }
    }
}

/// Times of runs \[s\].
#[derive(Debug, Clone, Default)]
pub(crate) struct Times(pub(crate) Vec<f64>);

impl Times {
    /// Executes a run and records its time.
    ///
    /// # Errors
    /// The error of the run, which is not recorded.
    pub(crate) fn time<T, E>(&mut self, run: impl FnOnce() -> Result<T, E>) -> Result<T, E> {
        self.time_frames(1, run)
    }

    /// Executes a run of several frames and records the time of one.
    ///
    /// # Errors
    /// As [`Times::time`].
    pub(crate) fn time_frames<T, E>(
        &mut self,
        frames: u32,
        run: impl FnOnce() -> Result<T, E>,
    ) -> Result<T, E> {
        let begin = Instant::now();
        let done = run()?;
        self.0
            .push(begin.elapsed().as_secs_f64() / f64::from(frames));
        Ok(done)
    }

    /// Returns the median, the lower of two; NaN without runs.
    pub(crate) fn median(&self) -> f64 {
        self.percentile(50)
    }

    /// Returns the median \[ms\]; none without runs.
    #[cfg(feature = "reference")]
    pub(crate) fn median_ms(&self) -> Option<f64> {
        (!self.0.is_empty()).then(|| self.median() * 1e3)
    }

    /// Returns the shortest time; NaN without runs.
    pub(crate) fn min(&self) -> f64 {
        self.percentile(0)
    }

    /// Returns a percentile, which is the time of a run; NaN without runs.
    pub(crate) fn percentile(&self, percent: usize) -> f64 {
        percentile(&sorted(self.0.clone()), percent)
    }
}

/// Repeats a run within a budget; it records the times that count.
///
/// # Errors
/// The error of a run.
pub(crate) fn measure<E>(
    budget: &Budget,
    mut run: impl FnMut(&mut Times) -> Result<(), E>,
) -> Result<Times, E> {
    for _ in 0..budget.warm_up {
        run(&mut Times::default())?;
    }
    let ([least, most], [enough, too_long]) = (budget.runs, budget.seconds);
    let mut times = Times::default();
    let begin = Instant::now();
    for runs in 0..most {
        let spent = begin.elapsed().as_secs_f64();
        if runs >= least && spent > enough || runs > 0 && spent > too_long {
            break;
        }
        run(&mut times)?;
    }
    Ok(times)
}

/// Returns the number of allocations and reallocations of this process.
///
/// The program's allocator counts them; `main.rs` sets it.
pub(crate) fn allocations() -> usize {
    let stats = INSTRUMENTED_SYSTEM.stats();
    stats.allocations + stats.reallocations
}

/// Length of a measurement of frames.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Length {
    Frames(u32),
    /// An approximate time \[s\].
    Seconds(f64),
}

/// Times of frames.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct FrameTimes {
    /// Number of frames in all batches.
    frames: u32,
    /// Time of a frame in a batch, median over batches.
    pub(crate) ms_per_frame: f64,
    /// Time of a single frame, median.
    ms_latency: f64,
    pub(crate) frames_per_second: f64,
}

/// Times `run`, which executes a number of frames and returns at the end of the last.
///
/// # Errors
/// The error of `run`.
pub(crate) fn measure_frames<E>(
    length: Length,
    mut run: impl FnMut(u32) -> Result<(), E>,
) -> Result<FrameTimes, E> {
    let (most, quarter) = match length {
        Length::Seconds(seconds) => (SINGLE_FRAMES, seconds / 4.0),
        Length::Frames(frames) => (SINGLE_FRAMES.min(frames), f64::INFINITY),
    };
    let single = Budget {
        warm_up: WARM_UP,
        runs: [1, most],
        seconds: [quarter; 2],
    };
    let latency = measure(&single, |times| times.time(|| run(1)))?.median();
    let (batches, frames) = plan(length, latency);
    let times = measure(&Budget::runs(batches), |times| {
        times.time_frames(frames, || run(frames))
    })?;
    let seconds = times.median();
    Ok(FrameTimes {
        frames: batches * frames,
        ms_per_frame: seconds * 1e3,
        ms_latency: latency * 1e3,
        frames_per_second: 1.0 / seconds,
    })
}

/// Returns the number of batches and of frames in each.
fn plan(length: Length, latency: f64) -> (u32, u32) {
    match length {
        Length::Frames(frames) => {
            let batches = frames.clamp(1, BATCHES).max(frames.div_ceil(MAX_BATCH));
            (batches, (frames / batches).max(1))
        }
        Length::Seconds(seconds) => {
            let frames = seconds / latency.max(1e-9);
            if frames < f64::from(BATCHES) {
                return (MIN_BATCHES.max(whole(frames)), 1);
            }
            let batch = whole(frames / f64::from(BATCHES)).clamp(1, MAX_BATCH);
            (whole(frames / f64::from(batch)).clamp(BATCHES, 1000), batch)
        }
    }
}

/// Rounds a positive number down.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a saturating cast of a positive number"
)]
pub(crate) fn whole(x: f64) -> u32 {
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
pub(crate) fn measure_pairs<E>(
    count: u32,
    functions: &mut [impl FnMut() -> Result<(), E>; 2],
) -> Result<Pairs, E> {
    let mut runs = [1; 2];
    for (runs, function) in runs.iter_mut().zip(&mut *functions) {
        *runs = runs_per_sample(function)?;
    }
    let mut samples = [Times::default(), Times::default()];
    let ratios = measure(&Budget::runs(count), |ratios| {
        let first = ratios.0.len() % 2;
        for k in [first, 1 - first] {
            sample(&mut samples[k], &mut functions[k], runs[k])?;
        }
        let last = samples
            .each_ref()
            .map(|times| times.0.last().copied().unwrap_or(f64::NAN));
        ratios.0.push(last[0] / last[1]);
        Ok(())
    })?;
    Ok(Pairs {
        ratio: ratios.median(),
        seconds: samples.map(|times| times.median()),
    })
}

/// Returns the number of runs per sample; warms up too.
fn runs_per_sample<E>(function: &mut impl FnMut() -> Result<(), E>) -> Result<u32, E> {
    let mut runs = 1_u32;
    loop {
        // The fastest of several: other programs disturb the rest.
        let times = measure(&Budget::runs(5), |times| sample(times, function, runs))?;
        let is_long = times.min() * f64::from(runs) >= SAMPLE.as_secs_f64();
        // A function that was optimized away takes no time.
        match runs.checked_mul(2) {
            Some(more) if !is_long => runs = more,
            _ => return Ok(runs),
        }
    }
}

/// Records the mean time of some runs.
fn sample<E>(
    times: &mut Times,
    function: &mut impl FnMut() -> Result<(), E>,
    runs: u32,
) -> Result<(), E> {
    times.time_frames(runs, || (0..runs).try_for_each(|_| function()))
}

/// Returns the mean; NaN without values.
pub(crate) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Returns the smallest value that `percent` of the sorted values do not exceed; NaN without
/// values.
pub(crate) fn percentile(sorted: &[f64], percent: usize) -> f64 {
    let rank = (sorted.len() * percent).div_ceil(100);
    let value = sorted.get(rank.saturating_sub(1));
    value.copied().unwrap_or(f64::NAN)
}

/// Sorts values.
pub(crate) fn sorted(mut values: Vec<f64>) -> Vec<f64> {
    values.sort_unstable_by(f64::total_cmp);
    values
}

/// Returns the median, the lower of two; NaN without values.
pub(crate) fn median(values: Vec<f64>) -> f64 {
    percentile(&sorted(values), 50)
}
