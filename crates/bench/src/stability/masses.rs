//! Loads a million times as heavy as what they hang on, and bodies next to weightless.

use super::audit::energy_over;
use super::case::{Case, Worst};
use super::failure::Failure;
use super::scenes::{FRAME, HANGING, elastic_shell, pose, sheet};
use super::stage::{Mover, Stage};
use incise_mesh::{Vec3, VertexId};
use incise_pbd_gpu::{Density, Material};

pub(super) const CASES: [Case; 3] = [
    Case {
        id: "T3",
        torture: "load on a swinging ribbon, 1 to 1e6 times a vertex",
        law: "energy of what there was",
        bound: 1.01,
        run: loads,
    },
    Case {
        id: "T3",
        torture: "load on a hanging ribbon, 1 to 1e6 times a vertex",
        law: "mean strain after 10 s",
        bound: 0.05,
        run: stretched_by_loads,
    },
    Case {
        id: "T3",
        torture: "shells of 1e-9 to 1e6 kg/m^2",
        law: "energy of what there was",
        bound: 1.01,
        run: densities,
    },
];

/// Squares of the ribbon, from its pinned end to its load.
const SQUARES: u32 = 10;

/// A ribbon of a meter that hangs by its upper end, level at first if it is to swing, with a load at its
/// lower end: each of the two vertices there is so many times as heavy as a vertex inside.
pub(super) fn ribbon<'a>(
    stage: &'a mut Stage,
    material: &Material,
    ratio: f32,
    level: bool,
) -> Result<Mover<'a>, Failure> {
    let mut surface = sheet([1, SQUARES], [0.1, 1.0])?;
    if level {
        pose(&mut surface, |p| Vec3::new(p.x, 0.0, p.y));
    }
    let mut solver = incise_pbd_gpu::Solver::new(&mut surface, material)?;
    for v in [0, 1].map(VertexId) {
        solver.pin(&mut surface, v)?;
    }
    let inside = solver.masses()[SQUARES as usize];
    for v in [2 * SQUARES, 2 * SQUARES + 1].map(VertexId) {
        solver.set_mass(&mut surface, v, inside * ratio)?;
    }
    stage.enter_with(surface, solver)
}

fn materials() -> [(&'static str, Material); 3] {
    [
        ("PBD", Material::default()),
        ("compliance 0", elastic_shell(0.0, 0.1)),
        ("compliance 1e-6", elastic_shell(1e-6, 0.1)),
    ]
}

fn ratios(stage: &Stage) -> &'static [f32] {
    stage.pick(&[1.0, 1e6], &[1.0, 10.0, 1e2, 1e3, 1e4, 1e5, 1e6])
}

fn loads(stage: &mut Stage) -> Result<Worst, Failure> {
    let mut worst = Worst::default();
    let frames = stage.pick(120, 600);
    for &ratio in ratios(stage) {
        for (name, material) in materials() {
            let mut mover = ribbon(stage, &material, ratio, true)?;
            let found = energy_over(&mut mover, FRAME, &HANGING, frames, -1.0);
            worst.judge(found, || format!("{ratio:e}, {name}"));
        }
    }
    Ok(worst)
}

fn stretched_by_loads(stage: &mut Stage) -> Result<Worst, Failure> {
    let mut worst = Worst::default();
    for &ratio in ratios(stage) {
        for (name, material) in materials() {
            // A soft ribbon is right to stretch under a load.
            if name == "compliance 1e-6" {
                continue;
            }
            let mut mover = ribbon(stage, &material, ratio, false)?;
            let found = mover.advance(FRAME, &HANGING, 600);
            let found = found.map(|()| mover.strain());
            worst.judge(found, || format!("{ratio:e}, {name}"));
        }
    }
    Ok(worst)
}

fn densities(stage: &mut Stage) -> Result<Worst, Failure> {
    let mut worst = Worst::default();
    for exponent in (-9..=6).step_by(stage.pick(15, 3)) {
        for (name, material) in materials() {
            let density = Density::Area(10.0_f32.powi(exponent));
            let material = Material {
                density,
                ..material
            };
            let mut mover = ribbon(stage, &material, 1.0, true)?;
            let found = energy_over(&mut mover, FRAME, &HANGING, 240, -1.0);
            worst.judge(found, || format!("1e{exponent} kg/m^2, {name}"));
        }
    }
    Ok(worst)
}
