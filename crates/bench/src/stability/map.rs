//! Where in time steps, compliances and mass ratios the solver is stable.

use super::audit::{Rule, energy_over};
use super::case::{Case, Worst};
use super::failure::Failure;
use super::masses::ribbon;
use super::scenes::{HANGING, elastic_shell, whole};
use super::stage::Stage;
use incise_pbd_gpu::SolverParams;
use serde::Serialize;

pub(super) const CASES: [Case; 1] = [Case {
    id: "map",
    torture: "a swinging ribbon over time steps, compliances and loads",
    law: "energy of what there was",
    bound: 1.01,
    run,
}];

/// Loads of the ribbon, in vertices.
pub(super) const RATIOS: [f32; 3] = [1.0, 1e3, 1e6];
/// Frames a second, by which half orders of magnitude.
pub(super) const RATES: std::ops::RangeInclusive<i32> = 2..=10;
/// Compliances of stretch [m/N], by which orders of magnitude.
pub(super) const COMPLIANCES: std::ops::RangeInclusive<i32> = -12..=2;

/// One time step, compliance and load.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(super) struct Cell {
    pub(super) ratio: f32,
    /// Half orders of magnitude of the frames a second.
    pub(super) rate: i32,
    /// Orders of magnitude [m/N].
    pub(super) compliance: i32,
    /// The largest energy of what there was; infinite when a position stopped being a number.
    pub(super) energy: f64,
}

/// All cells; in short every fourth.
///
/// # Errors
/// [`Failure`] when the ribbon cannot be set up.
fn cells(stage: &mut Stage) -> Result<Vec<Cell>, Failure> {
    let mut cells = Vec::new();
    let stride = stage.pick(4, 1);
    let params = SolverParams {
        iterations: 1,
        ..HANGING
    };
    for ratio in RATIOS {
        for rate in RATES.step_by(stride) {
            for compliance in COMPLIANCES.step_by(stride) {
                let material = elastic_shell(10.0_f32.powi(compliance), 0.1);
                let mut mover = ribbon(stage, &material, ratio, true)?;
                let dt = 10.0_f32.powf(-0.5 * rate as f32);
                // A quarter of a swing at least.
                let frames = 200.max(whole(0.5 / dt));
                let found = energy_over(&mut mover, dt, &params, frames, Rule::above(-1.0));
                cells.push(Cell {
                    ratio,
                    rate,
                    compliance,
                    energy: found.map_or(f64::INFINITY, |found| found.value),
                });
            }
        }
    }
    Ok(cells)
}

fn run(stage: &mut Stage) -> Result<Worst, Failure> {
    let mut worst = Worst::default();
    let cells = cells(stage)?;
    for cell in &cells {
        worst.judge(Ok(cell.energy), || {
            let rate = 10.0_f64.powf(f64::from(cell.rate) / 2.0);
            format!(
                "1/{rate:.0} s, 1e{} m/N, load {:e}",
                cell.compliance, cell.ratio
            )
        });
    }
    stage.map = Some(cells);
    Ok(worst)
}
