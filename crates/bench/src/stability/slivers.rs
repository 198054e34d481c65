//! Bodies cut into many random pieces, slivers among them.

use super::case::{Case, larger};
use super::cuts::through;
use super::error::StressError;
use super::group::{Group, Grouping, touching};
use super::measured::{Measured, Quantities, worst_of};
use super::runner::Runner;
use super::scenes::ball;
use crate::directions::Directions;
use incise_mesh::Surface;
use incise_models::{Model, build_model};
use incise_pbd_gpu::Material;
use incise_scene::{BackendRequest, ContactParams, SceneParams};

const SHATTER: &str = "a bunny cut by ten random planes in ten frames of its fall, with and \
                       without contacts";

pub(super) const CASES: [Case; 3] = [
    Case {
        id: "slivers",
        stress: "a weightless, damped ball cut by six random planes, with contacts",
        invariant: "time until its pieces sleep [s]",
        bound: 60.0,
        run: |runner| worst_of(runner, 0, weightless),
    },
    Case {
        id: "shatter",
        stress: SHATTER,
        invariant: "speed of a vertex relative to free fall [m/s]",
        bound: 2.0,
        run: |runner| worst_of(runner, 0, shatter),
    },
    Case {
        id: "shatter",
        stress: SHATTER,
        invariant: "relative volume error of a piece, a second after the last cut",
        bound: 0.01,
        run: |runner| worst_of(runner, 1, shatter),
    },
];

/// Longest wait for pieces to sleep \[s\]: a second beyond the bound.
const LONGEST: f64 = 61.0;

/// Cuts all pieces of a body along one random plane a frame.
fn cut_all(group: &mut Group, planes: u32, seed: u64) -> Result<(), StressError> {
    let mut directions = Directions(seed);
    for _ in 0..planes {
        let sweep = through(group.surface_of(0)?, None, &mut directions)?;
        let [before, after] = sweep.ends();
        let blade = group.scene.add_blade(before);
        group.scene.move_blade(blade, after)?;
        group.step()?;
    }
    Ok(())
}

fn whole(
    backend: &BackendRequest,
    surface: Surface,
    params: SceneParams,
    material: &Material,
) -> Result<Group, StressError> {
    Group::new(backend, params, (&[surface], Grouping::Bodies), material)
}

fn weightless(runner: &Runner) -> Result<Vec<Measured>, StressError> {
    let seeds: Vec<u64> = (1..=runner.pick(1, 6)).collect();
    let subdivisions = runner.pick(1, 2);
    Ok(runner.each(&seeds, |backend, &seed| {
        let run = || -> Result<Quantities, StressError> {
            let params = touching(0.0, None);
            let ball = ball(subdivisions, 0.0);
            let mut group = whole(backend, ball, params, &Material::soft_body())?;
            cut_all(&mut group, 6, seed)?;
            Ok(vec![Some(group.settle(LONGEST)?)])
        };
        Measured {
            at: format!("seed {seed}"),
            quantities: run(),
        }
    }))
}

fn shatter(runner: &Runner) -> Result<Vec<Measured>, StressError> {
    let mut runs = Vec::new();
    for seed in 1..=runner.pick(1, 3) {
        runs.extend([(seed, true), (seed, false)]);
    }
    Ok(runner.each(&runs, |backend, &(seed, contacts)| Measured {
        at: format!("seed {seed}, contacts {contacts}"),
        quantities: shatter_one(backend, seed, contacts),
    }))
}

fn shatter_one(
    backend: &BackendRequest,
    seed: u64,
    contacts: bool,
) -> Result<Quantities, StressError> {
    let params = SceneParams {
        contacts: contacts.then(ContactParams::default),
        ..touching(9.81, None)
    };
    let material = Material {
        damping: 0.0,
        ..Material::soft_body()
    };
    let mut group = whole(backend, build_model(Model::Bunny), params, &material)?;
    cut_all(&mut group, 10, seed)?;
    let mut speed = 0.0;
    for frame in 10..70_u32 {
        group.step()?;
        let fall = 9.81 * f64::from(frame + 1) / 60.0;
        speed = larger(speed, group.speed_relative_to([0.0, -fall, 0.0])?);
    }
    Ok(vec![Some(speed), Some(group.volume_error()?)])
}
