//! Frames on a GPU.

use super::ScheduleChoice;
use super::case::{Case, CaseRow, DT, Measured};
use crate::measure::measure_frames;
use incise_pbd_gpu::{
    AdapterKind, AdapterRequest, AdapterSummary, GpuBackend, GpuBody, GpuError, PatchParams,
    Schedule, SolverParams,
};
use std::error::Error;

/// An open GPU.
pub(super) struct Device {
    request: AdapterRequest,
    gpu: GpuBackend,
    adapter: AdapterSummary,
}

/// All schedules.
const SCHEDULES: [ScheduleChoice; 2] = [ScheduleChoice::WholeBody, ScheduleChoice::Patches];

/// The measurement of a schedule.
struct ScheduleResult {
    schedule: Schedule,
    /// Whether the backend chooses this schedule.
    chosen: bool,
    measured: Measured,
}

impl ScheduleChoice {
    const fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::WholeBody => "whole-body",
            Self::Patches => "patches",
        }
    }
}

impl Device {
    /// Opens the GPU of that name, or the best one; software if there is no other.
    ///
    /// # Errors
    /// The error of opening it.
    pub(super) fn open(adapter: Option<&str>) -> Result<Self, GpuError> {
        let request = AdapterRequest::any(adapter.map(str::to_owned));
        let gpu = GpuBackend::new(&request)?;
        let adapter = gpu.adapter().clone();
        Ok(Self {
            request,
            gpu,
            adapter,
        })
    }

    /// Returns name, kind and driver.
    pub(super) fn describe(&self) -> String {
        let AdapterSummary {
            name, kind, driver, ..
        } = &self.adapter;
        format!("{name} ({kind}, {driver})")
    }

    /// Measures the number of constraints from which the GPU is faster than the CPU; none if it
    /// never is.
    ///
    /// # Errors
    /// The GPU's error as text.
    pub(super) fn calibrate(&mut self, params: &SolverParams) -> Result<Option<usize>, String> {
        if self.adapter.kind == AdapterKind::Software {
            return Ok(None);
        }
        let measured = self.gpu.calibrate(DT, params);
        measured.map_err(|error| error.to_string())
    }

    /// Measures a case under the given schedules, or under all that it fits.
    pub(super) fn rows(&mut self, case: &Case<'_>, asked: &[ScheduleChoice]) -> Vec<CaseRow> {
        let schedules = if asked.is_empty() { &SCHEDULES } else { asked };
        let mut rows = Vec::new();
        for &choice in schedules {
            let (schedule, measured) = match self.measure(case, choice) {
                Ok(Some(found)) => ((found.schedule.name(), found.chosen), Ok(found.measured)),
                Ok(None) if asked.is_empty() => continue,
                Ok(None) => {
                    let refusal = "the body does not fit this schedule".to_owned();
                    ((choice.name(), false), Err(refusal))
                }
                Err(error) => ((choice.name(), false), Err(error.to_string())),
            };
            rows.push(CaseRow {
                backend: "gpu",
                device: Some(self.adapter.name.clone()),
                row: case.row(Some(&self.adapter.driver), schedule, measured),
            });
        }
        rows
    }

    /// Measures one schedule; none if the body does not fit it.
    fn measure(
        &mut self,
        case: &Case<'_>,
        choice: ScheduleChoice,
    ) -> Result<Option<ScheduleResult>, Box<dyn Error>> {
        let mut places = Vec::new();
        let done = self.measure_bodies(case, choice, &mut places);
        for place in places {
            self.gpu.remove(place);
        }
        // After an error the next row starts on a new device.
        if done.is_err()
            && let Ok(gpu) = GpuBackend::new(&self.request)
        {
            self.gpu = gpu;
        }
        done
    }

    fn measure_bodies(
        &mut self,
        case: &Case<'_>,
        choice: ScheduleChoice,
        places: &mut Vec<GpuBody>,
    ) -> Result<Option<ScheduleResult>, Box<dyn Error>> {
        let gpu = &mut self.gpu;
        let mut bodies = case.bodies();
        // The backend chooses a schedule when it has the body.
        gpu.force_schedule(None);
        let Some((surface, solver)) = bodies.first_mut() else {
            return Ok(None);
        };
        let first = gpu.add(surface, solver)?;
        let own = gpu.schedule(first)?;
        gpu.remove(first);
        // An empty frame, so that earlier uploads do not count with the first one.
        gpu.step(std::iter::empty(), DT, &case.setup.params)?;
        let forced = match choice {
            ScheduleChoice::Auto => own,
            ScheduleChoice::WholeBody => Schedule::WholeBody,
            ScheduleChoice::Patches => Schedule::Patches,
        };
        if choice != ScheduleChoice::Auto {
            let patches = (forced == Schedule::Patches).then(PatchParams::default);
            bodies = case.divided_bodies(patches.as_ref())?;
        }
        gpu.force_schedule(Some(forced));
        for (surface, solver) in &mut bodies {
            let place = gpu.add(surface, solver)?;
            places.push(place);
            if gpu.schedule(place)? != forced {
                return Ok(None);
            }
        }
        let mut at_start = None;
        let times = measure_frames(case.setup.length, |frames| {
            for _ in 0..frames {
                let solvers = bodies.iter_mut().map(|(_, solver)| solver);
                let all = places.iter().copied().zip(solvers);
                let stats = gpu.step(all, DT, &case.setup.params)?;
                at_start.get_or_insert(stats.bytes_uploaded);
            }
            gpu.wait()
        })?;
        let stats = *gpu.stats();
        // Reports positions that are not finite.
        for (&place, (surface, solver)) in places.iter().zip(&mut bodies) {
            gpu.read(place, surface, solver)?;
        }
        let mut measured = case.measured(&times);
        measured.dispatches = Some(stats.dispatches);
        measured.bytes_uploaded = stats.bytes_uploaded;
        measured.bytes_uploaded_at_start = at_start.unwrap_or(0);
        Ok(Some(ScheduleResult {
            schedule: forced,
            chosen: forced == own,
            measured,
        }))
    }
}
