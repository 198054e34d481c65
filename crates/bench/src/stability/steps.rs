//! Time steps and compliances of a ball that drops on the ground.

use super::case::{Case, Outcome, Worst};
use super::energy::{Limits, energy_over};
use super::error::StressError;
use super::runner::Runner;
use super::scenes::{GROUND, ball, elastic_shell, materials};
use incise_pbd_gpu::{Material, SolverParams};

pub(super) const CASES: [Case; 2] = [
    Case {
        id: "T1",
        stress: "time step 1/15 to 1/60000 s",
        invariant: "largest energy, relative to the start",
        bound: 1.01,
        run: time_steps,
    },
    Case {
        id: "T2",
        stress: "compliance 0, 1e-12 to 1e2",
        invariant: "largest energy, relative to the start",
        bound: 1.01,
        run: compliances,
    },
];

/// Drops a ball onto the ground and returns its largest relative energy.
fn dropped(
    runner: &mut Runner,
    material: &Material,
    dt: f32,
    params: &SolverParams,
    frames: u32,
    recovers: bool,
) -> Result<Outcome, StressError> {
    let mut body = runner.enter(ball(1, 0.55), material)?;
    let limits = Limits::above(0.0).within(3.0).recovering_if(recovers);
    energy_over(&mut body, dt, params, frames, limits)
}

fn time_steps(runner: &mut Runner) -> Result<Worst, StressError> {
    let mut worst = Worst::default();
    let rates: &[f32] = runner.pick(
        &[15.0, 240.0],
        &[15.0, 30.0, 60.0, 240.0, 1000.0, 6000.0, 60_000.0],
    );
    for &rate in rates {
        // Half a second, which holds the impact, or what fits.
        let frames = runner.pick(80, if rate > 6000.0 { 12_000 } else { 3000 });
        for (name, material) in materials() {
            for iterations in [1, 10] {
                let params = SolverParams {
                    iterations,
                    ..GROUND
                };
                let outcome = dropped(runner, &material, 1.0 / rate, &params, frames, true);
                worst.judge(outcome, || {
                    format!("1/{rate} s, {name}, {iterations} iterations")
                });
            }
        }
    }
    Ok(worst)
}

fn compliances(runner: &mut Runner) -> Result<Worst, StressError> {
    let mut worst = Worst::default();
    let exponents = (-12..=2).step_by(runner.pick(4, 1));
    let all: Vec<f32> = (std::iter::once(0.0))
        .chain(exponents.map(|e| 10.0_f32.powi(e)))
        .collect();
    let ways = [
        (1, 1, 0.5),
        (10, 1, 0.5),
        (1, 10, 0.5),
        (1, 16, 0.5),
        (10, 1, 1.0),
        (1, 10, 1.0),
    ];
    for &stretch in &all {
        for bending in [stretch, 1e-8 / stretch.max(1e-12), 1e-4, 1e-2] {
            for (iterations, substeps, diagonal_scale) in ways {
                let params = SolverParams {
                    iterations,
                    substeps,
                    diagonal_scale,
                    ..GROUND
                };
                let material = elastic_shell(stretch, bending);
                let frames = runner.pick(40, 300);
                let outcome = dropped(runner, &material, 1.0 / 60.0, &params, frames, false);
                worst.judge(outcome, || {
                    format!(
                        "{stretch:e} m/N, {bending:e} rad/(N m), {iterations} x {substeps}, \
                         diagonal scale {diagonal_scale}"
                    )
                });
            }
        }
    }
    Ok(worst)
}
