//! Any time step and any stiffness.

use super::audit::{Rule, energy_over};
use super::case::{Case, Found, Worst};
use super::failure::Failure;
use super::scenes::{GROUND, ball, elastic_shell, materials};
use super::stage::Stage;
use incise_pbd_gpu::{Material, SolverParams};

pub(super) const CASES: [Case; 2] = [
    Case {
        id: "T1",
        torture: "time step 1/15 to 1/60000 s",
        law: "energy of what there was",
        bound: 1.01,
        run: time_steps,
    },
    Case {
        id: "T2",
        torture: "compliance 0, 1e-12 to 1e2",
        law: "energy of what there was",
        bound: 1.01,
        run: compliances,
    },
];

/// Drops a ball so that it soon meets the ground; the largest energy of what there was.
fn dropped(
    stage: &mut Stage,
    material: &Material,
    dt: f32,
    params: &SolverParams,
    frames: u32,
    recovers: bool,
) -> Result<Found, Failure> {
    let mut mover = stage.enter(ball(1, 0.55), material)?;
    let rule = Rule::above(0.0).within(3.0).recovering_if(recovers);
    energy_over(&mut mover, dt, params, frames, rule)
}

fn time_steps(stage: &mut Stage) -> Result<Worst, Failure> {
    let mut worst = Worst::default();
    let rates: &[f32] = stage.pick(
        &[15.0, 240.0],
        &[15.0, 30.0, 60.0, 240.0, 1000.0, 6000.0, 60_000.0],
    );
    for &rate in rates {
        // Half a second, which holds the impact, or what fits.
        let frames = stage.pick(80, if rate > 6000.0 { 12_000 } else { 3000 });
        for (name, material) in materials() {
            for iterations in [1, 10] {
                let params = SolverParams {
                    iterations,
                    ..GROUND
                };
                let found = dropped(stage, &material, 1.0 / rate, &params, frames, true);
                worst.judge(found, || {
                    format!("1/{rate} s, {name}, {iterations} iterations")
                });
            }
        }
    }
    Ok(worst)
}

fn compliances(stage: &mut Stage) -> Result<Worst, Failure> {
    let mut worst = Worst::default();
    let exponents = (-12..=2).step_by(stage.pick(4, 1));
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
            for (iterations, substeps, own_weight) in ways {
                let params = SolverParams {
                    iterations,
                    substeps,
                    own_weight,
                    ..GROUND
                };
                let material = elastic_shell(stretch, bending);
                let frames = stage.pick(40, 300);
                let found = dropped(stage, &material, 1.0 / 60.0, &params, frames, false);
                worst.judge(found, || {
                    format!("{stretch:e} m/N, {bending:e} rad/(N m), {iterations} x {substeps}, own weight {own_weight}")
                });
            }
        }
    }
    Ok(worst)
}
