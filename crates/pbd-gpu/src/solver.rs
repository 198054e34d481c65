//! The solver of one body: its parts, and a step on a backend.
//!
//! The parts are plain data: particles, constraints, the plan of a step and the state of edits.
//! [`constraints`](crate::constraints), [`step`](crate::step) and [`follow`](crate::follow) have
//! the functions over them. Its methods are in this file and in the files of `solver/`.

mod constraints;
mod edits;
mod join;
mod particles;

use crate::constraints::Constraints;
use crate::error::{ConstraintError, StepError};
use crate::follow::FollowState;
use crate::kernels::integrate::{are_finite, first_non_finite};
use crate::mass::masses;
use crate::material::Material;
use crate::particles::{Particles, inverse};
use crate::patches::PatchParams;
use crate::step::StepState;
use crate::step::backend::{Backend, CpuBackend};
use crate::step::body::Body;
use crate::step::constants::StepConstants;
use crate::step::params::{Integrator, SolverParams, StepStats};
use crate::step::plan::StepPlan;
use crate::step::prepare::{both_orders, prepare};
use incise_mesh::Surface;

/// Steps one surface by position based dynamics.
///
/// It is Algorithm 1 of the paper, and XPBD where a material has compliance. Particle i is vertex
/// i. Positions and inverse masses are in [`Surface::positions`], everything else is in the solver.
#[derive(Debug, Clone)]
pub struct Solver {
    material: Material,
    particles: Particles,
    constraints: Constraints,
    step: StepState,
    follow: FollowState,
    cpu: CpuBackend,
}

impl Solver {
    /// Creates the constraints of a surface at rest and sets its inverse masses.
    ///
    /// A body of 512 vertices or more is divided into patches by [`PatchParams::for_body`].
    ///
    /// # Errors
    /// [`ConstraintError`] if the material has a number out of range, a position is not finite, an
    /// edge has no rest length, or there is no area or volume for the mass. The surface is
    /// unchanged then.
    pub fn new(surface: &mut Surface, material: &Material) -> Result<Self, ConstraintError> {
        let patches = PatchParams::for_body(surface.topology().vertex_count());
        Self::with_patches(surface, material, patches.as_ref())
    }

    /// Creates a solver whose body is divided into given patches, or undivided.
    ///
    /// The colors of constraints get layers ([`LAYERS`](crate::LAYERS)) by the patches of their
    /// vertices, so that a thread or a workgroup projects a patch in its own memory. The order of
    /// projections depends on the patches and not on the machine. Patches follow edits.
    ///
    /// # Errors
    /// As [`Solver::new`], and [`ConstraintError::BadPatches`].
    pub fn with_patches(
        surface: &mut Surface,
        material: &Material,
        patches: Option<&PatchParams>,
    ) -> Result<Self, ConstraintError> {
        patches.map_or(Ok(()), PatchParams::check)?;
        material.check()?;
        for v in surface.topology().vertices() {
            let p = surface.positions()[v.index()];
            let finite = |c: &f32| c.is_finite();
            if !(p[..3].iter().all(finite)
                && surface.rest_positions()[v.index()].iter().all(finite))
            {
                return Err(ConstraintError::NonFinitePosition { vertex: v });
            }
        }
        let mut constraints = Constraints::new(surface, material, patches)?;
        let mut particles = Particles::new(masses(surface, material)?);
        for (position, &mass) in surface.positions_mut().iter_mut().zip(&particles.mass) {
            position[3] = inverse(mass);
        }
        let mut follow = FollowState::default();
        let vertices = crate::constraints::batches::edit_reserve(particles.len());
        particles.reserve(vertices);
        constraints.reserve(vertices);
        follow.reserve(particles.len(), vertices);
        constraints.update_volumes(surface, material);
        Ok(Self {
            material: *material,
            particles,
            constraints,
            step: StepState::default(),
            follow,
            cpu: CpuBackend::default(),
        })
    }

    /// Steps by one frame of `dt` \[s\] on the CPU.
    ///
    /// Allocates nothing once warm, except one job of the pool per thread that helps with a large
    /// body.
    ///
    /// # Errors
    /// [`StepError`]. After [`StepError::NonFinitePosition`] the solver must be created again;
    /// after any other error surface and solver are unchanged.
    pub fn step(
        &mut self,
        surface: &mut Surface,
        dt: f32,
        params: &SolverParams,
    ) -> Result<&StepStats, StepError> {
        let mut cpu = std::mem::take(&mut self.cpu);
        let done = self.step_on(&mut cpu, surface, dt, params).map(|_| ());
        self.cpu = cpu;
        done.map(|()| &self.step.stats)
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
        let (slots, known) = (surface.positions().len(), self.particles.len());
        if slots != known {
            return Err(StepError::SurfaceMismatch {
                surface: slots,
                solver: known,
            });
        }
        if !are_finite(surface.positions()) {
            let vertex = first_non_finite(surface.positions());
            return Err(StepError::NonFiniteInput { vertex });
        }
        let constants = self.prepare(dt, params)?;
        let orders = both_orders(&self.material, &constants, params);
        self.constraints.update_patch_contents();
        let mut body = Body::new(&mut self.particles, &mut self.constraints, surface);
        let StepState { plan, history, .. } = &mut self.step;
        let done = match params.integrator {
            Integrator::Euler => {
                history.forget();
                backend.execute(plan, &constants, &mut body)
            }
            Integrator::Bdf2 => history.execute(backend, plan, &orders, params.substeps, &mut body),
        };
        self.follow.log.mark_all();
        self.step.stats = done?;
        Ok(&self.step.stats)
    }

    /// Updates the plan and returns the constants of a frame.
    ///
    /// # Errors
    /// [`StepError::SubstepTooShort`]; nothing is changed then.
    pub(crate) fn prepare(
        &mut self,
        dt: f32,
        params: &SolverParams,
    ) -> Result<StepConstants, StepError> {
        let Self {
            material,
            particles,
            constraints,
            step,
            ..
        } = self;
        prepare(step, constraints, particles, material, dt, params)
    }

    /// Returns the material.
    #[must_use]
    pub fn material(&self) -> &Material {
        &self.material
    }

    /// Returns the passes of a substep of the last step.
    #[must_use]
    pub fn plan(&self) -> &StepPlan {
        &self.step.plan
    }

    /// Returns the statistics of the last step on the CPU.
    #[must_use]
    pub fn stats(&self) -> &StepStats {
        &self.step.stats
    }

    /// Returns the allocated size of all arrays in elements.
    ///
    /// It is constant without edits, because a step does not allocate.
    #[must_use]
    pub fn capacity(&self) -> usize {
        self.particles.capacity()
            + self.constraints.capacity()
            + self.step.capacity()
            + self.follow.capacity()
            + self.cpu.capacity()
    }
}
