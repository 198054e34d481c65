//! Bodies that keep their volumes: at rest, cut, and under changing pressure.

use super::case::{Case, Outcome, Worst, larger};
use super::cuts::{cut_largest, pieces};
use super::energy::{Limits, energy_watched};
use super::error::StressError;
use super::runner::{Body, Runner};
use super::scenes::{FRAME, GROUND, WEIGHTLESS, ball, materials, shift, whole};
use crate::directions::Directions;
use incise_cut::Cutter;
use incise_mesh::{Surface, Vec3};
use incise_models::{Model, build_model};
use incise_pbd_gpu::{Material, PieceVolume, SolverParams, Stiffness, Volume};

pub(super) const CASES: [Case; 6] = [
    Case {
        id: "volume",
        stress: "a ball, a bunny and an armadillo with volume constraints on the ground for 15 s",
        invariant: "relative volume error of a piece in the last second",
        bound: 0.01,
        run: |runner| at_rest(runner, &GROUND),
    },
    Case {
        id: "volume",
        stress: "the same, cut twice",
        invariant: "relative volume error of a piece in the last second",
        bound: 0.01,
        run: |runner| cut_twice(runner, &GROUND),
    },
    Case {
        id: "volume",
        stress: "the same with the default substeps",
        invariant: "relative volume error of a piece in the last second",
        bound: 0.01,
        run: |runner| at_rest(runner, &SUBSTEPS),
    },
    Case {
        id: "volume",
        stress: "the same with the default substeps, cut twice",
        invariant: "relative volume error of a piece in the last second",
        bound: 0.01,
        run: |runner| cut_twice(runner, &SUBSTEPS),
    },
    Case {
        id: "T10",
        stress: "pressure that changes between 0 and 100 volumes in a ball on the ground",
        invariant: "distance of a vertex from the middle, in radii of the largest volume so far",
        bound: 2.0,
        run: pressure,
    },
    Case {
        id: "T10",
        stress: "the same in a weightless ball without stiffness",
        invariant: "relative volume error before the next change",
        bound: 0.01,
        run: pressure_alone,
    },
];

/// Of balls \[m\].
const RADIUS: f64 = 0.5;
/// Sequence of pressures in rest volumes, with small and large steps.
const PRESSURES: [f32; 11] = [0.0, 0.1, 1.0, 5.0, 100.0, 1.0, 100.0, 0.0, 5.0, 0.1, 1.0];
/// Largest rate of volume change of an incompressible piece, as in the solver [1/s].
const SPEED: f32 = 3.0;
/// Time to settle after a change \[s\].
const SETTLING: f32 = 2.0;
/// Frames per second.
const SECOND: u32 = 60;
/// Shells with volume constraints.
fn kept() -> [(&'static str, Material); 3] {
    materials().map(|(name, material)| (name, with(material, Volume::default())))
}

fn with(material: Material, volume: Volume) -> Material {
    Material {
        volume: Some(volume),
        ..material
    }
}

fn asking(pressure: f32) -> Volume {
    Volume {
        pressure,
        ..Volume::default()
    }
}

/// Returns the largest relative error of a piece's volume.
///
/// # Errors
/// [`StressError::Invariant`] for a piece without a constraint.
fn error(body: &Body<'_>) -> Result<f64, StressError> {
    let volumes = body.surface.piece_volumes();
    let (all, kept) = (pieces(&body.surface), body.solver.volumes().pieces());
    if !kept.iter().map(PieceVolume::piece).eq(all.iter().copied()) {
        let why = format!("{} constraints for {} pieces", kept.len(), all.len());
        return Err(StressError::Invariant(why));
    }
    let off = |piece: &PieceVolume| {
        let is = volumes[piece.piece() as usize];
        (is / f64::from(piece.rest()) - 1.0).abs()
    };
    Ok(kept.iter().map(off).fold(0.0, larger))
}

/// Returns the largest distance of a vertex from the middle of the body's box \[m\].
fn spread(surface: &Surface) -> f64 {
    let middle = surface.bounds().center();
    let all = surface.topology().vertices();
    all.map(|v| (surface.position(v) - middle).norm())
        .fold(0.0, larger)
}

/// Runs every model as every shell.
fn bodies(
    runner: &mut Runner,
    judge: impl Fn(&mut Body<'_>) -> Result<Outcome, StressError>,
) -> Result<Worst, StressError> {
    let mut worst = Worst::default();
    let all = [Model::Sphere768, Model::Bunny, Model::Armadillo];
    for &model in runner.pick(&all[..2], &all) {
        let mut surface = build_model(model);
        let lift = -f64::from(surface.bounds().min[1]);
        shift(&mut surface, Vec3::new(0.0, lift, 0.0));
        for (name, material) in kept() {
            let mut body = runner.enter(surface.clone(), &material)?;
            let outcome = judge(&mut body);
            worst.judge(outcome, || format!("{}, {name}", model.name()));
        }
    }
    Ok(worst)
}

/// The solver's default substeps, on the ground.
const SUBSTEPS: SolverParams = SolverParams {
    iterations: 1,
    substeps: 16,
    ..GROUND
};

/// Limits of a body on the ground.
const LYING: Limits = Limits::above(0.0).within(5.0).recovering();

/// Steps a body on the ground; returns its energy and the largest volume error of the last second.
fn lies(
    body: &mut Body<'_>,
    params: &SolverParams,
    frames: u32,
) -> Result<(Outcome, f64), StressError> {
    let mut most = 0.0;
    let outcome = energy_watched(body, (FRAME, params), frames, LYING, |body, frame| {
        if frame + SECOND >= frames {
            most = larger(most, error(body)?);
        }
        Ok(())
    })?;
    Ok((outcome, most))
}

fn at_rest(runner: &mut Runner, params: &SolverParams) -> Result<Worst, StressError> {
    let frames = SECOND * runner.pick(3, 15);
    bodies(runner, |body| {
        let (found, most) = lies(body, params, frames)?;
        Ok(found.with_energy().by(most))
    })
}

fn cut_twice(runner: &mut Runner, params: &SolverParams) -> Result<Worst, StressError> {
    let third = SECOND * runner.pick(2, 5);
    bodies(runner, |body| {
        let mut cutter = Cutter::new(&body.surface);
        let mut directions = Directions(23);
        for _ in 0..2 {
            body.advance(FRAME, params, third)?;
            cut_largest(body, &mut cutter, &mut directions)?;
        }
        // A deformed body regains volume after a cut, so its energy is not limited.
        let (found, most) = lies(body, params, third)?;
        Ok(found.by(most))
    })
}

/// Sets one pressure after the other; calls `watch` after every frame with the pressure and
/// whether it is the last frame before the next change.
fn leaps(
    body: &mut Body<'_>,
    params: &SolverParams,
    mut watch: impl FnMut(&Body<'_>, f32, bool),
) -> Result<(), StressError> {
    let mut before = 1.0;
    for next in PRESSURES {
        let volume = Some(asking(next));
        body.solver.set_volume(&body.surface, volume)?;
        let frames = whole(((next - before).abs() / SPEED + SETTLING) / FRAME);
        for frame in 1..=frames {
            body.step(FRAME, params)?;
            watch(body, next, frame == frames);
        }
        before = next;
    }
    Ok(())
}

fn pressure(runner: &mut Runner) -> Result<Worst, StressError> {
    let mut worst = Worst::default();
    let subdivisions = runner.pick(1, 3);
    for (name, material) in kept() {
        let mut body = runner.enter(ball(subdivisions, RADIUS), &material)?;
        let (mut most, mut largest) = (0.0, 1.0_f32);
        let moved = leaps(&mut body, &GROUND, |body, asked, _| {
            largest = largest.max(asked);
            let radius = RADIUS * f64::from(largest).cbrt();
            most = larger(most, spread(&body.surface) / radius);
        });
        worst.judge(moved.map(|()| most), || name.to_owned());
    }
    Ok(worst)
}

fn pressure_alone(runner: &mut Runner) -> Result<Worst, StressError> {
    let mut worst = Worst::default();
    let limp = Material {
        stretch: Stiffness::Pbd(0.0),
        bending: None,
        ..Material::default()
    };
    let surface = ball(runner.pick(1, 3), 0.0);
    let rest = surface.volume();
    let mut body = runner.enter(surface, &with(limp, Volume::default()))?;
    let moved = leaps(&mut body, &WEIGHTLESS, |body, asked, is_last| {
        if is_last {
            let asked = f64::from(asked);
            let off = (body.surface.volume() / rest - asked).abs();
            worst.judge(Ok(off / asked.max(1.0)), || format!("{asked} volumes"));
        }
    });
    if let Err(error) = moved {
        worst.judge(Err::<f64, _>(error), || "on the way".to_owned());
    }
    Ok(worst)
}
