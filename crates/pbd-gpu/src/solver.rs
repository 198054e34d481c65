//! A body in motion.

use crate::backend::{Backend, CpuBackend};
use crate::changes::VertexLogs;
use crate::colliders::Colliders;
use crate::coloring::LAYERS;
use crate::concerned::NONE;
use crate::constraints::{BendingSet, StretchSet, room_beside};
use crate::contacts::ContactSet;
use crate::delta::{DroppedPin, Following};
use crate::edges::{EdgeTable, Lists, Sets};
use crate::error::{ConstraintError, StepError};
use crate::keepsake::Keepsake;
use crate::kernels::integrate::{are_finite, first_non_finite};
use crate::mass::masses;
use crate::material::{Material, Stiffness, Volume};
use crate::params::{Integrator, SolverParams, StepStats};
use crate::patches::{PatchParams, Patches};
use crate::plan::{Body, Pass, Pin, StepPlan};
use crate::second_order::{History, Orders, SHORTER};
use crate::tethers::{Tether, Tethers};
use crate::volumes::VolumeSet;
use incise_mesh::{Surface, VertexId};

/// Moves one surface by position based dynamics: the paper's Algorithm 1, and XPBD where a material
/// has compliance. Particle i is vertex i; positions and inverse masses live in
/// [`Surface::positions`], everything else lives here.
#[derive(Debug, Clone)]
pub struct Solver {
    pub(crate) material: Material,
    pub(crate) mass: Vec<f32>,
    pub(crate) velocities: Vec<[f32; 4]>,
    pub(crate) stretch: StretchSet,
    pub(crate) bending: Option<BendingSet>,
    pub(crate) struts: Option<StretchSet>,
    /// The vertices whose struts the last edit took.
    pub(crate) lost_struts: Vec<VertexId>,
    pub(crate) volumes: VolumeSet,
    pub(crate) contacts: ContactSet,
    pub(crate) colliders: Colliders,
    pub(crate) edges: EdgeTable,
    pub(crate) patches: Option<Patches>,
    pub(crate) pins: Vec<Pin>,
    /// Pins that went with their vertices, the newest last.
    pub(crate) dropped_pins: Vec<DroppedPin>,
    /// What the last edits shared out, the newest last, as long as nothing moves.
    pub(crate) keepsakes: Vec<Keepsake>,
    pub(crate) tethers: Tethers,
    pub(crate) plan: StepPlan,
    pub(crate) changes: VertexLogs,
    /// Where a vertex stands in a list while an edit is followed, shape [vertex slots].
    pub(crate) numbers: Vec<u32>,
    pub(crate) following: Following,
    history: History,
    /// The substep that errors may be left of \[s\].
    pub(crate) longest: f32,
    stats: StepStats,
    cpu: CpuBackend,
}

impl Solver {
    /// Makes the constraints of a surface and sets the inverse masses in its positions. Nothing is
    /// pinned and nothing moves.
    ///
    /// # Errors
    /// [`ConstraintError`] when the material has a number out of range, a position is not finite, an
    /// edge has no length at rest, or there is no area or volume to take the mass from. The surface is
    /// as it was then.
    pub fn new(surface: &mut Surface, material: &Material) -> Result<Self, ConstraintError> {
        Self::build(surface, material, None)
    }

    /// As [`Solver::new`], with the body divided into patches: constraints get layers of colors
    /// ([`LAYERS`]) by the patches of their vertices, so that a backend can project what lies within a
    /// patch close to the patch. The order of projections is another one, the result as good. Patches
    /// follow edits. Worth it for large bodies on a device; the CPU gains nothing by it.
    ///
    /// # Errors
    /// As [`Solver::new`], and [`ConstraintError::BadPatches`].
    pub fn with_patches(
        surface: &mut Surface,
        material: &Material,
        params: &PatchParams,
    ) -> Result<Self, ConstraintError> {
        params.check()?;
        Self::build(surface, material, Some(params))
    }

    fn build(
        surface: &mut Surface,
        material: &Material,
        patches: Option<&PatchParams>,
    ) -> Result<Self, ConstraintError> {
        material.check()?;
        for v in surface.topology().vertices() {
            let p = surface.positions[v.index()];
            let finite = |c: &f32| c.is_finite();
            if !(p[..3].iter().all(finite) && surface.rest[v.index()].iter().all(finite)) {
                return Err(ConstraintError::NonFinitePosition { vertex: v });
            }
        }
        let slots = surface.topology().vertex_slots();
        let layers = if patches.is_some() { LAYERS } else { 1 };
        let mut stretch = StretchSet::with_layers(slots, layers);
        let mut bending = (material.bending).map(|_| BendingSet::with_layers(slots, layers));
        let topology = surface.topology();
        let mut edges = EdgeTable::default();
        edges.resize_triangles(topology.triangle_slots());
        let mut lists = Lists::default();
        for t in topology.triangles() {
            edges.add_triangle(t, topology, &mut lists);
        }
        let mut patches =
            patches.map(|params| Patches::new(params, surface, &edges, bending.is_some()));
        let mut sets = Sets {
            stretch: &mut stretch,
            bending: bending.as_mut(),
            patches: patches.as_mut(),
        };
        edges.add_missing(&lists, surface, &mut sets);
        for batch in stretch.all() {
            if let Some(i) = batch.rest().iter().position(|&length| length <= 0.0) {
                let [a, b] = batch.vertices()[i];
                return Err(ConstraintError::ZeroRestLength { a, b });
            }
        }
        let mass = masses(surface, material)?;
        for (position, &mass) in surface.positions.iter_mut().zip(&mass) {
            position[3] = inverse(mass);
        }
        let mut solver = Self {
            material: *material,
            velocities: vec![[0.0; 4]; slots],
            mass,
            stretch,
            bending,
            struts: (material.struts).map(|_| StretchSet::with_layers(slots, 1)),
            lost_struts: Vec::new(),
            volumes: VolumeSet::default(),
            contacts: ContactSet::default(),
            colliders: Colliders::default(),
            edges,
            patches,
            pins: Vec::new(),
            dropped_pins: Vec::new(),
            keepsakes: Vec::new(),
            tethers: Tethers::default(),
            plan: StepPlan::default(),
            changes: VertexLogs::default(),
            numbers: vec![NONE; slots],
            following: Following::default(),
            history: History::default(),
            longest: 0.0,
            stats: StepStats::default(),
            cpu: CpuBackend::default(),
        };
        solver.reserve();
        solver.update_volumes(surface);
        Ok(solver)
    }

    /// Makes room for edits, which else would begin with a copy of every array.
    fn reserve(&mut self) {
        let vertices = room_beside(self.mass.len());
        self.mass.reserve(vertices);
        self.velocities.reserve(vertices);
        self.numbers.reserve(vertices);
        self.edges.reserve();
        self.stretch.reserve(vertices);
        if let Some(bending) = &mut self.bending {
            bending.reserve(vertices);
        }
        if let Some(struts) = &mut self.struts {
            struts.reserve(vertices);
        }
    }

    /// Steps by one frame of `dt` \[s\] on the CPU. Allocates nothing once warm.
    ///
    /// # Errors
    /// [`StepError`]. After [`StepError::NonFinitePosition`] the body has to be set up again; after any
    /// other it is as it was.
    pub fn step(
        &mut self,
        surface: &mut Surface,
        dt: f32,
        params: &SolverParams,
    ) -> Result<&StepStats, StepError> {
        let mut cpu = std::mem::take(&mut self.cpu);
        let done = self.step_on(&mut cpu, surface, dt, params).map(|_| ());
        self.cpu = cpu;
        done.map(|()| &self.stats)
    }

    /// Steps by one frame of `dt` \[s\] on a backend.
    ///
    /// # Errors
    /// As [`Solver::step`].
    pub fn step_on(
        &mut self,
        backend: &mut impl Backend,
        surface: &mut Surface,
        dt: f32,
        params: &SolverParams,
    ) -> Result<&StepStats, StepError> {
        params.check(dt)?;
        let slots = surface.positions.len();
        if slots != self.mass.len() {
            return Err(StepError::SurfaceMismatch {
                surface: slots,
                solver: self.mass.len(),
            });
        }
        if !are_finite(&surface.positions) {
            let vertex = first_non_finite(&surface.positions);
            return Err(StepError::NonFiniteInput { vertex });
        }
        let constants = self.prepare(dt, params)?;
        let h = constants.h;
        let order = |h| {
            let mut order = self.constants_of(h, 1, params);
            order.stretch.old = constants.stretch.old;
            order.bending.old = constants.bending.old;
            order.struts.old = constants.struts.old;
            order.volume.old = constants.volume.old;
            order
        };
        let orders = Orders {
            first: order(h),
            second: order(SHORTER * h),
        };
        let (positions, topology) = surface.positions_and_topology();
        let mut body = Body {
            positions,
            velocities: &mut self.velocities,
            stretch: &mut self.stretch,
            bending: self.bending.as_mut(),
            struts: self.struts.as_mut(),
            volumes: &mut self.volumes,
            contacts: &mut self.contacts,
            colliders: &self.colliders.records,
            topology,
            pins: &self.pins,
            tethers: self.tethers.list(),
        };
        let done = match params.integrator {
            Integrator::Euler => {
                self.history.forget();
                backend.execute(&self.plan, &constants, &mut body)
            }
            Integrator::Bdf2 => {
                let history = &mut self.history;
                history.execute(backend, &self.plan, &orders, params.substeps, &mut body)
            }
        };
        self.changes.everything();
        self.stats = done?;
        Ok(&self.stats)
    }

    /// What the body is made of.
    #[must_use]
    pub fn material(&self) -> &Material {
        &self.material
    }

    /// Changes how hard edges resist from the next frame on.
    ///
    /// # Errors
    /// [`ConstraintError`] when the number is out of its range; nothing is changed then.
    pub fn set_stretch(&mut self, stiffness: Stiffness) -> Result<(), ConstraintError> {
        let material = Material {
            stretch: stiffness,
            ..self.material
        };
        material.check()?;
        self.material = material;
        Ok(())
    }

    /// Changes the rate at which velocities decay [1/s] from the next frame on.
    ///
    /// # Errors
    /// [`ConstraintError`] when the number is out of its range; nothing is changed then.
    pub fn set_damping(&mut self, damping: f32) -> Result<(), ConstraintError> {
        let material = Material {
            damping,
            ..self.material
        };
        material.check()?;
        self.material = material;
        Ok(())
    }

    /// Changes what the body's inside does from the next frame on, be it more pressure, or that it does anything at all.
    ///
    /// # Errors
    /// [`ConstraintError`] when a number is out of its range; nothing is changed then.
    pub fn set_volume(
        &mut self,
        surface: &Surface,
        volume: Option<Volume>,
    ) -> Result<(), ConstraintError> {
        let material = Material {
            volume,
            ..self.material
        };
        material.check()?;
        let before = std::mem::replace(&mut self.material, material).volume;
        if before.is_some() != volume.is_some() {
            self.update_volumes(surface);
            self.plan.invalidate();
            self.changes.everything();
        }
        Ok(())
    }

    /// Finds the volume constraints of the surface as it is now, if the material has any.
    pub(crate) fn update_volumes(&mut self, surface: &Surface) {
        if self.material.volume.is_some() {
            self.volumes.update(surface);
        } else {
            self.volumes.clear();
        }
    }

    /// The stretch constraints.
    #[must_use]
    pub fn stretch(&self) -> &StretchSet {
        &self.stretch
    }

    /// The bending constraints, if the material has bending.
    #[must_use]
    pub fn bending(&self) -> Option<&BendingSet> {
        self.bending.as_ref()
    }

    /// The volume constraints; none unless the material has volume.
    #[must_use]
    pub fn volumes(&self) -> &VolumeSet {
        &self.volumes
    }

    /// How far vertices may be from pinned ones, as the last step held them to it: empty unless it had
    /// [`SolverParams::tethers`], edges did not stretch and there were pins.
    #[must_use]
    pub fn tethers(&self) -> &[Tether] {
        if self.plan.iteration().first() == Some(&Pass::Tethers) {
            self.tethers.list()
        } else {
            &[]
        }
    }

    /// The passes of the last step's substeps.
    #[must_use]
    pub fn plan(&self) -> &StepPlan {
        &self.plan
    }

    /// What the last frame did.
    #[must_use]
    pub fn stats(&self) -> &StepStats {
        &self.stats
    }

    /// Room that the solver has taken, counted in elements of its arrays. Constant while nothing is
    /// edited: a step does not allocate.
    #[must_use]
    pub fn capacity(&self) -> usize {
        self.mass.capacity()
            + self.velocities.capacity()
            + self.cpu.capacity()
            + self.stretch.capacity()
            + self.bending.as_ref().map_or(0, BendingSet::capacity)
            + self.struts.as_ref().map_or(0, StretchSet::capacity)
            + self.lost_struts.capacity()
            + self.volumes.capacity()
            + self.contacts.capacity()
            + self.pins.capacity()
            + self.dropped_pins.capacity()
            + self.keepsakes.iter().map(Keepsake::capacity).sum::<usize>()
            + self.plan.capacity()
            + self.tethers.capacity()
            + self.history.capacity()
    }

    /// Whether a triangle uses the vertex.
    pub(crate) fn is_vertex(&self, v: VertexId) -> bool {
        self.mass.get(v.index()).is_some_and(|&m| m > 0.0)
    }
}

/// The inverse of a mass; 0, which does not move, for none.
pub(crate) fn inverse(mass: f32) -> f32 {
    if mass > 0.0 { 1.0 / mass } else { 0.0 }
}
