//! Loads a million times as heavy as what they hang on, and bodies next to weightless.

use super::audit::{Rule, energy_over, keeping};
use super::case::{Case, Worst};
use super::failure::Failure;
use super::scenes::{FRAME, GROUND, HANGING, ball, elastic_shell, pose, sheet};
use super::stage::{Mover, Stage};
use incise_mesh::{Vec3, VertexId};
use incise_pbd_gpu::{Density, Material, Solver};

pub(super) const CASES: [Case; 4] = [
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
    Case {
        id: "T3",
        torture: "single vertices of 1e-3 to 1e-6 of the others' mass, in a swinging ribbon and a dropped ball",
        law: "energy of what there was",
        bound: 1.01,
        run: light_points,
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
    let mut solver = Solver::new(&mut surface, material)?;
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
            // A soft ribbon is right to stretch under a load.
            let is_rigid = name != "compliance 1e-6";
            let rule = Rule::above(-1.0).within(10.0).recovering_if(is_rigid);
            let found = energy_over(&mut mover, FRAME, &HANGING, frames, rule);
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
            let rule = Rule::above(-2.0).within(2.0);
            let found = keeping(&mut mover, FRAME, &HANGING, 600, rule);
            let found = found.map(|found| found.by(mover.strain()));
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
            let found = energy_over(
                &mut mover,
                FRAME,
                &HANGING,
                240,
                Rule::above(-1.0).within(20.0),
            );
            worst.judge(found, || format!("1e{exponent} kg/m^2, {name}"));
        }
    }
    Ok(worst)
}

fn light_points(stage: &mut Stage) -> Result<Worst, Failure> {
    let mut worst = Worst::default();
    let frames = stage.pick(60, 600);
    let shares: &[f32] = stage.pick(&[1e-6], &[1e-3, 1e-4, 1e-5, 1e-6]);
    for &share in shares {
        for (name, material) in materials() {
            for place in ["ribbon's edge", "ribbon's end", "ball"] {
                let mut surface = if place == "ball" {
                    ball(1, 0.55)
                } else {
                    sheet([1, SQUARES], [0.1, 1.0])?
                };
                let (params, v, rule) = match place {
                    "ball" => (GROUND, 20, Rule::above(0.0).within(3.0)),
                    "ribbon's edge" => (HANGING, SQUARES, Rule::above(-1.0).within(2.0)),
                    _ => (HANGING, 2 * SQUARES + 1, Rule::above(-1.0).within(2.0)),
                };
                if params == HANGING {
                    pose(&mut surface, |p| Vec3::new(p.x, 0.0, p.y));
                }
                let mut solver = Solver::new(&mut surface, &material)?;
                if params == HANGING {
                    for v in [0, 1].map(VertexId) {
                        solver.pin(&mut surface, v)?;
                    }
                }
                let v = VertexId(v);
                let mass = solver.masses()[v.index()];
                solver.set_mass(&mut surface, v, share * mass)?;
                let mut mover = stage.enter_with(surface, solver)?;
                let rule = rule.recovering();
                let found = energy_over(&mut mover, FRAME, &params, frames, rule);
                worst.judge(found, || format!("{place}, {share:e}, {name}"));
            }
        }
    }
    Ok(worst)
}
