//! Bodies that live on a device.

use super::adapter::{AdapterRequest, AdapterSummary};
use super::arena::Arena;
use super::body::{Arenas, DeviceBody, POSITIONS};
use super::context::Context;
use super::error::GpuError;
use super::layout::{BodyRecord, RUNS_PER_BODY, Report, Run};
use super::pipelines::Pipelines;
use super::program::Program;
use super::readback::Readback;
use super::stats::{GpuMemory, GpuStats, Schedule};
use super::stopwatch::Stopwatch;
use super::uniforms::Uniforms;
use super::upload::Uploads;
use crate::changes::Changes;
use crate::plan::StepPlan;
use crate::solver::Solver;
use incise_mesh::Surface;
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};

/// A number that nobody else has, in whichever backend; it is not 0.
pub(super) fn number() -> u64 {
    static NEXT: AtomicU64 = AtomicU64::new(1);
    NEXT.fetch_add(1, Ordering::Relaxed)
}

/// How many frames the host may be ahead of the device. Without an end to it frames that are still to be
/// done would fill the memory.
pub(super) const FRAMES_IN_FLIGHT: usize = 3;

/// A body of a [`GpuBackend`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct GpuBody {
    slot: u32,
    /// Tells bodies apart that have the same slot, one after the other or in other backends.
    number: u64,
}

/// A body and what the host expects of it.
#[derive(Debug)]
pub(super) struct Resident {
    pub(super) body: DeviceBody,
    number: u64,
    /// Under which number its solver knows it; 0 before the first upload.
    pub(super) follower: u64,
    /// The frame that stepped or edited it last.
    pub(super) frame: u64,
    /// The frame that the host's copy is of.
    pub(super) host: u64,
    /// The plan in the program.
    pub(super) plan: StepPlan,
    /// Positions, velocities and report.
    pub(super) state: Readback,
    pub(super) wants_state: bool,
    /// The report alone.
    pub(super) report: Readback,
    pub(super) wants_report: bool,
    /// The report of the last frame that counts for [`GpuBackend::motion`].
    pub(super) motion: Readback,
    pub(super) wants_motion: bool,
    /// Whether it is noted how far the body moves.
    pub(super) is_watched: bool,
}

/// Steps bodies on a device: the passes of their [`StepPlan`](crate::StepPlan)s in the same order as
/// [`CpuBackend`](crate::CpuBackend) has them, so that both differ by the device's rounding alone.
///
/// Bodies stay on the device. The host's surface is behind until [`GpuBackend::read`] is called; what
/// the host edits is sent by [`GpuBackend::update`], as little as was touched.
///
/// After an error the bodies on the host are as they were when they were last read. After
/// [`GpuError::DeviceLost`] the backend is of no more use.
///
/// ```no_run
/// use incise_mesh::{Model, build_model};
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
    /// The slots that the program steps, and those of the step at hand.
    pub(super) program_of: Vec<u32>,
    pub(super) stepped: Vec<u32>,
    pub(super) program_is_stale: bool,
    pub(super) stats: GpuStats,
    pub(super) bytes_read: u64,
    /// Frames and edits so far.
    pub(super) frame: u64,
    /// The last frames that were handed over, the oldest first.
    pub(super) in_flight: [Option<wgpu::SubmissionIndex>; FRAMES_IN_FLIGHT],
    /// By slot.
    pub(super) residents: Vec<Option<Resident>>,
    pub(super) schedule: Option<Schedule>,
    /// None while nobody wants to know how long steps take.
    pub(super) stopwatch: Option<Stopwatch>,
    /// What a solver hands over; its content matters to nobody between calls.
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
        Self::on(Context::open(request)?)
    }

    /// Works on an open device, a renderer's say.
    ///
    /// # Errors
    /// [`GpuError`] when the device refuses the first buffers.
    pub fn on(context: Context) -> Result<Self, GpuError> {
        let vertices = [
            ("positions", 16, true),
            ("velocities", 16, true),
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
            stopwatch: None,
            changes: Changes::default(),
            context,
        })
    }

    /// The adapter that the bodies live on.
    #[must_use]
    pub fn adapter(&self) -> &AdapterSummary {
        self.context.adapter()
    }

    /// The device and its queue, for a renderer.
    #[must_use]
    pub fn context(&self) -> &Context {
        &self.context
    }

    /// What the last step did.
    #[must_use]
    pub fn stats(&self) -> &GpuStats {
        &self.stats
    }

    /// The names of the kernels that were compiled so far: those that bodies needed.
    pub fn kernels(&self) -> impl Iterator<Item = &'static str> {
        self.pipelines.names()
    }

    /// What the bodies take on the device, without parameters of dispatches and copies on their way.
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

    /// How a body is stepped.
    ///
    /// # Errors
    /// [`GpuError::UnknownBody`].
    pub fn schedule(&self, body: GpuBody) -> Result<Schedule, GpuError> {
        Ok(self.resident(body)?.body.schedule)
    }

    /// Asks for one schedule instead of the one that is fastest, for bodies that are added from now on.
    /// A body that cannot have it gets the one that it would have had.
    pub fn force_schedule(&mut self, schedule: Option<Schedule>) {
        self.schedule = schedule;
    }

    /// Takes a body in. Surface and solver belong together.
    ///
    /// # Errors
    /// [`GpuError`] when the device has no room for it; nothing is changed then.
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
            is_watched: false,
        });
        let body = GpuBody { slot, number };
        solver.mark_all_changed();
        if let Err(error) = self.update(body, surface, solver) {
            self.remove(body);
            return Err(error);
        }
        Ok(body)
    }

    /// Gives a body's room back. The host's copy stays as it was when it was last read. Unknown bodies
    /// are passed over.
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

    /// Waits until the device has done everything that it was asked for.
    ///
    /// # Errors
    /// [`GpuError`] of what went wrong since the last call.
    pub fn wait(&self) -> Result<(), GpuError> {
        let nothing: [wgpu::CommandBuffer; 0] = [];
        let last = self.context.queue().submit(nothing);
        self.context.wait(last)
    }

    /// Where a body's positions lie, for a renderer: the buffer and the part of it \[bytes\], xyz and
    /// inverse mass a vertex slot. Valid until the next [`GpuBackend::add`],
    /// [`GpuBackend::update`] or [`GpuBackend::calibrate`].
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
