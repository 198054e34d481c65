//! The bodies of a scene that live on a device, and what the host knows of them.

use crate::backend::BackendRequest;
use crate::body::{Body, BodyId};
use crate::error::SceneError;
use crate::params::SceneParams;
use crate::scene::Bodies;
use crate::sleep::{Sleep, Step};
use crate::stats::FrameStats;
use incise_mesh::{Aabb, Surface};
use incise_pbd_gpu::{AdapterKind, AdapterRequest, Context, GpuBackend, GpuBody, GpuError};

/// A device with bodies.
#[derive(Debug)]
pub(crate) struct Device {
    gpu: GpuBackend,
    /// By body of the scene.
    residents: Vec<Option<Resident>>,
    /// How many constraints a body must have to live here.
    takes_from: usize,
    /// Frames so far.
    frame: u64,
}

/// A body on the device.
#[derive(Debug, Clone, Copy)]
struct Resident {
    handle: GpuBody,
    /// Whether the host's copy is as new as the device's, or newer.
    is_fresh: bool,
    /// Whether it is newer.
    is_edited: bool,
    /// What [`fingerprint`] said before somebody was given the body to edit.
    handed_out: Option<u64>,
    /// The device's box, once it was asked for.
    bounds: Option<Aabb>,
    /// Whether the next frame is likely to need the state.
    is_wanted: bool,
    /// Whether a checkpoint is on its way.
    awaits_checkpoint: bool,
}

impl Device {
    /// Opens the device that is asked for.
    pub(crate) fn open(request: &BackendRequest) -> Result<Self, SceneError> {
        Self::on(Context::open(&adapter_request(request))?)
    }

    /// Opens a device that is faster than the processor for some bodies; else says why there is none.
    pub(crate) fn open_faster(
        request: &BackendRequest,
        params: &SceneParams,
    ) -> Result<Self, String> {
        let real = AdapterRequest {
            allow_software: false,
            ..adapter_request(request)
        };
        let context = Context::open(&real).map_err(|error| error.to_string())?;
        if context.adapter().kind == AdapterKind::Software {
            let name = &context.adapter().name;
            return Err(format!(
                "{name} computes on the processor, which is faster without it"
            ));
        }
        let device = Self::on(context).map_err(|error| error.to_string())?;
        device.if_faster(request, params)
    }

    /// Works on an open device.
    pub(crate) fn on(context: Context) -> Result<Self, SceneError> {
        Ok(Self {
            gpu: GpuBackend::on(context)?,
            residents: Vec::new(),
            takes_from: 0,
            frame: 0,
        })
    }

    /// Finds out from which size on bodies are to live here; says why if there is none.
    pub(crate) fn if_faster(
        mut self,
        request: &BackendRequest,
        params: &SceneParams,
    ) -> Result<Self, String> {
        let takes_from = match request.device_from {
            Some(count) => Some(count),
            None => self
                .gpu
                .calibrate(params.dt, &params.solver)
                .map_err(|error| error.to_string())?,
        };
        match takes_from {
            Some(count) => {
                self.takes_from = count;
                Ok(self)
            }
            None => Err(format!(
                "{} was slower than the processor at every size that was measured",
                self.name()
            )),
        }
    }

    pub(crate) fn name(&self) -> &str {
        &self.gpu.adapter().name
    }

    pub(crate) fn takes_from(&self) -> usize {
        self.takes_from
    }

    pub(crate) fn gpu(&self) -> &GpuBackend {
        &self.gpu
    }

    pub(crate) fn gpu_mut(&mut self) -> &mut GpuBackend {
        &mut self.gpu
    }

    pub(crate) fn handle(&self, i: usize) -> Option<GpuBody> {
        self.resident(i).map(|r| r.handle)
    }

    pub(crate) fn holds(&self, i: usize) -> bool {
        self.resident(i).is_some()
    }

    fn resident(&self, i: usize) -> Option<&Resident> {
        self.residents.get(i)?.as_ref()
    }

    fn resident_mut(&mut self, i: usize) -> Option<&mut Resident> {
        self.residents.get_mut(i)?.as_mut()
    }

    /// Takes a body in if it is large enough.
    pub(crate) fn add(&mut self, i: usize, body: &mut Body) -> Result<(), SceneError> {
        if self.holds(i) || body.constraints() < self.takes_from {
            return Ok(());
        }
        let (surface, solver) = body.parts();
        let handle = self.gpu.add(surface, solver)?;
        if self.residents.len() <= i {
            self.residents.resize(i + 1, None);
        }
        self.residents[i] = Some(Resident {
            handle,
            is_fresh: true,
            is_edited: false,
            handed_out: None,
            bounds: None,
            is_wanted: false,
            awaits_checkpoint: false,
        });
        Ok(())
    }

    /// Gives a body's room back.
    pub(crate) fn remove(&mut self, i: usize) {
        if let Some(resident) = self.residents.get_mut(i).and_then(Option::take) {
            self.gpu.remove(resident.handle);
        }
    }

    /// Whether the host's copy of a body is what the body is.
    pub(crate) fn is_fresh(&self, i: usize) -> bool {
        self.resident(i).is_none_or(|r| r.is_fresh)
    }

    /// Brings the host's copy up to date; tells whether it was behind.
    pub(crate) fn read(&mut self, i: usize, body: &mut Body) -> Result<bool, SceneError> {
        let Some(resident) = self.residents.get_mut(i).and_then(Option::as_mut) else {
            return Ok(false);
        };
        if resident.is_fresh {
            return Ok(false);
        }
        let (surface, solver) = body.moved_parts();
        self.gpu
            .read(resident.handle, surface, solver)
            .map_err(|error| of_body(i, error))?;
        resident.is_fresh = true;
        Ok(true)
    }

    /// The box of a body that the host's copy is behind of.
    pub(crate) fn bounds(&mut self, i: usize) -> Result<Option<Aabb>, SceneError> {
        let Some(resident) = self.residents.get_mut(i).and_then(Option::as_mut) else {
            return Ok(None);
        };
        if !resident.is_fresh && resident.bounds.is_none() {
            let bounds = self.gpu.bounds(resident.handle);
            resident.bounds = Some(bounds.map_err(|error| of_body(i, error))?);
        }
        Ok(resident.bounds)
    }

    /// Says that the next frame is likely to need the state.
    pub(crate) fn want(&mut self, i: usize) {
        if let Some(resident) = self.resident_mut(i) {
            resident.is_wanted = true;
        }
    }

    /// Says that the host's copy, which is fresh, was cut.
    pub(crate) fn note_cut(&mut self, i: usize) {
        if let Some(resident) = self.resident_mut(i) {
            resident.is_edited = true;
        }
    }

    /// Says that the host's copy, which is fresh, is given to somebody to edit.
    pub(crate) fn hand_out(&mut self, i: usize, surface: &Surface) {
        if let Some(resident) = self.resident_mut(i) {
            resident.is_edited = true;
            // The device's box is not that of what is put elsewhere.
            resident.bounds = None;
            if resident.handed_out.is_none() {
                resident.handed_out = Some(fingerprint(surface));
            }
        }
    }

    /// Sends what was edited of a body.
    pub(crate) fn send_edits(&mut self, i: usize, body: &mut Body) -> Result<(), SceneError> {
        let Some(resident) = self.residents.get_mut(i).and_then(Option::as_mut) else {
            return Ok(());
        };
        if !resident.is_edited {
            return Ok(());
        }
        let (surface, solver) = body.parts();
        if (resident.handed_out).is_some_and(|before| before != fingerprint(surface)) {
            // Somebody has set positions, of which a solver hears nothing.
            solver.mark_all_changed();
        }
        let sent = self.gpu.update(resident.handle, surface, solver);
        sent.map_err(|error| of_body(i, error))?;
        resident.is_edited = false;
        resident.handed_out = None;
        Ok(())
    }

    /// Steps all bodies that live here, and returns while the device works.
    pub(crate) fn step(
        &mut self,
        bodies: &mut Bodies,
        params: &SceneParams,
        sleep: &mut Sleep,
        stats: &mut FrameStats,
    ) -> Result<(), SceneError> {
        self.frame += 1;
        let every = u64::from(params.checkpoint);
        let is_due = every > 0 && self.frame.is_multiple_of(every);
        let is_cutting = stats.sweeps > 0;
        let mut count = 0;
        for (i, (resident, body)) in self.residents.iter_mut().zip(&mut *bodies).enumerate() {
            let (Some(resident), Some(body)) = (resident, body) else {
                continue;
            };
            if resident.awaits_checkpoint && !resident.is_fresh {
                let (surface, solver) = body.moved_parts();
                let done = self.gpu.collect(resident.handle, surface, solver);
                resident.awaits_checkpoint = !done.map_err(|error| of_body(i, error))?;
            }
            if sleep.is_asleep(i) {
                continue;
            }
            count += 1;
            let mut is_due = is_due;
            match sleep.begin_step(i, params.sleep.is_some()) {
                Step::First { is_last } => {
                    self.gpu.watch(resident.handle)?;
                    if is_last {
                        self.gpu.prefetch_motion(resident.handle)?;
                    }
                }
                Step::LastThatCounts => self.gpu.prefetch_motion(resident.handle)?,
                Step::Last => {
                    let is_quiet = is_quiet(&mut self.gpu, resident.handle, body, params);
                    let is_quiet = is_quiet.map_err(|error| of_body(i, error))?;
                    sleep.judge(i, is_quiet);
                    if is_quiet {
                        // It sleeps in this frame's box, and its state is the last one for long.
                        self.gpu.prefetch_bounds(resident.handle)?;
                        is_due |= every > 0;
                    }
                }
                Step::Other => {}
            }
            let is_tested = is_cutting && !params.skip_far_sweeps;
            if is_due || is_tested || resident.is_wanted {
                self.gpu.prefetch(resident.handle)?;
            }
            if is_cutting && params.skip_far_sweeps {
                self.gpu.prefetch_bounds(resident.handle)?;
            }
            resident.awaits_checkpoint |= is_due;
            resident.is_wanted = false;
            resident.is_fresh = false;
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
        stats.bodies_on_device = count;
        stats.dispatches = done.dispatches;
        stats.whole_bodies = done.whole_bodies;
        stats.color_bodies = done.color_bodies;
        stats.patch_bodies = done.patch_bodies;
        stats.kernels_compiled = done.kernels_compiled;
        stats.bytes_uploaded = done.bytes_uploaded;
        stats.bytes_read = done.bytes_read;
        Ok(())
    }

    /// Waits until the device has done everything that it was asked for.
    pub(crate) fn wait(&self) -> Result<(), SceneError> {
        Ok(self.gpu.wait()?)
    }

    /// Brings home what the device still hands out.
    pub(crate) fn save(&mut self, bodies: &mut Bodies) {
        for (resident, body) in self.residents.iter().zip(&mut *bodies) {
            if let (Some(resident), Some(body)) = (resident, body)
                && !resident.is_fresh
            {
                // What has arrived is there, whatever became of the device. If not, so be it.
                let (surface, solver) = body.moved_parts();
                let _ = self.gpu.collect(resident.handle, surface, solver);
            }
        }
        for (i, body) in bodies.iter_mut().enumerate() {
            if let Some(body) = body
                && let Err(error) = self.read(i, body)
                && error.is_of_device()
            {
                // The others would wait in vain too.
                return;
            }
        }
    }
}

fn adapter_request(request: &BackendRequest) -> AdapterRequest {
    AdapterRequest {
        name: request.adapter.clone(),
        allow_software: request.allow_software,
        ..AdapterRequest::default()
    }
}

/// Whether a body was at rest in the frames that count, the last of which is so long ago that nobody waits.
fn is_quiet(
    gpu: &mut GpuBackend,
    handle: GpuBody,
    body: &Body,
    params: &SceneParams,
) -> Result<bool, GpuError> {
    let (Some(sleep), Some((farthest, bounds))) = (params.sleep, gpu.motion(handle)?) else {
        return Ok(false);
    };
    let edge = body.solver().mean_rest_length();
    let h = f64::from(params.dt) / f64::from(params.solver.substeps);
    let limit = sleep.limit(edge, &bounds, h);
    Ok(f64::from(farthest) <= limit)
}

/// A body's own error names the body; everything else is the device's.
fn of_body(i: usize, error: GpuError) -> SceneError {
    match error {
        GpuError::Step(error) => SceneError::Step {
            body: BodyId(i),
            error,
        },
        error => SceneError::Gpu(error),
    }
}

/// A number that differs when positions do. Inverse masses are the solver's, which notes them.
fn fingerprint(surface: &Surface) -> u64 {
    let start = surface.positions.len() as u64;
    let coordinates = surface.positions.iter().flat_map(|&[x, y, z, _]| [x, y, z]);
    coordinates.fold(start, |hash, c| {
        // FNV-1a by words: a product with an odd number loses nothing.
        (hash ^ u64::from(c.to_bits()))
            .wrapping_mul(0x0000_0100_0000_01b3)
            .rotate_left(23)
    })
}
