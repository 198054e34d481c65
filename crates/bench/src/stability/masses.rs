//! Loads of up to a million times a vertex's mass.

use super::case::{Case, Worst};
use super::energy::{Limits, energy_over, within_limits};
use super::error::StressError;
use super::runner::{Body, Runner};
use super::scenes::{FRAME, HANGING, elastic_shell, pose};
use incise_mesh::{Vec3, VertexId};
use incise_models::sheet;
use incise_pbd_gpu::{Material, Solver};

pub(super) const CASES: [Case; 2] = [
    Case {
        id: "T3",
        stress: "load on a swinging ribbon, 1 to 1e6 times a vertex",
        invariant: "largest energy, relative to the start",
        bound: 1.01,
        run: loads,
    },
    Case {
        id: "T3",
        stress: "load on a hanging ribbon, 1 to 1e6 times a vertex",
        invariant: "mean strain after 10 s",
        bound: 0.05,
        run: stretched_by_loads,
    },
];

/// Squares of the ribbon, from its pinned end to its load.
const SQUARES: u32 = 10;

/// A ribbon of a meter pinned at its upper end, level if it is to swing. The two vertices of its
/// lower end have `ratio` times the mass of a vertex inside.
pub(super) fn ribbon<'a>(
    runner: &'a mut Runner,
    material: &Material,
    ratio: f32,
    level: bool,
) -> Result<Body<'a>, StressError> {
    let mut surface = sheet([1, SQUARES], [0.1, 1.0]);
    if level {
        pose(&mut surface, |p| Vec3::new(p.x, 0.0, p.y));
    }
    let mut solver = Solver::new(&mut surface, material)?;
    for v in [0, 1].map(VertexId) {
        solver.pin(&mut surface, v)?;
    }
    let inside = solver.masses()[SQUARES as usize];
    for v in [2 * SQUARES, 2 * SQUARES + 1].map(VertexId) {
        solver.set_mass(&mut surface, v, inside * ratio)?;
    }
    runner.enter_with(surface, solver)
}

fn materials() -> [(&'static str, Material); 3] {
    [
        ("PBD", Material::default()),
        ("compliance 0", elastic_shell(0.0, 0.1)),
        ("compliance 1e-6", elastic_shell(1e-6, 0.1)),
    ]
}

fn ratios(runner: &Runner) -> &'static [f32] {
    runner.pick(&[1.0, 1e6], &[1.0, 10.0, 1e2, 1e3, 1e4, 1e5, 1e6])
}

fn loads(runner: &mut Runner) -> Result<Worst, StressError> {
    let mut worst = Worst::default();
    let frames = runner.pick(120, 600);
    for &ratio in ratios(runner) {
        for (name, material) in materials() {
            let mut body = ribbon(runner, &material, ratio, true)?;
            // A soft ribbon is right to stretch under a load.
            let is_rigid = name != "compliance 1e-6";
            let limits = Limits::above(-1.0).within(10.0).recovering_if(is_rigid);
            let outcome = energy_over(&mut body, FRAME, &HANGING, frames, limits);
            worst.judge(outcome, || format!("{ratio:e}, {name}"));
        }
    }
    Ok(worst)
}

fn stretched_by_loads(runner: &mut Runner) -> Result<Worst, StressError> {
    let mut worst = Worst::default();
    for &ratio in ratios(runner) {
        for (name, material) in materials() {
            // A soft ribbon is right to stretch under a load.
            if name == "compliance 1e-6" {
                continue;
            }
            let mut body = ribbon(runner, &material, ratio, false)?;
            let limits = Limits::above(-2.0).within(2.0);
            let outcome = within_limits(&mut body, FRAME, &HANGING, 600, limits);
            let outcome = outcome.map(|outcome| outcome.by(body.strain()));
            worst.judge(outcome, || format!("{ratio:e}, {name}"));
        }
    }
    Ok(worst)
}
