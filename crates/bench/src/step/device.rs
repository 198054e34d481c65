//! Frames on a GPU.

use super::{Case, Measured, Row, ScheduleChoice};
use crate::gpu::Device;
use crate::measure::measure_frames;
use crate::motion::{Body, DT};
use incise_pbd_gpu::{AdapterKind, GpuBackend, GpuBody, PatchParams, Schedule, SolverParams};
use std::error::Error;

/// The measurement of a schedule.
struct ScheduleResult {
    schedule: Schedule,
    /// Whether the backend chooses this schedule.
    chosen: bool,
    measured: Measured,
}

impl ScheduleChoice {
    /// Returns the schedule; none for the one that the backend chooses.
    const fn schedule(self) -> Option<Schedule> {
        match self {
            Self::Auto => None,
            Self::WholeBody => Some(Schedule::WholeBody),
            Self::Patches => Some(Schedule::Patches),
        }
    }
}

/// Returns name, kind and driver.
pub(super) fn describe(device: &Device) -> String {
    let adapter = device.gpu.adapter();
    format!("{} ({}, {})", adapter.name, adapter.kind, adapter.driver)
}

/// Measures the number of constraints from which the GPU is faster than the CPU; none if it never
/// is.
///
/// # Errors
/// The GPU's error as text.
pub(super) fn calibrate(
    device: &mut Device,
    params: &SolverParams,
) -> Result<Option<usize>, String> {
    if device.gpu.adapter().kind == AdapterKind::Software {
        return Ok(None);
    }
    let measured = device.gpu.calibrate(DT, params);
    measured.map_err(|error| error.to_string())
}

/// Measures a case under the given schedules, or under all that it fits.
pub(super) fn rows(device: &mut Device, case: &Case<'_>, asked: &[ScheduleChoice]) -> Vec<Row> {
    let all = [ScheduleChoice::WholeBody, ScheduleChoice::Patches];
    let mut rows = Vec::new();
    for &choice in if asked.is_empty() { &all } else { asked } {
        let mut places = Vec::new();
        let done = device.measure(|gpu| {
            let done = measure(gpu, case, choice, &mut places);
            for place in places {
                gpu.remove(place);
            }
            done
        });
        let named = choice.schedule().map_or("auto", Schedule::name);
        let (schedule, chosen, measured) = match done {
            Ok(Some(found)) => (found.schedule.name(), found.chosen, Ok(found.measured)),
            Ok(None) if asked.is_empty() => continue,
            Ok(None) => {
                let refusal = "the body does not fit this schedule".to_owned();
                (named, false, Err(refusal))
            }
            Err(error) => (named, false, Err(error.to_string())),
        };
        let adapter = device.gpu.adapter();
        rows.push(Row {
            backend: "gpu",
            gpu: Some(adapter.name.clone()),
            driver: Some(adapter.driver.clone()),
            schedule,
            chosen,
            ..case.row(measured)
        });
    }
    rows
}

/// Measures one schedule, and records the bodies on the GPU; none if the body does not fit it.
fn measure(
    gpu: &mut GpuBackend,
    case: &Case<'_>,
    choice: ScheduleChoice,
    places: &mut Vec<GpuBody>,
) -> Result<Option<ScheduleResult>, Box<dyn Error>> {
    let params = case.parameters.solver();
    let mut bodies = case.bodies();
    // The backend chooses a schedule when it has the body.
    gpu.force_schedule(None);
    let Some(Body { surface, solver }) = bodies.first_mut() else {
        return Ok(None);
    };
    let first = gpu.add(surface, solver)?;
    let own = gpu.schedule(first)?;
    gpu.remove(first);
    // An empty frame, so that earlier uploads do not count with the first one.
    gpu.step(std::iter::empty(), DT, &params)?;
    let forced = choice.schedule().unwrap_or(own);
    if choice != ScheduleChoice::Auto {
        let patches = (forced == Schedule::Patches).then(PatchParams::default);
        bodies = case.divided_bodies(patches.as_ref())?;
    }
    gpu.force_schedule(Some(forced));
    for Body { surface, solver } in &mut bodies {
        let place = gpu.add(surface, solver)?;
        places.push(place);
        if gpu.schedule(place)? != forced {
            return Ok(None);
        }
    }
    let mut at_start = None;
    let times = measure_frames(case.length, |frames| {
        for _ in 0..frames {
            let solvers = bodies.iter_mut().map(|body| &mut body.solver);
            let all = places.iter().copied().zip(solvers);
            let stats = gpu.step(all, DT, &params)?;
            at_start.get_or_insert(stats.bytes_uploaded);
        }
        gpu.wait()
    })?;
    let stats = *gpu.stats();
    // Reports positions that are not finite.
    for (&place, Body { surface, solver }) in places.iter().zip(&mut bodies) {
        gpu.read(place, surface, solver)?;
    }
    let mut measured = case.measured(times);
    measured.dispatches = Some(stats.dispatches);
    measured.bytes_uploaded = stats.bytes_uploaded;
    measured.bytes_uploaded_at_start = at_start.unwrap_or(0);
    Ok(Some(ScheduleResult {
        schedule: forced,
        chosen: forced == own,
        measured,
    }))
}
