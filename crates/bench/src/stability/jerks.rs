//! Parameters that change from one frame to the next.

use super::audit::{EnergyLaw, Rule, mechanical};
use super::case::{Case, Found, Worst};
use super::failure::Failure;
use super::fuzz::log;
use super::scenes::{FRAME, GROUND, WEIGHTLESS, ball, elastic_shell};
use super::stage::Stage;
use crate::directions::Directions;
use incise_pbd_gpu::{Material, SolverParams, Stiffness};

pub(super) const CASES: [Case; 3] = [
    Case {
        id: "T11",
        torture: "compliance of stretch changes a million times, every 10 frames",
        law: "energy of what there was after the change",
        bound: 1.01,
        run: compliance,
    },
    Case {
        id: "T11",
        torture: "gravity turns over every 7 frames",
        law: "energy of what there was and was put in",
        bound: 1.01,
        run: gravity,
    },
    Case {
        id: "T11",
        torture: "time steps from 1/600 to 1/60 s at random",
        law: "energy of what there was",
        bound: 1.01,
        run: time_steps,
    },
];

fn compliance(stage: &mut Stage) -> Result<Worst, Failure> {
    let mut worst = Worst::default();
    let frames = stage.pick(60, 600);
    for soft in [1.0_f32, 1e-2, 1e-4] {
        let stiffness = |stiff: bool| if stiff { soft * 1e-6 } else { soft };
        let mut mover = stage.enter(ball(1, 0.6), &elastic_shell(soft, 1e-2))?;
        let mut run = || -> Result<Found, Failure> {
            let mut law = EnergyLaw::start(&mover, &GROUND, Rule::above(0.0));
            let mut most = law.found();
            for frame in 0..frames {
                if frame % 10 == 0 {
                    let now = stiffness(frame / 10 % 2 == 1);
                    mover.solver.set_stretch(Stiffness::Compliance(now))?;
                    // A change puts energy in or takes it out: what there is after it is all that there is.
                    law = EnergyLaw::start(&mover, &GROUND, Rule::above(0.0));
                }
                mover.step(FRAME, &GROUND)?;
                law.look(&mover, &GROUND);
                most = most.worse(law.found());
            }
            Ok(most)
        };
        let found = run();
        worst.judge(found, || format!("{soft:e} m/N and a millionth"));
    }
    Ok(worst)
}

fn gravity(stage: &mut Stage) -> Result<Worst, Failure> {
    let mut worst = Worst::default();
    let frames = stage.pick(60, 600);
    for (name, material) in [
        ("PBD", Material::default()),
        ("compliance 1e-5", elastic_shell(1e-5, 1e-2)),
    ] {
        let mut mover = stage.enter(ball(1, 0.6), &material)?;
        let mut run = || -> Result<Found, Failure> {
            let weight = |up: bool| SolverParams {
                gravity: [0.0, if up { 9.81 } else { -9.81 }, 0.0],
                ..GROUND
            };
            let mut params = weight(false);
            let mut law = EnergyLaw::start(&mover, &params, Rule::above(0.0).within(20.0));
            for frame in 0..frames {
                let turned = weight(frame / 7 % 2 == 1);
                let of = |p: &SolverParams| mechanical(&mover.surface, &mover.solver, p, 0.0);
                // What is above the ground gains by a turn downward what it lost by that upward.
                law.add_work(of(&turned) - of(&params));
                params = turned;
                mover.step(FRAME, &params)?;
                law.look(&mover, &params);
            }
            Ok(law.found())
        };
        let found = run();
        worst.judge(found, || name.to_owned());
    }
    Ok(worst)
}

fn time_steps(stage: &mut Stage) -> Result<Worst, Failure> {
    let mut worst = Worst::default();
    let frames = stage.pick(60, 600);
    let mut directions = Directions(11);
    for (name, material) in [
        ("PBD", Material::default()),
        ("compliance 1e-3", elastic_shell(1e-3, 1e-1)),
        ("compliance 1e-5", elastic_shell(1e-5, 1e-2)),
    ] {
        for params in [GROUND, WEIGHTLESS] {
            let mut mover = stage.enter(ball(1, 0.6), &material)?;
            // In a body without weight it is strain that moves.
            if params == WEIGHTLESS {
                super::scenes::pose(&mut mover.surface, |p| p * 1.2);
                mover.moved()?;
            }
            let mut run = || -> Result<Found, Failure> {
                let mut law = EnergyLaw::start(&mover, &params, Rule::above(0.0).within(5.0));
                for _ in 0..frames {
                    let dt = log(&mut directions, 1.0 / 600.0, 1.0 / 60.0);
                    mover.step(dt, &params)?;
                    law.look(&mover, &params);
                }
                Ok(law.found())
            };
            // There is no energy to compare with in a body that does not stretch.
            if params == WEIGHTLESS && name == "PBD" {
                continue;
            }
            let found = run();
            worst.judge(found, || format!("{name}, gravity {}", params.gravity[1]));
        }
    }
    Ok(worst)
}
