//! Blades that cut nothing.

use super::clock::pairs;
use super::row::Finding;
use super::{Effort, Measurement, at_rest, us};
use incise_mesh::Model;
use incise_pbd_gpu::SolverParams;
use std::error::Error;

/// A blade far from the body, at two ends of a way to and fro.
const FAR: [[[f32; 3]; 2]; 2] = [
    [[9.0, 0.0, -1.0], [9.0, 0.0, 1.0]],
    [[10.0, 0.0, -1.0], [10.0, 0.0, 1.0]],
];

pub(super) fn measurements(effort: Effort) -> Vec<Measurement<'static>> {
    let both = |&model: &Model| {
        let of = |skips, moves| {
            Measurement::new(skips, model.name(), move || {
                blade(model, moves, effort.pairs)
            })
        };
        [of(&["blade at rest"], false), of(&["far blade"], true)]
    };
    effort.models.iter().flat_map(both).collect()
}

fn blade(model: Model, moves: bool, count: u32) -> Result<[Finding; 2], Box<dyn Error>> {
    let params = SolverParams {
        gravity: [0.0; 3],
        ..SolverParams::paper()
    };
    let mut with = at_rest(model, params, None)?;
    let blade = with.add_blade(FAR[0]);
    let mut without = at_rest(model, params, None)?;
    let (mut frames, mut asked) = (0_usize, 0);
    let found = pairs(
        count,
        || {
            frames += 1;
            if moves {
                with.move_blade(blade, FAR[frames % 2]);
            }
            let stats = with.step()?;
            asked += stats.detections + stats.refits;
            // A box far away is known well enough for thousands of frames.
            asked += if moves { 0 } else { stats.boxes };
            Ok::<(), Box<dyn Error>>(())
        },
        || Ok(without.step().map(|_| ())?),
    )?;
    let [skip, asked_claim, time_claim] = if moves {
        [
            "far blade",
            "bodies asked for triangles, and trees refitted",
            "time of a frame, of that without the moving blade",
        ]
    } else {
        [
            "blade at rest",
            "bodies asked for triangles or boxes, and trees refitted",
            "time of a frame, of that without the blade",
        ]
    };
    let [one, other] = found.seconds.map(us);
    Ok([
        Finding {
            skip,
            claim: asked_claim,
            at: format!("{}: {frames} frames", model.name()),
            bound: 0.0,
            measured: f64::from(asked),
        },
        Finding {
            skip,
            claim: time_claim,
            at: format!("{}: {one} of {other} us", model.name()),
            bound: 1.02,
            measured: found.ratio,
        },
    ])
}
