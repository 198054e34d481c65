//! Two times side by side: a machine's speed changes from one minute to the next, what is measured in turns meets the
//! same one.

use crate::statistics::median;
use std::time::{Duration, Instant};

/// About how long the runs last that one time is made of: longer than a clock's grain by far, and shorter than what a
/// system gives a program before another has its turn. It is the same for both: what disturbs them does so as often.
const SAMPLE: Duration = Duration::from_millis(1);

/// What pairs of times came to.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pairs {
    /// The median of the times of the first over those of the second.
    pub(super) ratio: f64,
    /// Median times of one run \[s\].
    pub(super) seconds: [f64; 2],
}

/// Times two things in turns, so many pairs of samples, and who begins changes with every pair.
///
/// # Errors
/// What a run says.
pub(super) fn pairs<E>(
    count: u32,
    mut first: impl FnMut() -> Result<(), E>,
    mut second: impl FnMut() -> Result<(), E>,
) -> Result<Pairs, E> {
    let runs = [runs_of(&mut first)?, runs_of(&mut second)?];
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
    let middle = |mut values: Vec<f64>| {
        values.sort_by(f64::total_cmp);
        median(&values)
    };
    Ok(Pairs {
        ratio: middle(ratios),
        seconds: times.map(middle),
    })
}

/// How often something is to be run for one sample. It is warm after.
fn runs_of<E>(what: &mut impl FnMut() -> Result<(), E>) -> Result<u32, E> {
    let mut runs = 1;
    loop {
        // The fastest: others may have had their turn in the rest.
        let mut fastest = f64::INFINITY;
        for _ in 0..5 {
            fastest = fastest.min(sample(what, runs)? * f64::from(runs));
        }
        if fastest >= SAMPLE.as_secs_f64() {
            return Ok(runs);
        }
        // What was optimized away takes no time however often it runs.
        let Some(more) = runs.checked_mul(2) else {
            return Ok(runs);
        };
        runs = more;
    }
}

/// Mean seconds of one run.
fn sample<E>(what: &mut impl FnMut() -> Result<(), E>, runs: u32) -> Result<f64, E> {
    let begin = Instant::now();
    for _ in 0..runs {
        what()?;
    }
    Ok(begin.elapsed().as_secs_f64() / f64::from(runs))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_takes_no_time_is_timed_too() {
        let nothing = || Ok::<(), ()>(());
        let found = pairs(3, nothing, nothing).unwrap();
        assert!(
            found.seconds.iter().all(|s| (0.0..1e-6).contains(s)),
            "{found:?}"
        );
    }
}
