//! What volumes cost: nothing where there are none, and no more than everything else where pieces keep theirs.

use super::clock::pairs;
use super::row::Finding;
use super::{DT, Effort, Measurement, us};
use incise_mesh::{Model, Surface, build_model};
use incise_pbd_gpu::{Material, Solver, SolverParams, StepError, Volume};
use std::error::Error;

/// A frame like those of the paper's table.
const PARAMS: SolverParams = SolverParams {
    gravity: [0.0; 3],
    ..SolverParams::paper()
};

/// Frames that bits are compared after.
const FRAMES: u32 = 30;

/// The table's body, with volume or without.
fn body(model: Model, volume: Option<Volume>) -> Result<(Surface, Solver), Box<dyn Error>> {
    let mut surface = build_model(model);
    let material = Material {
        volume,
        ..crate::motion::material()
    };
    let mut solver = Solver::new(&mut surface, &material)?;
    crate::motion::start(&mut solver, &surface)?;
    Ok((surface, solver))
}

pub(super) fn measurements(effort: Effort) -> Vec<Measurement<'static>> {
    let both = |&model: &Model| {
        [
            Measurement::new(
                &["absent"],
                format!("{}, no volume", model.name()),
                move || turned_off(model, effort.pairs),
            ),
            Measurement::new(&["volume"], model.name(), move || {
                Ok([turned_on(model, effort.pairs)?])
            }),
        ]
    };
    effort.models.iter().flat_map(both).collect()
}

/// A body that had volume and has it no more, beside one that never had.
fn turned_off(model: Model, count: u32) -> Result<[Finding; 2], Box<dyn Error>> {
    let (mut surface, mut solver) = body(model, Some(Volume::default()))?;
    solver.set_volume(&surface, None)?;
    let (mut other, mut other_solver) = body(model, None)?;
    let mut projections = 0;
    for _ in 0..FRAMES {
        for (surface, solver) in [(&mut surface, &mut solver), (&mut other, &mut other_solver)] {
            projections += solver.step(surface, DT, &PARAMS)?.volume_projections;
        }
    }
    let apart = surface.positions.iter().zip(&other.positions);
    let apart = apart.filter(|(a, b)| a != b).count();
    let passes = [&solver, &other_solver].map(|solver| solver.plan().passes().count());
    let found = pairs::<StepError>(
        count,
        || solver.step(&mut surface, DT, &PARAMS).map(|_| ()),
        || {
            let stepped = other_solver.step(&mut other, DT, &PARAMS);
            stepped.map(|_| ())
        },
    )?;
    let [had, never] = found.seconds.map(us);
    Ok([
        Finding {
            skip: "absent",
            claim: "time of a frame after volume was turned off, of that of a body that never had any",
            at: format!("{}: {had} of {never} us", model.name()),
            bound: 1.02,
            measured: found.ratio,
        },
        Finding {
            skip: "absent",
            claim: "its projections of volumes, passes more than of the other, and vertices elsewhere in 30 frames",
            at: format!("{}: {} passes", model.name(), passes[1]),
            bound: 0.0,
            measured: (projections + passes[0].abs_diff(passes[1]) as u64) as f64 + apart as f64,
        },
    ])
}

/// A body with volume, beside the same without.
fn turned_on(model: Model, count: u32) -> Result<Finding, Box<dyn Error>> {
    let (mut surface, mut solver) = body(model, Some(Volume::default()))?;
    let (mut other, mut other_solver) = body(model, None)?;
    let found = pairs::<StepError>(
        count,
        || solver.step(&mut surface, DT, &PARAMS).map(|_| ()),
        || {
            let stepped = other_solver.step(&mut other, DT, &PARAMS);
            stepped.map(|_| ())
        },
    )?;
    let [with, without] = found.seconds.map(us);
    Ok(Finding {
        skip: "volume",
        claim: "time of a frame with its volume kept, of that without",
        at: format!("{}: {with} of {without} us", model.name()),
        bound: 2.0,
        measured: found.ratio,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_turned_off_is_not_there() {
        let [_, rest] = turned_off(Model::Sphere80, 1).unwrap();
        assert_eq!(rest.measured, 0.0, "{rest:?}");
        let (mut surface, mut solver) = body(Model::Sphere80, Some(Volume::default())).unwrap();
        let stats = solver.step(&mut surface, DT, &PARAMS).unwrap();
        assert_eq!(stats.volume_projections, 10, "one a piece and iteration");
    }
}
