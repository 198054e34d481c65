//! Iterations that are left out where a residual is met.

use super::clock::pairs;
use super::row::Finding;
use super::{DT, Effort, Measurement, at_rest, us};
use incise_mesh::{Model, build_model};
use incise_pbd_gpu::{Solver, SolverParams};
use std::error::Error;

/// Well above what rounding makes, well below what anybody sees \[m\].
const RESIDUAL: f32 = 1e-5;

/// For bodies in motion, whose iterations move them farther \[m\].
const COARSE: f32 = 1e-4;

/// Frames in motion.
const FRAMES: u32 = 30;

pub(super) fn measurements(effort: Effort) -> Vec<Measurement<'static>> {
    const SKIPS: &[&str] = &["early out"];
    let both = |&model: &Model| {
        [
            Measurement::new(SKIPS, format!("{} at rest", model.name()), move || {
                Ok([at_rest_it_pays(model, effort.pairs)?])
            }),
            Measurement::new(SKIPS, format!("{} in motion", model.name()), move || {
                Ok([in_motion_it_is_near(model)?])
            }),
        ]
    };
    effort.models.iter().flat_map(both).collect()
}

fn params(residual: Option<f32>) -> SolverParams {
    SolverParams {
        gravity: [0.0; 3],
        residual,
        ..SolverParams::paper()
    }
}

fn at_rest_it_pays(model: Model, count: u32) -> Result<Finding, Box<dyn Error>> {
    let mut early = at_rest(model, params(Some(RESIDUAL)), None)?;
    let mut full = at_rest(model, params(None), None)?;
    let found = pairs(
        count,
        || early.step().map(|_| ()),
        || full.step().map(|_| ()),
    )?;
    let skipped = early.stats().iterations_skipped;
    let [some, all] = found.seconds.map(us);
    Ok(Finding {
        skip: "early out",
        claim: "time of a frame at rest with a residual of 1e-5 m, of that without",
        at: format!(
            "{}: {skipped} of 10 left out, {some} of {all} us",
            model.name()
        ),
        bound: 0.5,
        measured: found.ratio,
    })
}

/// A frame of a body that spins and is squeezed.
fn in_motion_it_is_near(model: Model) -> Result<Finding, Box<dyn Error>> {
    let mut surface = build_model(model);
    let mut solver = Solver::new(&mut surface, &crate::motion::material())?;
    crate::motion::start(&mut solver, &surface)?;
    let (mut worst, mut left_out) = (0.0_f64, 0);
    for _ in 0..FRAMES {
        let (mut early, mut early_solver) = (surface.clone(), solver.clone());
        let residual = params(Some(COARSE));
        let skipped = early_solver
            .step(&mut early, DT, &residual)?
            .iterations_skipped;
        solver.step(&mut surface, DT, &params(None))?;
        left_out += skipped;
        let pairs = surface.positions.iter().zip(&early.positions);
        let off = pairs.flat_map(|(a, b)| (0..3).map(|k| (a[k] - b[k]).abs()));
        let off = f64::from(off.fold(0.0, f32::max));
        if off > 0.0 {
            worst = worst.max(off / (f64::from(COARSE) * f64::from(skipped.max(1))));
        }
    }
    Ok(Finding {
        skip: "early out",
        claim: "way from where all iterations lead, in residuals for each one left out",
        at: format!("{}: {left_out} of {} left out", model.name(), 10 * FRAMES),
        bound: 1.0,
        measured: worst,
    })
}
