//! [`Measured`]: quantities of one run, from which several cases take their values.

use super::case::{Case, Worst};
use super::error::StressError;
use super::runner::Runner;

/// The quantities of one run in the order of its cases; `None` where one does not apply.
pub(super) type Quantities = Vec<Option<f64>>;

/// One run and its quantities.
#[derive(Debug)]
pub(super) struct Measured {
    /// The description of the run.
    pub(super) at: String,
    pub(super) quantities: Result<Quantities, StressError>,
}

/// Returns the worst value of a quantity over the runs of a case, which `measure` makes once.
///
/// Cases with the id and stress of a previous one share its runs.
pub(super) fn worst_of(
    runner: &mut Runner,
    quantity: usize,
    measure: impl FnOnce(&Runner) -> Result<Vec<Measured>, StressError>,
) -> Result<Worst, StressError> {
    if runner.measured.is_none() {
        runner.measured = Some(measure(runner)?);
    }
    let mut worst = Worst::default();
    for Measured { at, quantities } in runner.measured.iter().flatten() {
        match quantities {
            Ok(all) => {
                if let Some(value) = all.get(quantity).copied().flatten() {
                    worst.judge(Ok(value), || at.clone());
                }
            }
            Err(error) => {
                let error = StressError::Invariant(error.to_string());
                worst.judge(Err::<f64, _>(error), || at.clone());
            }
        }
    }
    Ok(worst)
}

/// Divides cases into groups that share their runs: neighbors of one id and stress.
pub(super) fn groups(cases: &[Case]) -> Vec<&[Case]> {
    cases
        .chunk_by(|one, next| (one.id, one.stress) == (next.id, next.stress))
        .collect()
}
