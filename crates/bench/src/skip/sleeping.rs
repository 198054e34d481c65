//! Bodies at rest.

use super::clock::pairs;
use super::row::Finding;
use super::{Effort, Measurement, at_rest, us};
use incise_mesh::Model;
use incise_pbd_gpu::SolverParams;
use incise_scene::{Scene, SleepParams};
use std::error::Error;

/// How many sleep at once.
const CROWD: u32 = 1000;

pub(super) fn measurements(effort: Effort) -> Vec<Measurement<'static>> {
    let one = |&model: &Model| {
        Measurement::new(&["sleep"], model.name(), move || {
            Ok([one(model, effort.pairs)?])
        })
    };
    let crowd = Measurement::new(&["sleep"], "a crowd", move || crowd(effort.pairs));
    effort.sleepers.iter().map(one).chain([crowd]).collect()
}

/// Steps until all bodies sleep.
pub(super) fn lull(scene: &mut Scene, bodies: u32) -> Result<(), Box<dyn Error>> {
    let frames = SleepParams::default().frames(scene.params.dt) + SleepParams::LAG;
    for _ in 0..=frames {
        scene.step()?;
    }
    let asleep = scene.stats().asleep;
    if asleep == bodies {
        Ok(())
    } else {
        Err(format!("{asleep} of {bodies} bodies at rest sleep").into())
    }
}

fn one(model: Model, count: u32) -> Result<Finding, Box<dyn Error>> {
    let params = SolverParams::default();
    let mut asleep = at_rest(model, params, Some(SleepParams::default()))?;
    lull(&mut asleep, 1)?;
    let mut awake = at_rest(model, params, None)?;
    let found = pairs(
        count,
        || asleep.step().map(|_| ()),
        || awake.step().map(|_| ()),
    )?;
    let [sleeps, steps] = found.seconds.map(us);
    Ok(Finding {
        skip: "sleep",
        claim: "time of a frame, of that of the same body awake",
        at: format!("{}: {sleeps} of {steps} us", model.name()),
        bound: 0.01,
        measured: found.ratio,
    })
}

fn crowd(count: u32) -> Result<[Finding; 2], Box<dyn Error>> {
    let mut scene = at_rest(
        Model::Sphere20,
        SolverParams::default(),
        Some(SleepParams::default()),
    )?;
    for _ in 1..CROWD {
        super::add(&mut scene, Model::Sphere20)?;
    }
    lull(&mut scene, CROWD)?;
    let mut of = |with_blade: bool| -> Result<Finding, Box<dyn Error>> {
        let blade = with_blade.then(|| scene.add_blade([[9.0, 0.0, -1.0], [9.0, 0.0, 1.0]]));
        let mut x = 9.0;
        let mut frame = || {
            if let Some(blade) = blade {
                x = 19.0 - x;
                scene.move_blade(blade, [[x, 0.0, -1.0], [x, 0.0, 1.0]]);
            }
            scene.step().map(|_| ())
        };
        // In turns with itself: the time of one.
        let found = pairs(count, &mut frame, || Ok(()))?;
        Ok(Finding {
            skip: "sleep",
            claim: "time of a frame of 1,000 bodies asleep [us]",
            at: if with_blade {
                "a blade moves beside them"
            } else {
                "no blade"
            }
            .to_owned(),
            bound: 50.0,
            measured: found.seconds[0] * 1e6,
        })
    };
    Ok([of(false)?, of(true)?])
}
