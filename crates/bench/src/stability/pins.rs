//! Pins that leap, turn, come and go, and ask for what cannot be.

use super::audit::{EnergyLaw, Rule, farthest};
use super::case::{Case, Found, Worst, larger};
use super::failure::Failure;
use super::scenes::{FRAME, HANGING, ball, elastic_shell, pose, sheet};
use super::stage::{Mover, Stage};
use incise_mesh::{Vec3, VertexId};
use incise_pbd_gpu::Material;

pub(super) const CASES: [Case; 5] = [
    Case {
        id: "T9",
        torture: "every vertex pinned",
        law: "way of any vertex [m]",
        bound: 0.0,
        run: all_pinned,
    },
    Case {
        id: "T9",
        torture: "a pin leaps 10 m and back every second, then stays",
        law: "mean strain 10 s after",
        bound: 0.05,
        run: leaps,
    },
    Case {
        id: "T9",
        torture: "a pin turns 50 times a second in a circle of 0.2 m",
        law: "reach of the sheet's own",
        bound: 1.05,
        run: turns,
    },
    Case {
        id: "T9",
        torture: "a pin comes and goes every frame",
        law: "energy of what there was",
        bound: 1.01,
        run: comes_and_goes,
    },
    Case {
        id: "contradiction",
        torture: "two pins 10 times as far apart as the sheet is wide, then one let go",
        law: "largest strain 10 s after",
        bound: 0.05,
        run: contradiction,
    },
];

fn materials() -> [(&'static str, Material); 3] {
    [
        ("PBD", Material::default()),
        ("compliance 0", elastic_shell(0.0, 0.0)),
        ("compliance 1e-6", elastic_shell(1e-6, 1e-3)),
    ]
}

/// The upper corners of a sheet of 8 times 8 squares.
const CORNERS: [VertexId; 2] = [VertexId(0), VertexId(8)];

/// A square meter.
fn square<'a>(stage: &'a mut Stage, material: &Material) -> Result<Mover<'a>, Failure> {
    stage.enter(sheet([8, 8], [1.0, 1.0])?, material)
}

fn all_pinned(stage: &mut Stage) -> Result<Worst, Failure> {
    let mut worst = Worst::default();
    for (name, material) in materials() {
        let mut surface = ball(1, 0.0);
        pose(&mut surface, |p| p * 2.0);
        let before = surface.positions.clone();
        let mut mover = stage.enter(surface, &material)?;
        for v in 0..before.len() {
            mover
                .solver
                .pin(&mut mover.surface, VertexId::from_index(v))?;
        }
        let found = mover.advance(FRAME, &HANGING, 100).map(|()| {
            let way = |(a, b): (&[f32; 4], &[f32; 4])| {
                (0..3)
                    .map(|k| f64::from((a[k] - b[k]).abs()))
                    .fold(0.0, larger)
            };
            let pairs = before.iter().zip(&mover.surface.positions);
            pairs.map(way).fold(0.0, larger)
        });
        worst.judge(found, || name.to_owned());
    }
    Ok(worst)
}

fn leaps(stage: &mut Stage) -> Result<Worst, Failure> {
    let mut worst = Worst::default();
    let seconds = stage.pick(2, 10);
    for (name, material) in materials() {
        let mut mover = square(stage, &material)?;
        let mut run = || -> Result<f64, Failure> {
            mover.solver.pin(&mut mover.surface, CORNERS[0])?;
            for second in 0..seconds {
                let x = if second % 2 == 0 { 10.0 } else { 0.0 };
                mover.solver.set_pin_target(CORNERS[0], [x, 0.0, 0.0])?;
                mover.advance(FRAME, &HANGING, 60)?;
            }
            mover.advance(FRAME, &HANGING, 600)?;
            Ok(mover.strain())
        };
        let found = run();
        worst.judge(found, || name.to_owned());
    }
    Ok(worst)
}

fn turns(stage: &mut Stage) -> Result<Worst, Failure> {
    let mut worst = Worst::default();
    // Twelve steps a turn: in frames of 60 a second it would seem to turn the other way.
    const STEP: f32 = 1.0 / 600.0;
    const RADIUS: f32 = 0.2;
    let steps: u16 = stage.pick(600, 6000);
    for (name, material) in materials() {
        let mut mover = square(stage, &material)?;
        // From the circle's middle along the circle and the sheet's diagonal.
        let reach = f64::from(RADIUS) * 2.0 + 2.0_f64.sqrt();
        let mut run = || -> Result<f64, Failure> {
            let mut most: f64 = 0.0;
            mover.solver.pin(&mut mover.surface, CORNERS[0])?;
            for step in 0..steps {
                let turn = std::f32::consts::TAU * 50.0 * f32::from(step) * STEP;
                let target = [RADIUS * (turn.cos() - 1.0), RADIUS * turn.sin(), 0.0];
                mover.solver.set_pin_target(CORNERS[0], target)?;
                mover.step(STEP, &HANGING)?;
                most = most.max(farthest(&mover.surface) / reach);
            }
            Ok(most)
        };
        let found = run();
        worst.judge(found, || name.to_owned());
    }
    Ok(worst)
}

fn comes_and_goes(stage: &mut Stage) -> Result<Worst, Failure> {
    let mut worst = Worst::default();
    let frames = stage.pick(60, 600);
    for (name, material) in materials() {
        let mut mover = square(stage, &material)?;
        let mut run = || -> Result<Found, Failure> {
            pose(&mut mover.surface, |p| Vec3::new(p.x, 0.0, p.y));
            mover.moved()?;
            mover.solver.pin(&mut mover.surface, CORNERS[0])?;
            // A corner that is let go falls, and where it is held next time it hangs lower.
            let mut law = EnergyLaw::start(&mover, &HANGING, Rule::above(-2.0).within(3.0));
            for frame in 0..frames {
                if frame % 2 == 0 {
                    mover.solver.pin(&mut mover.surface, CORNERS[1])?;
                } else {
                    mover.solver.unpin(&mut mover.surface, CORNERS[1])?;
                }
                mover.step(FRAME, &HANGING)?;
                law.look(&mover, &HANGING);
            }
            Ok(law.found())
        };
        let found = run();
        worst.judge(found, || name.to_owned());
    }
    Ok(worst)
}

fn contradiction(stage: &mut Stage) -> Result<Worst, Failure> {
    let mut worst = Worst::default();
    for (name, material) in materials() {
        let mut mover = square(stage, &material)?;
        let mut run = || -> Result<f64, Failure> {
            for v in CORNERS {
                mover.solver.pin(&mut mover.surface, v)?;
            }
            mover.solver.set_pin_target(CORNERS[1], [10.0, 0.0, 0.0])?;
            mover.advance(FRAME, &HANGING, 600)?;
            mover.solver.unpin(&mut mover.surface, CORNERS[1])?;
            mover.advance(FRAME, &HANGING, 600)?;
            Ok(mover.largest_strain())
        };
        let found = run();
        worst.judge(found, || name.to_owned());
    }
    Ok(worst)
}
