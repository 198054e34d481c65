//! The GPU backend and its resident bodies: creation, addition and removal.

use super::adapter::{AdapterRequest, AdapterSummary};
use super::arena::Arena;
use super::body::{Arenas, DeviceBody, POSITIONS};
use super::context::Context;
use super::error::GpuError;
use super::layout::{BodyRecord, Motion, RUNS_PER_BODY, Report, Run};
use super::pipelines::Pipelines;
use super::program::Program;
use super::readback::Readback;
use super::stats::{GpuMemory, GpuStats, Schedule};
use super::timestamps::Timestamps;
use super::uniforms::Uniforms;
use super::upload::Uploads;
use crate::follow::changes::Changes;
use crate::solver::Solver;
use crate::step::plan::StepPlan;
use incise_mesh::Surface;
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};

/// Returns a process-wide unique nonzero number.
pub(super) fn number() -> u64 {
    static NEXT: AtomicU64 = AtomicU64::new(1);
    NEXT.fetch_add(1, Ordering::Relaxed)
}

/// Maximum number of frames in flight; it bounds the memory of queued frames.
pub(super) const FRAMES_IN_FLIGHT: usize = 3;

/// A body of a [`GpuBackend`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct GpuBody {
    slot: u32,
    /// Distinguishes bodies that use the same slot successively or in other backends.
    number: u64,
}

/// A GPU body with the CPU side's bookkeeping.
#[derive(Debug)]
pub(super) struct Resident {
    pub(super) body: DeviceBody,
    number: u64,
    /// Follower number in the solver's change log; 0 before the first upload.
    pub(super) follower: u64,
    /// Last frame that stepped or edited the body.
    pub(super) frame: u64,
    /// Frame of the CPU copy.
    pub(super) host: u64,
    /// Plan in the current program.
    pub(super) plan: StepPlan,
    /// Positions, velocities and report.
    pub(super) state: Readback,
    pub(super) wants_state: bool,
    /// Readback of the report alone.
    pub(super) report: Readback,
    pub(super) wants_report: bool,
    /// Readback of the last report for [`GpuBackend::motion`].
    pub(super) motion: Readback,
    pub(super) wants_motion: bool,
    /// True if the motion of the body is measured.
    pub(super) measures_motion: bool,
}

/// Steps bodies on a GPU.
///
/// It executes the passes of each [`StepPlan`](crate::StepPlan) in the order of
/// [`Solver::step`](crate::Solver::step), so that results differ only by the rounding of the GPU.
///
/// Bodies stay in GPU memory. [`GpuBackend::read`] updates the CPU copy, and
/// [`GpuBackend::update`] uploads what was edited in it.
///
/// After an error the CPU copies are in the state of the last read. After
/// [`GpuError::DeviceLost`] the backend cannot be used any more.
///
/// ```no_run
/// use incise_models::{Model, build_model};
/// use incise_pbd_gpu::{AdapterRequest, GpuBackend, Material, Solver, SolverParams};
///
/// let mut surface = build_model(Model::Armadillo);
/// let mut solver = Solver::new(&mut surface, &Material::default())?;
/// let mut gpu = GpuBackend::new(&AdapterRequest::default())?;
/// let body = gpu.add(&surface, &mut solver)?;
/// for _ in 0..60 {
///     gpu.step([(body, &mut solver)], 1.0 / 60.0, &SolverParams::default())?;
/// }
/// gpu.read(body, &mut surface, &mut solver)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct GpuBackend {
    pub(super) context: Context,
    pub(super) pipelines: Pipelines,
    pub(super) arenas: Arenas,
    pub(super) uploads: Uploads,
    pub(super) uniforms: Uniforms,
    pub(super) program: Program,
    /// Slots that the program steps, and slots of the current step.
    pub(super) program_of: Vec<u32>,
    pub(super) stepped: Vec<u32>,
    pub(super) program_is_stale: bool,
    pub(super) stats: GpuStats,
    pub(super) bytes_read: u64,
    /// Frames and edits so far.
    pub(super) frame: u64,
    /// Last submitted frames, oldest first.
    pub(super) in_flight: [Option<wgpu::SubmissionIndex>; FRAMES_IN_FLIGHT],
    /// By slot.
    pub(super) residents: Vec<Option<Resident>>,
    pub(super) schedule: Option<Schedule>,
    /// Timestamp queries, if steps are timed.
    pub(super) timestamps: Option<Timestamps>,
    /// Scratch memory for the changes of a solver.
    pub(super) changes: Changes,
}

impl GpuBody {
    pub(super) const fn slot(self) -> u32 {
        self.slot
    }
}

impl GpuBackend {
    /// Opens an adapter.
    ///
    /// # Errors
    /// As [`Context::open`].
    pub fn new(request: &AdapterRequest) -> Result<Self, GpuError> {
        Self::from_context(Context::open(request)?)
    }

    /// Creates a backend on an open device, for example that of a renderer.
    ///
    /// Backends on clones of a context share its kernels, so that only the first one compiles them.
    ///
    /// # Errors
    /// [`GpuError`] if the initial buffers cannot be created.
    pub fn from_context(context: Context) -> Result<Self, GpuError> {
        let vertices = [
            ("positions", 16, true),
            ("motions", size_of::<Motion>() as u64, true),
            ("displacements", 16, false),
        ];
        let bodies = [
            ("bodies", size_of::<BodyRecord>() as u64, true),
            ("runs", (RUNS_PER_BODY * size_of::<Run>()) as u64, true),
            ("reports", size_of::<Report>() as u64, true),
        ];
        Ok(Self {
            pipelines: Pipelines::new(&context)?,
            arenas: Arenas {
                vertices: Arena::new(&context, &vertices, 1 << 12)?,
                entries: Arena::new(&context, &[("constraints", 8, true)], 1 << 16)?,
                bodies: Arena::new(&context, &bodies, 4)?,
            },
            uploads: Uploads::new(),
            uniforms: Uniforms::new(&context)?,
            program: Program::default(),
            program_of: Vec::new(),
            stepped: Vec::new(),
            program_is_stale: true,
            stats: GpuStats::default(),
            bytes_read: 0,
            frame: 0,
            in_flight: [const { None }; FRAMES_IN_FLIGHT],
            residents: Vec::new(),
            schedule: None,
            timestamps: None,
            changes: Changes::default(),
            context,
        })
    }

    /// Returns the adapter.
    #[must_use]
    pub fn adapter(&self) -> &AdapterSummary {
        self.context.adapter()
    }

    /// Returns device and queue, for a renderer.
    #[must_use]
    pub fn context(&self) -> &Context {
        &self.context
    }

    /// Returns the statistics of the last step.
    #[must_use]
    pub fn stats(&self) -> &GpuStats {
        &self.stats
    }

    /// Returns the names of the kernels that steps have used; kernels are compiled on first use.
    pub fn kernels(&self) -> impl Iterator<Item = &'static str> {
        self.pipelines.names()
    }

    /// Returns the GPU memory of the bodies, without uniforms and staging buffers.
    #[must_use]
    pub fn memory(&self) -> GpuMemory {
        let arenas = [
            &self.arenas.vertices,
            &self.arenas.entries,
            &self.arenas.bodies,
        ];
        arenas.iter().map(|arena| arena.memory()).fold(
            GpuMemory::default(),
            |sum, GpuMemory { reserved, rented }| GpuMemory {
                reserved: sum.reserved + reserved,
                rented: sum.rented + rented,
            },
        )
    }

    /// Returns the schedule of a body.
    ///
    /// # Errors
    /// [`GpuError::UnknownBody`].
    pub fn schedule(&self, body: GpuBody) -> Result<Schedule, GpuError> {
        Ok(self.resident(body)?.body.schedule)
    }

    /// Overrides the schedule of bodies that are added from now on.
    ///
    /// A body that does not fit in a workgroup is stepped by [`Schedule::Patches`] in any case.
    pub fn force_schedule(&mut self, schedule: Option<Schedule>) {
        self.schedule = schedule;
    }

    /// Adds a body and uploads it. The solver must be that of the surface.
    ///
    /// # Errors
    /// [`GpuError`] if the body does not fit in GPU memory; nothing is changed then.
    pub fn add(&mut self, surface: &Surface, solver: &mut Solver) -> Result<GpuBody, GpuError> {
        let (slots, _) = self.arenas.bodies.allocate(&self.context, 1)?;
        let slot = slots.start;
        let i = slot as usize;
        if self.residents.len() <= i {
            self.residents.resize_with(i + 1, || None);
        }
        let number = number();
        self.residents[i] = Some(Resident {
            body: DeviceBody::new(slot),
            number,
            follower: 0,
            frame: 0,
            host: 0,
            plan: StepPlan::default(),
            state: Readback::default(),
            wants_state: false,
            report: Readback::default(),
            wants_report: false,
            motion: Readback::default(),
            wants_motion: false,
            measures_motion: false,
        });
        let body = GpuBody { slot, number };
        solver.mark_all_changed();
        if let Err(error) = self.update(body, surface, solver) {
            self.remove(body);
            return Err(error);
        }
        Ok(body)
    }

    /// Removes a body and frees its memory. Unknown bodies are ignored.
    ///
    /// The CPU copy keeps the state of the last read.
    pub fn remove(&mut self, body: GpuBody) {
        if self.resident(body).is_err() {
            return;
        }
        let i = body.slot as usize;
        if let Some(mut resident) = self.residents[i].take() {
            resident.body.free(&mut self.arenas);
            self.arenas.bodies.free(body.slot..body.slot + 1);
            self.program_is_stale = true;
        }
    }

    /// Blocks until all submitted work is done.
    ///
    /// # Errors
    /// The first [`GpuError`] since the last call.
    pub fn wait(&self) -> Result<(), GpuError> {
        let nothing: [wgpu::CommandBuffer; 0] = [];
        let last = self.context.queue().submit(nothing);
        self.context.wait(last)
    }

    /// Returns buffer and byte range of a body's positions, for a renderer.
    ///
    /// Each vertex slot has x, y, z \[m\] and inverse mass. The range is valid until the next
    /// [`GpuBackend::add`], [`GpuBackend::update`] or [`GpuBackend::calibrate`].
    ///
    /// # Errors
    /// [`GpuError::UnknownBody`].
    pub fn positions(&self, body: GpuBody) -> Result<(&wgpu::Buffer, Range<u64>), GpuError> {
        let body = &self.resident(body)?.body;
        let start = u64::from(body.first_vertex()) * 16;
        let end = start + u64::from(body.vertex_count) * 16;
        Ok((self.arenas.vertices.buffer(POSITIONS), start..end))
    }

    pub(super) fn resident(&self, body: GpuBody) -> Result<&Resident, GpuError> {
        let i = body.slot as usize;
        match self.residents.get(i) {
            Some(Some(resident)) if resident.number == body.number => Ok(resident),
            _ => Err(GpuError::UnknownBody),
        }
    }

    pub(super) fn resident_mut(&mut self, body: GpuBody) -> Result<&mut Resident, GpuError> {
        find_mut(&mut self.residents, body)
    }

    pub(super) fn resident_at(&mut self, slot: u32) -> Option<&mut Resident> {
        self.residents.get_mut(slot as usize)?.as_mut()
    }
}

pub(super) fn find_mut(
    residents: &mut [Option<Resident>],
    body: GpuBody,
) -> Result<&mut Resident, GpuError> {
    let i = body.slot as usize;
    match residents.get_mut(i) {
        Some(Some(resident)) if resident.number == body.number => Ok(resident),
        _ => Err(GpuError::UnknownBody),
    }
}
