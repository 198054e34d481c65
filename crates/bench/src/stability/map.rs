//! The stability map: largest energy over time steps, compliances and loads.

use super::case::{Case, Worst};
use super::energy::{Limits, energy_over};
use super::error::StressError;
use super::masses::ribbon;
use super::runner::Runner;
use super::scenes::{HANGING, elastic_shell, whole};
use incise_pbd_gpu::SolverParams;
use serde::Serialize;

pub(super) const CASES: [Case; 1] = [Case {
    id: "map",
    stress: "a swinging ribbon over time steps, compliances and loads",
    invariant: "largest energy, relative to the start",
    bound: 1.01,
    run,
}];

/// Loads of the ribbon, in masses of a vertex.
pub(super) const RATIOS: [f32; 3] = [1.0, 1e3, 1e6];
/// Half orders of magnitude of the frame rate.
pub(super) const RATES: std::ops::RangeInclusive<i32> = 2..=10;
/// Orders of magnitude of the compliance of stretch [m/N].
pub(super) const COMPLIANCES: std::ops::RangeInclusive<i32> = -12..=2;

/// One time step, compliance and load.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(super) struct Cell {
    pub(super) ratio: f32,
    /// Half orders of magnitude of the frames a second.
    pub(super) rate: i32,
    /// Orders of magnitude [m/N].
    pub(super) compliance: i32,
    /// Largest relative energy; infinite if a position becomes NaN.
    pub(super) energy: f64,
}

/// Returns all cells, or every fourth in a quick run.
///
/// # Errors
/// [`StressError`] when the ribbon cannot be set up.
fn cells(runner: &mut Runner) -> Result<Vec<Cell>, StressError> {
    let mut cells = Vec::new();
    let stride = runner.pick(4, 1);
    let params = SolverParams {
        iterations: 1,
        ..HANGING
    };
    for ratio in RATIOS {
        for rate in RATES.step_by(stride) {
            for compliance in COMPLIANCES.step_by(stride) {
                let material = elastic_shell(10.0_f32.powi(compliance), 0.1);
                let mut body = ribbon(runner, &material, ratio, true)?;
                let dt = 10.0_f32.powf(-0.5 * rate as f32);
                // A quarter of a swing at least.
                let frames = 200.max(whole(0.5 / dt));
                let outcome = energy_over(&mut body, dt, &params, frames, Limits::above(-1.0));
                cells.push(Cell {
                    ratio,
                    rate,
                    compliance,
                    energy: outcome.map_or(f64::INFINITY, |outcome| outcome.value),
                });
            }
        }
    }
    Ok(cells)
}

fn run(runner: &mut Runner) -> Result<Worst, StressError> {
    let mut worst = Worst::default();
    let cells = cells(runner)?;
    for cell in &cells {
        worst.judge(Ok(cell.energy), || {
            let rate = 10.0_f64.powf(f64::from(cell.rate) / 2.0);
            format!(
                "1/{rate:.0} s, 1e{} m/N, load {:e}",
                cell.compliance, cell.ratio
            )
        });
    }
    runner.map = Some(cells);
    Ok(worst)
}
