//! The solver of one body: its parts, and a step on the CPU.
//!
//! The parts are plain data: particles, constraints, the plan of a step and the state of edits.
//! [`constraints`](crate::constraints), [`step`](crate::step) and [`follow`](crate::follow) have
//! the functions over them. Its methods are in this file and in the files of `solver/`.

mod constraints;
mod edits;
mod join;
#[cfg(feature = "serde")]
mod load;
mod particles;
mod solid;

use crate::constraints::Constraints;
use crate::constraints::colliders::ColliderRecord;
use crate::error::{ConstraintError, StepError};
use crate::follow::FollowState;
use crate::interior::Interior;
use crate::kernels::elastic::ElasticSets;
use crate::kernels::integrate::{are_finite, first_non_finite};
use crate::mass::{masses, share_by_area};
use crate::material::Material;
use crate::particles::{Particles, inverse};
use crate::patches::PatchParams;
use crate::step::StepState;
use crate::step::constants::StepConstants;
#[cfg(feature = "gpu")]
use crate::step::guard::EnergyBudget;
use crate::step::guard::{GuardInputs, GuardedBody};
use crate::step::island::{Island, IslandError};
use crate::step::params::{SolverParams, StepStats};
use crate::step::plan::StepPlan;
use crate::step::prepare::{FrameInputs, prepare};
use crate::step::substeps::{Lengths, Substeps, parts};
use incise_mesh::Surface;

/// Steps one surface by position based dynamics.
///
/// It is Algorithm 1 of the paper, and XPBD where a material has compliance. Particle i is vertex
/// i. Positions and inverse masses are in [`Surface::positions`], everything else is in the solver.
///
/// With the feature `serde`, `finish_load` must follow its `Deserialize`, which `load` does.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Solver {
    material: Material,
    particles: Particles,
    constraints: Constraints,
    step: StepState,
    follow: FollowState,
    /// Memory of its steps as an island of one.
    #[cfg_attr(feature = "serde", serde(skip))]
    island: Island,
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
        let mut particles = Particles::new(masses(surface, material)?);
        let mut constraints = match &material.solid {
            Some(solid) => {
                let mut constraints = Constraints::of_solid(surface);
                let mass = particles.mass.iter().map(|&m| f64::from(m)).sum();
                let velocities = &mut particles.velocities;
                let interior = Interior::new(surface, velocities, solid, mass)?;
                // As after an edit, so that an undo restores them.
                for v in surface.topology().vertices() {
                    particles.mass[v.index()] = share_by_area(surface, v, interior.area_density());
                }
                constraints.interior = Some(Box::new(interior));
                constraints
            }
            None => Constraints::new(surface, material, patches)?,
        };
        let inverse_masses = particles
            .mass
            .iter()
            .filter(|_| constraints.interior.is_none());
        for (position, &mass) in surface.positions_mut().iter_mut().zip(inverse_masses) {
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
            island: Island::default(),
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
        let mut island = std::mem::take(&mut self.island);
        let mut body = [(&mut *self, surface)];
        let done = island.prepare(&mut body, dt, params).and_then(|()| {
            let mut contacts = std::mem::take(&mut body[0].0.constraints.contacts);
            let done = island.run(&mut body, &mut contacts);
            body[0].0.constraints.contacts = contacts;
            done
        });
        self.island = island;
        match done {
            Ok(()) => Ok(&self.step.stats),
            Err(IslandError { error, .. }) => Err(error),
        }
    }

    /// Returns the parts that a step changes.
    pub(crate) fn step_parts(&mut self) -> (&mut Particles, &mut Constraints, &mut StepState) {
        (&mut self.particles, &mut self.constraints, &mut self.step)
    }

    /// Checks that a surface is the solver's and that its positions are finite.
    ///
    /// # Errors
    /// [`StepError::SurfaceMismatch`], [`StepError::NonFiniteInput`].
    pub(crate) fn check_step(&self, surface: &Surface) -> Result<(), StepError> {
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
        Ok(())
    }

    /// Records a step, whose statistics are `None` if it failed.
    pub(crate) fn end_step(&mut self, stats: Option<StepStats>) {
        self.follow.log.mark_all();
        if let Some(stats) = stats {
            self.step.stats = stats;
        }
    }

    /// Returns the substeps of a frame of `dt` \[s\], and the time that it leaves in substeps.
    pub(crate) fn substeps_of(&self, dt: f32, params: &SolverParams) -> (Substeps, f64) {
        Substeps::for_frame(self.step.time_left, dt, params)
    }

    /// Prepares the guard of a frame; `None` without one. `has_contacts` counts those of an island.
    pub(crate) fn prepare_guard(
        &mut self,
        constants: &StepConstants,
        has_contacts: bool,
        params: &SolverParams,
    ) -> Option<GuardInputs> {
        let is_solid = self.constraints.interior.is_some();
        // The viscosity of a solid damps it.
        let damping = if is_solid { 0.0 } else { self.material.damping };
        let budget = &self.step.budget;
        let inputs = GuardInputs::new(budget, constants, damping, params.conserve)?;
        let has_contacts = has_contacts || !self.constraints.contacts.is_empty();
        let moves = |collider: &ColliderRecord| collider.velocity != [0.0; 3];
        let is_driven = std::mem::take(&mut self.particles.has_moving_pins)
            || self.constraints.colliders.records().iter().any(moves)
            || (self.material.volume)
                .is_some_and(|volume| volume.compressibility > 0.0 || volume.pressure != 1.0);
        Some(GuardInputs {
            has_pins: !self.particles.pins.is_empty(),
            // No node of a solid is pinned, but its momenta change.
            has_contacts: has_contacts || is_solid && !self.particles.pins.is_empty(),
            is_driven,
            ..inputs
        })
    }

    /// Returns the energy budget.
    #[cfg(feature = "gpu")]
    pub(crate) fn budget(&self) -> &EnergyBudget {
        &self.step.budget
    }

    /// Follows the guard of a frame on the GPU.
    #[cfg(feature = "gpu")]
    pub(crate) fn follow_guard(&mut self, inputs: &GuardInputs) {
        self.step.budget.follow(inputs);
    }

    /// Sets the slack that was read back from a GPU \[J\], unless the budget is unlimited.
    #[cfg(feature = "gpu")]
    pub(crate) fn set_slack(&mut self, slack: f32) {
        let budget = &mut self.step.budget;
        if !budget.is_unlimited() {
            budget.slack = slack;
        }
    }

    /// Borrows the body for its guard.
    pub(crate) fn guarded<'a>(&'a mut self, surface: &'a Surface) -> GuardedBody<'a> {
        let (positions, velocities, cells) = match &mut self.constraints.interior {
            Some(interior) => {
                let cells = Some(&interior.cells);
                (&interior.positions[..], &mut interior.velocities, cells)
            }
            None => (surface.positions(), &mut self.particles.velocities, None),
        };
        GuardedBody {
            positions,
            velocities,
            cells,
            pieces: &self.constraints.pieces,
            sets: ElasticSets {
                stretch: &self.constraints.stretch,
                bending: self.constraints.bending.as_ref(),
                interior_springs: self.constraints.interior_springs.as_ref(),
            },
            budget: &mut self.step.budget,
        }
    }

    /// Sets the time that a frame leaves to the next one, in substeps.
    pub(crate) fn set_time_left(&mut self, time: f64) {
        self.step.time_left = time;
    }

    /// Returns the number of parts of a substep of `h` \[s\] that the body needs.
    pub(crate) fn needed_parts(&mut self, h: f32, params: &SolverParams) -> u32 {
        if let (Some(interior), Some(solid)) = (&self.constraints.interior, &self.material.solid) {
            return interior.needed_parts(solid, h);
        }
        if self.constraints.colliders.planes().is_empty() {
            return 1;
        }
        let body = Lengths {
            edge: self.known_mean_rest_length(),
            thickness: self.constraints.volumes.least_thickness(),
        };
        parts(h, params, body)
    }

    /// Returns the mean rest length of edges \[m\]. O(n) in the first frame after an edit.
    fn known_mean_rest_length(&mut self) -> f64 {
        let known = self.step.mean_rest_length;
        let edge = known.filter(|_| self.step.plan.is_current());
        let edge = edge.unwrap_or_else(|| self.mean_rest_length());
        self.step.mean_rest_length = Some(edge);
        edge
    }

    /// Updates the plan and returns the constants of a frame.
    ///
    /// # Errors
    /// [`StepError::SubstepTooShort`]; nothing is changed then.
    pub(crate) fn prepare(
        &mut self,
        frame: FrameInputs,
        params: &SolverParams,
    ) -> Result<StepConstants, StepError> {
        let Self {
            material,
            particles,
            constraints,
            step,
            ..
        } = self;
        let constants = prepare(step, constraints, particles, material, frame, params)?;
        step.substeps = frame.substeps;
        Ok(constants)
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

    /// Returns the number of substeps of the last frame, on the CPU or a GPU.
    ///
    /// It is 0 for a frame that is shorter than the rest of a [substep](SolverParams::substep).
    #[must_use]
    pub fn substeps(&self) -> u32 {
        self.step.substeps.count
    }

    /// Returns the length of the substeps of the last frame, on the CPU or a GPU \[s\].
    #[must_use]
    pub fn substep(&self) -> f32 {
        self.step.substeps.h
    }

    /// Returns the statistics of the last step on the CPU.
    #[must_use]
    pub fn stats(&self) -> &StepStats {
        &self.step.stats
    }

    /// Returns the allocated size of all arrays in elements.
    ///
    /// It is constant without edits, because a step does not allocate once warm.
    #[must_use]
    pub fn capacity(&self) -> usize {
        self.particles.capacity()
            + self.constraints.capacity()
            + self.step.capacity()
            + self.follow.capacity()
            + self.island.capacity()
    }
}
