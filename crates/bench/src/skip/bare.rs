//! What a scene has not: angles, ground, pins, blades.

use super::clock::pairs;
use super::minimal::Minimal;
use super::row::Finding;
use super::{DT, Effort, Measurement, at_rest_of, us};
use incise_mesh::{Model, Surface, build_model};
use incise_pbd_gpu::{Material, Solver, SolverParams, StepError};
use std::error::Error;

/// A frame like those of the paper's table.
const PARAMS: SolverParams = SolverParams {
    gravity: [0.0; 3],
    ..SolverParams::paper()
};

fn edges() -> Material {
    Material {
        bending: None,
        ..Material::default()
    }
}

fn body(model: Model) -> Result<(Surface, Solver), Box<dyn Error>> {
    let mut surface = build_model(model);
    let mut solver = Solver::new(&mut surface, &edges())?;
    crate::motion::start(&mut solver, &surface)?;
    Ok((surface, solver))
}

pub(super) fn measurements(effort: Effort) -> Vec<Measurement<'static>> {
    let both = |&model: &Model| {
        [
            Measurement::new(&["absent"], format!("{}, edges", model.name()), move || {
                beside_the_bare_one(model, effort.pairs)
            }),
            Measurement::new(&["absent"], format!("{}, scene", model.name()), move || {
                Ok([beside_the_solver(model, effort.pairs)?])
            }),
        ]
    };
    effort.models.iter().flat_map(both).collect()
}

/// The shipped solver and one that has edges alone.
fn beside_the_bare_one(model: Model, count: u32) -> Result<[Finding; 2], Box<dyn Error>> {
    let (mut surface, mut solver) = body(model)?;
    let (mut other, mut other_solver) = (surface.clone(), solver.clone());
    let mut minimal = Minimal::default();
    for _ in 0..30 {
        solver.step(&mut surface, DT, &PARAMS)?;
        other_solver.step_on(&mut minimal, &mut other, DT, &PARAMS)?;
    }
    let apart = surface.positions.iter().zip(&other.positions);
    let apart = apart.filter(|(a, b)| a != b).count();
    let passes = solver.stats().passes as usize - solver.plan().passes().count();
    let found = pairs(
        count,
        || solver.step(&mut surface, DT, &PARAMS).map(|_| ()),
        || {
            let stepped = other_solver.step_on(&mut minimal, &mut other, DT, &PARAMS);
            stepped.map(|_| ())
        },
    )?;
    let [shipped, bare] = found.seconds.map(us);
    let kinds = other_solver.plan();
    let colors = kinds.iteration().len();
    Ok([
        Finding {
            skip: "absent",
            claim: "time of a frame of edges alone, of that of a solver that has nothing else",
            at: format!("{}: {shipped} of {bare} us", model.name()),
            bound: 1.02,
            measured: found.ratio,
        },
        Finding {
            skip: "absent",
            claim: "vertices that it moves elsewhere in 30 frames, and passes of what is absent",
            at: format!("{}: {colors} passes an iteration", model.name()),
            bound: 0.0,
            measured: (apart + passes) as f64,
        },
    ])
}

/// A scene of one body, without a blade, and the body's solver alone.
fn beside_the_solver(model: Model, count: u32) -> Result<Finding, Box<dyn Error>> {
    let mut scene = at_rest_of(build_model(model), &edges(), PARAMS, None)?;
    let mut surface = build_model(model);
    let mut solver = Solver::new(&mut surface, &edges())?;
    let found = pairs::<Box<dyn Error>>(
        count,
        || Ok(scene.step().map(|_| ())?),
        || {
            let stepped: Result<_, StepError> = solver.step(&mut surface, DT, &PARAMS);
            Ok(stepped.map(|_| ())?)
        },
    )?;
    let [whole, alone] = found.seconds.map(us);
    Ok(Finding {
        skip: "absent",
        claim: "time of a scene's frame, of that of the solver alone",
        at: format!("{}: {whole} of {alone} us", model.name()),
        bound: 1.02,
        measured: found.ratio,
    })
}
