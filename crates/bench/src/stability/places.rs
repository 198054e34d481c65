//! Bodies of millimeters and kilometers, next to the origin and far off, and numbers at the end of their range.

use super::alike::apart;
use super::audit::{Rule, energy_over, keeping};
use super::case::{Case, Found, Worst, larger};
use super::failure::Failure;
use super::scenes::{FRAME, GROUND, HANGING, ball, elastic_shell, place};
use super::stage::Stage;
use incise_mesh::{Vec3, VertexId, icosphere};
use incise_pbd_gpu::{Material, SolverParams, Stiffness};

pub(super) const CASES: [Case; 4] = [
    Case {
        id: "T8",
        torture: "bodies of 1 mm to 1 km",
        law: "energy of what there was",
        bound: 1.01,
        run: scales,
    },
    Case {
        id: "T8",
        torture: "fall of 1 s at 1 to 100 m from the origin, 60 and 1200 substeps a second",
        law: "relative error of the way",
        bound: 1e-3,
        run: near,
    },
    Case {
        id: "T8",
        torture: "the same at 1e4 and 1e6 m",
        law: "relative error of the way",
        bound: 1e-3,
        run: far,
    },
    Case {
        id: "T19",
        torture: "compliances of 1e-38 and below normal numbers",
        law: "way from the body of compliance 0 [m]",
        bound: 1e-6,
        run: subnormal,
    },
];

fn scales(stage: &mut Stage) -> Result<Worst, Failure> {
    let mut worst = Worst::default();
    let frames = stage.pick(300, 600);
    for exponent in (-3..=3).step_by(stage.pick(3, 1)) {
        let scale = 10.0_f64.powi(exponent);
        for (name, material) in [
            ("PBD", Material::default()),
            ("compliance 0", elastic_shell(0.0, 0.0)),
            ("compliance 1e-5", elastic_shell(1e-5, 1e-2)),
        ] {
            let mut surface = ball(1, 0.6);
            place(&mut surface, |p| p * scale);
            let mut mover = stage.enter(surface, &material)?;
            let rule = Rule::above(0.0).within(5.0 * scale).recovering();
            let found = energy_over(&mut mover, FRAME, &GROUND, frames, rule);
            worst.judge(found, || format!("1e{exponent} m, {name}"));
        }
    }
    Ok(worst)
}

/// The error of a free fall, relative to its way: the law of the steps themselves, `n (n + 1) / 2` times
/// `g h^2` after n of them.
fn fall(stage: &mut Stage, distance: f64, substeps: u32) -> Result<f64, Failure> {
    let mut surface = icosphere(0, 0.5);
    place(&mut surface, |p| p + Vec3::repeat(distance));
    let start: Vec<f64> = surface.positions.iter().map(|p| p[1].into()).collect();
    let mut mover = stage.enter(surface, &elastic_shell(1e3, 1e3))?;
    let params = SolverParams {
        iterations: 1,
        substeps,
        ..HANGING
    };
    mover.advance(FRAME, &params, 60)?;
    let (n, h) = (
        60.0 * f64::from(substeps),
        f64::from(FRAME) / f64::from(substeps),
    );
    let way = 9.81 * h * h * n * (n + 1.0) / 2.0;
    let fallen = |v: VertexId| start[v.index()] - mover.surface.position(v).y;
    let all = mover.surface.topology().vertices();
    Ok(all.map(|v| (fallen(v) / way - 1.0).abs()).fold(0.0, larger))
}

fn falls(stage: &mut Stage, distances: &[f64]) -> Result<Worst, Failure> {
    let mut worst = Worst::default();
    for &distance in distances {
        for substeps in [1, 20] {
            let found = fall(stage, distance, substeps);
            worst.judge(found, || {
                format!("{distance:e} m, {} substeps a second", 60 * substeps)
            });
        }
    }
    Ok(worst)
}

fn near(stage: &mut Stage) -> Result<Worst, Failure> {
    falls(stage, &[1.0, 10.0, 100.0])
}

fn far(stage: &mut Stage) -> Result<Worst, Failure> {
    falls(stage, &[1e4, 1e6])
}

fn subnormal(stage: &mut Stage) -> Result<Worst, Failure> {
    let mut worst = Worst::default();
    let mut dropped = |stretch: f32| -> Result<(Vec<[f32; 4]>, Found), Failure> {
        let material = Material {
            stretch: Stiffness::Compliance(stretch),
            bending: None,
            ..Material::default()
        };
        let mut mover = stage.enter(ball(1, 0.6), &material)?;
        let rule = Rule::above(0.0).within(3.0);
        let kept = keeping(&mut mover, FRAME, &GROUND, 60, rule)?;
        Ok((mover.surface.positions.clone(), kept))
    };
    let (rigid, _) = dropped(0.0)?;
    for compliance in [1e-36, 1e-38, 1e-40, 1e-45_f32] {
        let found = dropped(compliance).map(|(soft, kept)| kept.by(apart(&rigid, &soft)));
        worst.judge(found, || format!("{compliance:e} m/N"));
    }
    Ok(worst)
}
