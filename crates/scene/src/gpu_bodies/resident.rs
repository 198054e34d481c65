//! The bodies of a scene in GPU memory: upload, readback, checkpoints and steps.
//!
//! `frame.rs` drives them through [`GpuBodies`]. Where each body's newest state is follows
//! [`Residency`].

use super::GpuBodies;
use crate::backend::BackendRequest;
use crate::body::{Body, BodyId};
use crate::error::{FallbackReason, SceneError};
use crate::params::SceneParams;
use crate::residency::{Event, Residency};
use crate::scene::Bodies;
use crate::sleep::{Sleep, Step};
use crate::stats::FrameStats;
use incise_mesh::{Aabb, Surface};
use incise_pbd_gpu::{AdapterKind, AdapterRequest, Context, GpuBackend, GpuBody, GpuError};

/// The bodies in the memory of one GPU.
#[derive(Debug)]
pub(crate) struct ResidentBodies {
    gpu: GpuBackend,
    /// By index of the body in the scene; `None` for CPU bodies.
    residents: Vec<Option<Resident>>,
    /// Minimum number of constraints of a body to be stepped here.
    min_constraints: usize,
    /// Number of frames so far.
    frame: u64,
}

/// A body in GPU memory.
#[derive(Debug, Clone, Copy)]
struct Resident {
    id: BodyId,
    handle: GpuBody,
    residency: Residency,
    /// The motion version of the surface before an edit from outside.
    version_before_edit: Option<u64>,
    /// The bounding box of the GPU state, once requested.
    bounds: Option<Aabb>,
    /// Whether the next step copies the state back, because a sweep is near.
    prefetch_requested: bool,
    /// Whether a checkpoint was requested and has not arrived.
    checkpoint_pending: bool,
}

impl ResidentBodies {
    /// Opens the requested GPU.
    pub(crate) fn open(request: &BackendRequest) -> Result<Self, SceneError> {
        Self::with_context(Context::open(&adapter_request(request))?)
    }

    /// Opens a GPU that is faster than the CPU for some bodies.
    pub(crate) fn open_if_faster(
        request: &BackendRequest,
        params: &SceneParams,
    ) -> Result<Self, FallbackReason> {
        let hardware = AdapterRequest {
            allow_software: false,
            ..adapter_request(request)
        };
        let context = Context::open(&hardware).map_err(SceneError::from)?;
        if context.adapter().kind == AdapterKind::Software {
            let adapter = context.adapter().name.clone();
            return Err(FallbackReason::SoftwareAdapter { adapter });
        }
        Self::with_context(context)?.if_faster(request, params)
    }

    /// Uses an open GPU.
    pub(crate) fn with_context(context: Context) -> Result<Self, SceneError> {
        Ok(Self {
            gpu: GpuBackend::from_context(context)?,
            residents: Vec::new(),
            min_constraints: 0,
            frame: 0,
        })
    }

    /// Measures the body size above which this GPU is faster than the CPU.
    pub(crate) fn if_faster(
        mut self,
        request: &BackendRequest,
        params: &SceneParams,
    ) -> Result<Self, FallbackReason> {
        let measured = match request.min_gpu_constraints {
            Some(count) => Some(count),
            None => {
                let measured = self.gpu.calibrate(params.dt, &params.solver);
                measured.map_err(SceneError::from)?
            }
        };
        match measured {
            Some(count) => {
                self.min_constraints = count;
                Ok(self)
            }
            None => Err(FallbackReason::SlowerThanCpu {
                adapter: self.adapter_name().to_owned(),
            }),
        }
    }

    fn resident(&self, i: usize) -> Option<&Resident> {
        self.residents.get(i)?.as_ref()
    }

    fn resident_mut(&mut self, i: usize) -> Option<&mut Resident> {
        self.residents.get_mut(i)?.as_mut()
    }
}

impl Resident {
    fn apply(&mut self, event: Event) {
        self.residency = self.residency.after(event);
    }

    /// Names the body in its own errors; all others are the GPU's.
    fn error(&self, error: GpuError) -> SceneError {
        match error {
            GpuError::Step(error) => SceneError::Step {
                body: self.id,
                error,
            },
            error => SceneError::Gpu(error),
        }
    }
}

impl GpuBodies for ResidentBodies {
    fn adapter_name(&self) -> &str {
        &self.gpu.adapter().name
    }

    fn min_constraints(&self) -> usize {
        self.min_constraints
    }

    fn residency(&self, i: usize) -> Residency {
        self.resident(i)
            .map_or(Residency::CpuOnly, |resident| resident.residency)
    }

    fn add(&mut self, id: BodyId, body: &mut Body) -> Result<(), SceneError> {
        let i = id.index;
        let is_small = body.constraints() < self.min_constraints;
        if self.resident(i).is_some() || is_small {
            return Ok(());
        }
        let (surface, solver) = body.parts();
        let handle = self.gpu.add(surface, solver)?;
        if self.residents.len() <= i {
            self.residents.resize(i + 1, None);
        }
        self.residents[i] = Some(Resident {
            id,
            handle,
            residency: Residency::CpuOnly.after(Event::Added),
            version_before_edit: None,
            bounds: None,
            prefetch_requested: false,
            checkpoint_pending: false,
        });
        Ok(())
    }

    fn remove(&mut self, i: usize) {
        if let Some(resident) = self.residents.get_mut(i).and_then(Option::take) {
            self.gpu.remove(resident.handle);
        }
    }

    fn read_back(&mut self, i: usize, body: &mut Body) -> Result<bool, SceneError> {
        let Some(resident) = self.residents.get_mut(i).and_then(Option::as_mut) else {
            return Ok(false);
        };
        if resident.residency.is_cpu_current() {
            return Ok(false);
        }
        let (surface, solver) = body.moved_parts();
        let done = self.gpu.read(resident.handle, surface, solver);
        done.map_err(|error| resident.error(error))?;
        resident.apply(Event::ReadBack);
        Ok(true)
    }

    fn bounds(&mut self, i: usize) -> Result<Option<Aabb>, SceneError> {
        let Some(resident) = self.residents.get_mut(i).and_then(Option::as_mut) else {
            return Ok(None);
        };
        if !resident.residency.is_cpu_current() && resident.bounds.is_none() {
            let bounds = self.gpu.bounds(resident.handle);
            resident.bounds = Some(bounds.map_err(|error| resident.error(error))?);
        }
        Ok(resident.bounds)
    }

    fn request_prefetch(&mut self, i: usize) {
        if let Some(resident) = self.resident_mut(i) {
            resident.prefetch_requested = true;
        }
    }

    fn record_cut(&mut self, i: usize) {
        if let Some(resident) = self.resident_mut(i) {
            resident.apply(Event::Edited);
        }
    }

    fn begin_edit(&mut self, i: usize, surface: &Surface) {
        if let Some(resident) = self.resident_mut(i) {
            resident.apply(Event::Edited);
            // The edit may move vertices out of the box of the GPU state.
            resident.bounds = None;
            (resident.version_before_edit).get_or_insert_with(|| surface.motion_version());
        }
    }

    fn upload_edits(&mut self, i: usize, body: &mut Body) -> Result<(), SceneError> {
        let Some(resident) = self.residents.get_mut(i).and_then(Option::as_mut) else {
            return Ok(());
        };
        if resident.residency != Residency::CpuAhead {
            return Ok(());
        }
        let (surface, solver) = body.parts();
        let before = resident.version_before_edit;
        if before.is_some_and(|before| before != surface.motion_version()) {
            // The solver tracks its own changes, but not positions set from outside.
            solver.mark_all_changed();
        }
        let sent = self.gpu.update(resident.handle, surface, solver);
        sent.map_err(|error| resident.error(error))?;
        resident.apply(Event::Uploaded);
        resident.version_before_edit = None;
        Ok(())
    }

    fn step(
        &mut self,
        bodies: &mut Bodies,
        params: &SceneParams,
        sleep: &mut Sleep,
        stats: &mut FrameStats,
    ) -> Result<(), SceneError> {
        self.frame += 1;
        let interval = u64::from(params.checkpoint);
        let is_checkpoint = interval > 0 && self.frame.is_multiple_of(interval);
        let is_cutting = stats.sweeps > 0;
        let has_others = bodies.len() > 1;
        let mut count = 0;
        for (i, (resident, body)) in self.residents.iter_mut().zip(&mut *bodies).enumerate() {
            let (Some(resident), Some(body)) = (resident, body) else {
                continue;
            };
            if resident.checkpoint_pending && !resident.residency.is_cpu_current() {
                let (surface, solver) = body.moved_parts();
                let done = self.gpu.collect(resident.handle, surface, solver);
                resident.checkpoint_pending = !done.map_err(|error| resident.error(error))?;
            }
            if sleep.is_asleep(i) {
                continue;
            }
            count += 1;
            let mut is_checkpoint = is_checkpoint;
            match sleep.begin_step(i, params.sleep.is_some()) {
                Step::First { is_last } => {
                    self.gpu.measure_motion(resident.handle)?;
                    if is_last {
                        self.gpu.prefetch_motion(resident.handle)?;
                    }
                }
                Step::LastObserved => self.gpu.prefetch_motion(resident.handle)?,
                Step::Decision => {
                    let is_at_rest = is_at_rest(&mut self.gpu, resident.handle, body, params);
                    let is_at_rest = is_at_rest.map_err(|error| resident.error(error))?;
                    sleep.set_at_rest(i, is_at_rest);
                    if is_at_rest {
                        // The body sleeps in this frame's box, and this is its last state.
                        self.gpu.prefetch_bounds(resident.handle)?;
                        is_checkpoint |= interval > 0;
                    }
                }
                Step::Other => {}
            }
            let is_tested = is_cutting && !params.skip_far_sweeps;
            if is_checkpoint || is_tested || resident.prefetch_requested {
                self.gpu.prefetch(resident.handle)?;
            }
            if is_cutting && params.skip_far_sweeps || has_others && params.contacts.is_some() {
                self.gpu.prefetch_bounds(resident.handle)?;
            }
            resident.checkpoint_pending |= is_checkpoint;
            resident.prefetch_requested = false;
            resident.apply(Event::Stepped);
            resident.bounds = None;
        }
        if count == 0 {
            return Ok(());
        }
        let stepped = self.residents.iter().zip(bodies).enumerate();
        let stepped = stepped.filter_map(|(i, (resident, body))| {
            if sleep.is_asleep(i) {
                return None;
            }
            let (resident, body) = (resident.as_ref()?, body.as_mut()?);
            Some((resident.handle, body.parts().1))
        });
        let done = self.gpu.step(stepped, params.dt, &params.solver)?;
        stats.gpu_bodies = count;
        stats.dispatches = done.dispatches;
        stats.whole_bodies = done.whole_bodies;
        stats.patch_bodies = done.patch_bodies;
        stats.kernels_compiled = done.kernels_compiled;
        stats.bytes_uploaded = done.bytes_uploaded;
        stats.bytes_read = done.bytes_read;
        Ok(())
    }

    fn wait(&self) -> Result<(), SceneError> {
        Ok(self.gpu.wait()?)
    }

    fn save(&mut self, bodies: &mut Bodies) {
        for (resident, body) in self.residents.iter().zip(&mut *bodies) {
            if let (Some(resident), Some(body)) = (resident, body)
                && !resident.residency.is_cpu_current()
            {
                // A checkpoint that has arrived can be read even from a GPU that failed since.
                let (surface, solver) = body.moved_parts();
                let _ = self.gpu.collect(resident.handle, surface, solver);
            }
        }
        for (i, body) in bodies.iter_mut().enumerate() {
            if let Some(body) = body
                && let Err(error) = self.read_back(i, body)
                && error.is_gpu_failure()
            {
                // All other readbacks would fail too.
                return;
            }
        }
    }

    fn backend(&self) -> &GpuBackend {
        &self.gpu
    }

    fn backend_mut(&mut self) -> &mut GpuBackend {
        &mut self.gpu
    }

    fn handle(&self, i: usize) -> Option<GpuBody> {
        self.resident(i).map(|resident| resident.handle)
    }
}

fn adapter_request(request: &BackendRequest) -> AdapterRequest {
    AdapterRequest {
        name: request.adapter.clone(),
        allow_software: request.allow_software,
        ..AdapterRequest::default()
    }
}

/// Returns whether a body was at rest in the observed frames.
///
/// The last of them is [`SleepParams::LAG`](crate::SleepParams::LAG) frames old, so the result has
/// arrived and needs no wait.
fn is_at_rest(
    gpu: &mut GpuBackend,
    handle: GpuBody,
    body: &Body,
    params: &SceneParams,
) -> Result<bool, GpuError> {
    let (Some(sleep), Some((displacement, bounds))) = (params.sleep, gpu.motion(handle)?) else {
        return Ok(false);
    };
    let edge = body.solver().resolution();
    let limit = sleep.limit(edge, &bounds, body.solver().substep().into());
    Ok(f64::from(displacement) <= limit)
}
