//! Models dropped and cut in flight, over mixes of constraints, sizes and planes.

mod fall;
mod sample;

use super::case::{Case, Worst};
use super::error::StressError;
use super::measured::{Measured, Quantities, worst_of};
use super::runner::Runner;
use fall::Fall;
use incise_scene::BackendRequest;
use sample::Sample;
use std::fmt::Write;

const STRESS: &str = "models of 1 cm to 100 m, with and without volume, springs and contacts, \
                      dropped by half their size and cut in flight";

pub(super) const CASES: [Case; 5] = [
    case(
        0.01,
        "relative volume error of a piece from a second after the impact on",
        |runner| worst_of(runner, 0, sweep),
    ),
    case(
        INVERTED,
        "volume that a piece with volume or springs has lost at any time",
        |runner| worst_of(runner, 1, sweep),
    ),
    case(
        0.01,
        "distance of a vertex outside of what the fall can reach, in sizes",
        |runner| worst_of(runner, 2, sweep),
    ),
    case(
        REBOUND,
        "speed of a vertex, relative to a fall from the body's top",
        |runner| worst_of(runner, 3, sweep),
    ),
    case(
        0.01,
        "energy gained by undoing the cut 30 to 60 frames later, of that at the start",
        |runner| worst_of(runner, 4, sweep),
    ),
];

const fn case(
    bound: f64,
    invariant: &'static str,
    run: fn(&mut Runner) -> Result<Worst, StressError>,
) -> Case {
    Case {
        id: "drop",
        stress: STRESS,
        invariant,
        bound,
        run,
    }
}

/// A loss just below the whole volume: beyond it a piece is inverted.
const INVERTED: f64 = 1.0 - 1e-6;
/// A small mass on a large one rebounds at three times the speed of the fall.
const REBOUND: f64 = 3.0;

/// Triangles of the drops of one model, unless their number is given: large models drop less often.
const TRIANGLES: u32 = 120_000;
/// Fewest and most drops of a model.
const DROPS: [u32; 2] = [4, 40];
/// Number of drops of which one is repeated with an undo.
const UNDO_STRIDE: u32 = 3;
/// Largest model of a quick run.
const QUICK_TRIANGLES: u32 = 1500;

/// Returns the number of drops of a model from its number of triangles.
fn drops(runner: &Runner, triangles: u32) -> u32 {
    let [fewest, most] = DROPS;
    let affordable = (TRIANGLES / triangles.max(1)).clamp(fewest, most);
    let usual = runner.pick(u32::from(triangles <= QUICK_TRIANGLES) * fewest, affordable);
    runner.setting.samples.unwrap_or(usual)
}

/// Drops all models, the largest first.
fn sweep(runner: &Runner) -> Result<Vec<Measured>, StressError> {
    let mut samples = Vec::new();
    let seconds = runner.pick(2.0, 5.0);
    for subject in runner.setting.subjects.iter().rev() {
        let triangles = subject.surface.topology().triangle_count();
        let count = drops(runner, u32::try_from(triangles).unwrap_or(u32::MAX));
        samples.extend(Sample::first(subject, count, seconds));
    }
    if let Some(text) = &runner.setting.matching {
        samples.retain(|sample| sample.describe().contains(text));
    }
    Ok(runner.each(&samples, |backend, sample| {
        let mut at = sample.describe();
        let quantities = measure(backend, sample, &mut at);
        Measured { at, quantities }
    }))
}

/// Measures a drop, and describes the piece that loses most volume.
fn measure(
    backend: &BackendRequest,
    sample: &Sample<'_>,
    at: &mut String,
) -> Result<Quantities, StressError> {
    let found = fall::fall(backend, sample)?;
    if let Some((triangles, part)) = found.loser {
        let _ = write!(
            at,
            ", piece of {triangles} triangles and {part:.1e} volumes"
        );
    }
    let gain = match sample.number.is_multiple_of(UNDO_STRIDE) {
        true => fall::undo(backend, sample, 30 + sample.number % 31)?,
        false => None,
    };
    let Fall {
        volume_error, loss, ..
    } = found;
    let (outside, speed) = (Some(found.outside), Some(found.speed));
    Ok(vec![volume_error, loss, outside, speed, gain])
}
