//! Frames on the processor.

use super::bytes;
use super::case::{Case, DT, Place};
use super::clock;
use super::row::Row;
use incise_pbd_gpu::StepError;

/// Measures a model; `bandwidth` is the memory's [B/s].
pub(super) fn row(case: &Case<'_>, bandwidth: f64) -> Row {
    let mut bodies = case.bodies();
    let params = &case.setup.params;
    let times = clock::measure(case.setup.budget, |frames| {
        for _ in 0..frames {
            for (surface, solver) in &mut bodies {
                solver.step(surface, DT, params)?;
            }
        }
        Ok::<(), StepError>(())
    });
    let place = Place {
        backend: "cpu",
        device: &case.setup.machine,
        driver: None,
        schedule: "colors",
        chosen: true,
    };
    let measured = times.map(|times| case.measured(&times, bytes::CPU, Some(bandwidth)));
    case.row(&place, measured.map_err(|error| error.to_string()))
}
