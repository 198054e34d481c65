//! Frames on a GPU.

use super::ScheduleChoice;
use super::bytes;
use super::case::{Case, DT, Place};
use super::clock;
use super::copies;
use super::row::{Measured, Row};
use incise_pbd_gpu::{
    AdapterKind, AdapterRequest, AdapterSummary, ConstraintError, GpuBackend, GpuBody, GpuError,
    Schedule, SolverParams,
};

/// An open GPU and what its memory can do.
pub(super) struct Device {
    request: AdapterRequest,
    gpu: GpuBackend,
    adapter: AdapterSummary,
    /// Bytes a second, if they could be measured.
    bandwidth: Option<f64>,
}

/// All schedules there are.
const EVERY: [ScheduleChoice; 3] = [
    ScheduleChoice::WholeBody,
    ScheduleChoice::Colors,
    ScheduleChoice::Patches,
];

/// Why a schedule cannot be measured.
#[derive(Debug, thiserror::Error)]
enum MeasureError {
    #[error(transparent)]
    Constraint(#[from] ConstraintError),
    #[error(transparent)]
    Gpu(#[from] GpuError),
}

/// What a schedule did.
struct Found {
    schedule: Schedule,
    /// Whether it is the one that is taken by itself.
    chosen: bool,
    measured: Measured,
}

impl Device {
    /// Opens the GPU of that name, else the best there is, software if there is nothing else.
    ///
    /// # Errors
    /// Why there is none.
    pub(super) fn open(adapter: Option<&str>) -> Result<Self, String> {
        let request = AdapterRequest::any(adapter.map(str::to_owned));
        let gpu = GpuBackend::new(&request).map_err(|error| error.to_string())?;
        let adapter = gpu.adapter().clone();
        let is_software = adapter.kind == AdapterKind::Software;
        let bandwidth = copies::bandwidth(gpu.context(), is_software).ok();
        Ok(Self {
            request,
            gpu,
            adapter,
            bandwidth,
        })
    }

    /// A line for people.
    pub(super) fn describe(&self) -> String {
        let AdapterSummary {
            name, kind, driver, ..
        } = &self.adapter;
        let bandwidth = match self.bandwidth {
            Some(rate) => format!("{:.2} GB/s of copies", rate / 1e9),
            None => "no room to measure copies".to_owned(),
        };
        format!("{name} ({kind}, {driver}), {bandwidth}")
    }

    /// How many constraints a body must have to be stepped faster here than by the processor; none if
    /// no body is.
    ///
    /// # Errors
    /// Why it cannot be measured.
    pub(super) fn faster_from(&mut self, params: &SolverParams) -> Result<Option<usize>, String> {
        if self.adapter.kind == AdapterKind::Software {
            return Ok(None);
        }
        let measured = self.gpu.calibrate(DT, params);
        measured.map_err(|error| error.to_string())
    }

    /// Measures a model under the schedules asked for; under all that it fits if none is.
    pub(super) fn rows(&mut self, case: &Case<'_>, asked: &[ScheduleChoice]) -> Vec<Row> {
        let schedules = if asked.is_empty() { &EVERY } else { asked };
        let mut rows = Vec::new();
        for &choice in schedules {
            let row = match self.measure(case, choice) {
                Ok(Some(found)) => {
                    let place = self.place(found.schedule.name(), found.chosen);
                    case.row(&place, Ok(found.measured))
                }
                Ok(None) if asked.is_empty() => continue,
                Ok(None) => {
                    let reason = "the body does not fit this schedule".to_owned();
                    case.row(&self.place(choice.name(), false), Err(reason))
                }
                Err(error) => {
                    let reason = Err(error.to_string());
                    case.row(&self.place(choice.name(), false), reason)
                }
            };
            rows.push(row);
        }
        rows
    }

    fn place(&self, schedule: &'static str, chosen: bool) -> Place<'_> {
        Place {
            backend: "gpu",
            device: &self.adapter.name,
            driver: Some(&self.adapter.driver),
            schedule,
            chosen,
        }
    }

    /// Measures one schedule; nothing if the body does not fit it.
    fn measure(
        &mut self,
        case: &Case<'_>,
        choice: ScheduleChoice,
    ) -> Result<Option<Found>, MeasureError> {
        let mut places = Vec::new();
        let done = self.measure_bodies(case, choice, &mut places);
        for place in places {
            self.gpu.remove(place);
        }
        // What went wrong stays with this row: the next one starts on a device without a past.
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
    ) -> Result<Option<Found>, MeasureError> {
        let gpu = &mut self.gpu;
        let mut bodies = case.bodies();
        // What the backend takes by itself is only known once it has a body.
        gpu.force_schedule(None);
        let Some((surface, solver)) = bodies.first_mut() else {
            return Ok(None);
        };
        let first = gpu.add(surface, solver)?;
        let own = gpu.schedule(first)?;
        gpu.remove(first);
        // A frame of nothing, so that what was sent up to here is not counted with the first one.
        gpu.step(std::iter::empty(), DT, &case.setup.params)?;
        let forced = match choice {
            ScheduleChoice::Auto => own,
            ScheduleChoice::WholeBody => Schedule::WholeBody,
            ScheduleChoice::Colors => Schedule::Colors,
            ScheduleChoice::Patches => Schedule::Patches,
        };
        if forced == Schedule::Patches {
            bodies = case.patched_bodies()?;
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
        let times = clock::measure(case.setup.budget, |frames| {
            for _ in 0..frames {
                let solvers = bodies.iter_mut().map(|(_, solver)| solver);
                let all = places.iter().copied().zip(solvers);
                let stats = gpu.step(all, DT, &case.setup.params)?;
                at_start.get_or_insert(stats.bytes_uploaded);
            }
            gpu.wait()
        })?;
        let stats = *gpu.stats();
        // Whether all positions are still numbers.
        for (&place, (surface, solver)) in places.iter().zip(&mut bodies) {
            gpu.read(place, surface, solver)?;
        }
        let measured = case.measured(&times, bytes::DEVICE, self.bandwidth);
        Ok(Some(Found {
            schedule: forced,
            chosen: forced == own,
            measured: Measured {
                dispatches: Some(stats.dispatches),
                bytes_uploaded: stats.bytes_uploaded,
                bytes_uploaded_at_start: at_start.unwrap_or(0),
                ..measured
            },
        }))
    }
}
