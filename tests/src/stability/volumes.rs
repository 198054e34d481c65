//! Bodies that keep their volumes: at rest, cut, and under changing pressure.

use super::cuts::cut_largest;
use super::group::{pieces, volume_errors};
use super::motions::{ball, whole};
use super::runner::{Body, Runner};
use super::{Case, Found, Outcome, Run, larger};
use incise_cut::Cutter;
use incise_mesh::Vec3;
use incise_models::scenes::{Directions, FRAME};
use incise_models::{Model, build_model, place};
use incise_pbd_gpu::{Material, PieceVolume, SolverParams, Volume};
use incise_test_support::energy::Limits;
use incise_test_support::materials::{limp, shells, with_pressure};
use incise_test_support::params::{TEN_ITERATIONS, WEIGHTLESS};

/// The invariant of a volume.
const VOLUME: (&str, f64) = ("relative volume error of a piece in the last second", 0.01);

pub(super) const CASES: [Case; 6] = [
    Case {
        id: "volume",
        stress: "a ball, a bunny and an armadillo with volume constraints on the ground for 15 s",
        invariants: &[VOLUME],
        run: |runner| bodies(runner, &TEN_ITERATIONS, at_rest),
    },
    Case {
        id: "volume",
        stress: "the same, cut twice",
        invariants: &[VOLUME],
        run: |runner| bodies(runner, &TEN_ITERATIONS, cut_twice),
    },
    Case {
        id: "volume",
        stress: "the same with the default substeps",
        invariants: &[VOLUME],
        run: |runner| bodies(runner, &SUBSTEPS, at_rest),
    },
    Case {
        id: "volume",
        stress: "the same with the default substeps, cut twice",
        invariants: &[VOLUME],
        run: |runner| bodies(runner, &SUBSTEPS, cut_twice),
    },
    Case {
        id: "T10",
        stress: "pressure that changes between 0 and 100 volumes in a ball on the ground",
        invariants: &[(
            "distance of a vertex from the middle, in radii of the largest volume so far",
            2.0,
        )],
        run: pressure,
    },
    Case {
        id: "T10",
        stress: "the same in a weightless ball without stiffness",
        invariants: &[("relative volume error before the next change", 0.01)],
        run: pressure_alone,
    },
];

/// The solver's default substeps.
const SUBSTEPS: SolverParams = SolverParams {
    iterations: 1,
    substep: Some(1.0 / 720.0),
    lift: 0.48,
    ..TEN_ITERATIONS
};
/// Radius of balls \[m\].
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
    shells().map(|(name, material)| {
        let volume = Some(Volume::default());
        (name, Material { volume, ..material })
    })
}

/// Returns the largest relative error of a piece's volume; every piece must have a constraint.
fn error(body: &Body<'_>) -> Found<f64> {
    let (all, kept) = (pieces(&body.surface), body.solver.volumes().pieces());
    if !kept.iter().map(PieceVolume::piece).eq(all.iter().copied()) {
        return Err(format!("{} constraints for {} pieces", kept.len(), all.len()).into());
    }
    Ok((volume_errors(&body.surface, kept).into_iter()).fold(0.0, larger))
}

/// Runs every model as every shell.
fn bodies(
    runner: &Runner,
    params: &SolverParams,
    run: impl Fn(&mut Body<'_>, &SolverParams) -> Found<Outcome> + Sync,
) -> Vec<Run> {
    let models = [Model::Armadillo, Model::Bunny, Model::Sphere768];
    let runs: Vec<_> = (models.into_iter())
        .flat_map(|model| kept().map(|(name, material)| (model, name, material)))
        .collect();
    runner.each(&runs, |&(model, name, material)| {
        let mut surface = build_model(model);
        let lift = -f64::from(surface.bounds().min[1]);
        place(&mut surface, |p| p + Vec3::new(0.0, lift, 0.0));
        let found = runner.body_on_ground(surface, &material);
        Run::new(
            format!("{}, {name}", model.name()),
            found.and_then(|mut body| run(&mut body, params)),
        )
    })
}

/// Steps a body on the ground; returns its energy and the largest volume error of the last second.
fn lies(body: &mut Body<'_>, params: &SolverParams, frames: u32) -> Found<(Outcome, f64)> {
    let mut most = 0.0;
    let limits = Limits::above(0.0).within(5.0).recovering();
    let found = body.watched(FRAME, params, frames, limits, |body, frame| {
        if frame + SECOND >= frames {
            most = larger(most, error(body)?);
        }
        Ok(())
    })?;
    Ok((found, most))
}

fn at_rest(body: &mut Body<'_>, params: &SolverParams) -> Found<Outcome> {
    let (found, most) = lies(body, params, 15 * SECOND)?;
    Ok(found.within_energy(most))
}

fn cut_twice(body: &mut Body<'_>, params: &SolverParams) -> Found<Outcome> {
    let mut cutter = Cutter::new(&body.surface);
    let mut directions = Directions(23);
    for _ in 0..2 {
        body.advance(FRAME, params, 5 * SECOND)?;
        cut_largest(body, &mut cutter, &mut directions)?;
    }
    // A deformed body regains volume after a cut, so its energy is not limited.
    let (found, most) = lies(body, params, 5 * SECOND)?;
    Ok(found.by(most))
}

/// Sets one pressure after the other; calls `watch` after every frame with the pressure and
/// whether it is the last frame before the next change.
fn leaps(
    body: &mut Body<'_>,
    params: &SolverParams,
    mut watch: impl FnMut(&Body<'_>, f32, bool),
) -> Found<()> {
    let mut before = 1.0;
    for next in PRESSURES {
        (body.solver).set_volume(&body.surface, Some(with_pressure(next)))?;
        let frames = whole(((next - before).abs() / SPEED + SETTLING) / FRAME);
        for frame in 1..=frames {
            body.advance(FRAME, params, 1)?;
            watch(body, next, frame == frames);
        }
        before = next;
    }
    Ok(())
}

fn pressure(runner: &Runner) -> Vec<Run> {
    runner.each(&kept(), |(name, material)| {
        let (mut most, mut largest) = (0.0, 1.0_f32);
        let found = runner
            .body_on_ground(ball(3, RADIUS), material)
            .and_then(|mut body| {
                leaps(&mut body, &TEN_ITERATIONS, |body, asked, _| {
                    largest = largest.max(asked);
                    let radius = RADIUS * f64::from(largest).cbrt();
                    let middle = body.surface.bounds().center();
                    let all = body.surface.topology().vertices();
                    let distances = all.map(|v| (body.surface.position(v) - middle).norm());
                    most = larger(most, distances.fold(0.0, larger) / radius);
                })
            });
        Run::new((*name).to_owned(), found.map(|()| [most]))
    })
}

fn pressure_alone(runner: &Runner) -> Vec<Run> {
    let surface = ball(3, 0.0);
    let rest = surface.volume();
    let mut runs = Vec::new();
    let found = runner
        .body(surface, &limp(Volume::default()))
        .and_then(|mut body| {
            leaps(&mut body, &WEIGHTLESS, |body, asked, is_last| {
                if is_last {
                    let asked = f64::from(asked);
                    let off = (body.surface.volume() / rest - asked).abs();
                    runs.push(Run::new(
                        format!("{asked} volumes"),
                        Ok([off / asked.max(1.0)]),
                    ));
                }
            })
        });
    if let Err(error) = found {
        runs.push(Run::new("on the way".to_owned(), Err::<Outcome, _>(error)));
    }
    runs
}
