//! The global step: a quasi-Newton method whose preconditioner is one factored sparse matrix.
//!
//! Local projections carry a load by one edge per iteration. The global step minimizes the
//! objective of an implicit Euler substep instead, with displacements `D` as the unknowns:
//!
//! ```text
//! F(D) = sum m |D - D_predicted|^2 / 2 + sum C(x + D)^2 / (2 alpha)
//! ```
//!
//! over edges, hinges and interior springs, with `alpha` as in XPBD. A direction is that of
//! projective dynamics (Bouaziz et al. 2014): the inverse of a constant matrix, the same for all
//! three coordinates, times the gradient. The last steps correct it by L-BFGS (Liu et al. 2017).
//!
//! [`objective`] evaluates `F` and its gradient. [`matrix`] assembles the matrix, `incise-sparse`
//! factors it, and [`coordinates`] solves with the factor. [`preconditioner`] keeps a factor while
//! the body changes, with a [`local`] one for the changed region and exact translations of
//! [`free_pieces`], and [`minimizer`] iterates. Pins hold by their zero inverse mass. Volumes are
//! projected after each iteration, as with sweeps, and directions keep incompressible ones to first
//! order. Near [`obstacles`] and in contact with others a body takes
//! sweeps, after which it is [settling](minimizer::settling).
//!
//! Results are the same on any number of threads. Unlike those of sweeps they depend on the
//! instruction set, because `faer` uses fused multiply-add where the CPU has it.

mod arctangent;
mod choice;
mod coordinates;
mod energy;
mod free_pieces;
mod job;
mod lanes;
#[cfg(feature = "serde")]
mod load;
mod local;
mod matrix;
mod minimizer;
mod objective;
mod obstacles;
mod pieces;
mod preconditioner;
#[cfg(test)]
mod tests;
mod volumes;

use crate::constraints::Constraints;
use crate::constraints::batches::{BendingSet, StretchSet};
use crate::constraints::volumes::VolumeSet;
use crate::kernels::particle_state::ParticleStates;
use crate::material::{Material, Stiffness, Volume};
use crate::particles::Particles;
use crate::step::constants::StepConstants;
use crate::step::params::{Scheme, SolverParams};
pub(crate) use choice::{Choice, Extent};
use incise_mesh::{Surface, TopologyDelta, VertexId};
use minimizer::Minimizer;
pub(crate) use minimizer::settling::{FAILED_SEARCH_TIME, FREE_STRAIN, MAX_ELASTIC, SETTLING_TIME};
use objective::{Compliances, Objective};
pub(crate) use obstacles::Obstacles;
use pieces::PieceMotions;
use preconditioner::Preconditioner;
use std::time::Duration;

/// Memory and cost of the global step of a body.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct GlobalStats {
    /// Entries of the factor in use.
    pub factor_entries: usize,
    /// Size of all arrays of the global step \[bytes\].
    pub bytes: usize,
    /// Number of factorizations so far.
    pub factorizations: u32,
    /// Time of the last factorization, on the thread that ran it.
    pub factor_time: Duration,
    /// Frames since the constraints of the factor in use were copied.
    pub factor_age: u32,
}

/// The state of the global step of one body.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct GlobalStep {
    preconditioner: Preconditioner,
    #[cfg_attr(feature = "serde", serde(skip))]
    minimizer: Minimizer,
    #[cfg_attr(feature = "serde", serde(skip))]
    pieces: PieceMotions,
    /// Iterations of a substep in this frame.
    #[cfg_attr(feature = "serde", serde(skip))]
    iterations: u32,
    /// Iterations that are left of this substep.
    #[cfg_attr(feature = "serde", serde(skip))]
    iterations_left: u32,
    /// Size of the body \[m\], if it settles.
    #[cfg_attr(feature = "serde", serde(skip))]
    settling_size: Option<f64>,
    /// Bound of the kinetic term of the substep relative to rigid pieces [kg m^2], if the body
    /// settles.
    #[cfg_attr(feature = "serde", serde(skip))]
    max_relative_kinetic: Option<f64>,
}

/// The constraints with an energy, as the objective reads them.
#[derive(Debug, Clone, Copy)]
pub(crate) struct EnergySets<'a> {
    pub(crate) stretch: &'a StretchSet,
    pub(crate) bending: Option<&'a BendingSet>,
    pub(crate) interior_springs: Option<&'a StretchSet>,
}

/// Minimum number of iterations for [`Scheme::Auto`]: one alone has no L-BFGS correction.
const MIN_ITERATIONS: u32 = 2;

/// Divisor of the iteration count of a large body in the frame of an edit.
///
/// The other iterations would take as long as its local factor and the longer line searches beside
/// new slivers, and hardly lessen the error of that frame.
const EDIT_DIVISOR: u32 = 4;

/// Short substeps of sweeps for each iteration of the global step.
///
/// They take less time than it does, and carry a load as far as most bodies of a few thousand
/// triangles need.
pub(crate) const SHORT_SUBSTEPS_PER_ITERATION: u32 = 4;

/// Returns whether parameters and material choose the global step in a frame of `dt` \[s\].
///
/// `was_chosen` tells whether they did in the last frame, so that small changes of `dt` change
/// nothing.
///
/// All of its edges, springs and hinges need an energy, that is a compliance above 0. A volume must
/// be incompressible without excess pressure: projections of others and iterations undo each other.
pub(crate) fn is_chosen(
    params: &SolverParams,
    material: &Material,
    (extent, dt, was_chosen): (Option<Extent>, f32, bool),
) -> bool {
    let has_energy = |stiffness| matches!(stiffness, Stiffness::Compliance(c) if c > 0.0);
    let is_possible = has_energy(material.stretch)
        && material.bending.is_none_or(has_energy)
        && (material.interior_springs).is_none_or(|springs| has_energy(springs.stiffness))
        && material
            .volume
            .is_none_or(|volume| volume == Volume::default());
    let is_needed = |extent: Extent| {
        extent.needs_global_step((material.stretch, material.bending), dt, was_chosen)
    };
    let is_wanted = match params.scheme {
        Scheme::Sweeps => false,
        Scheme::Global => true,
        Scheme::Auto => params.iterations >= MIN_ITERATIONS && extent.is_some_and(is_needed),
    };
    is_possible && is_wanted
}

impl GlobalStep {
    /// Prepares a frame: factors the matrix of a new body, and that of a changed one beside the
    /// frames.
    pub(crate) fn prepare(
        &mut self,
        (particles, constraints, surface): (&Particles, &Constraints, &Surface),
        constants: &StepConstants,
        params: &SolverParams,
        settling_size: Option<f64>,
    ) {
        self.settling_size = settling_size;
        self.minimizer.line_search_failed = false;
        let compliances = Compliances::new(constants);
        self.pieces.update(particles, surface);
        self.preconditioner.prepare(
            (particles, &sets(constraints), surface),
            compliances,
            params.threads,
        );
        let all = params.iterations;
        self.iterations = match self.preconditioner.is_edit_slow() {
            true => all.div_ceil(EDIT_DIVISOR),
            false => all,
        };
    }

    /// Returns whether a line search of the last frame failed on a steep slope.
    pub(crate) fn line_search_failed(&self) -> bool {
        self.minimizer.line_search_failed
    }

    /// Returns the energy of edges, interior springs and hinges \[J\].
    pub(crate) fn elastic_energy(
        &mut self,
        (constraints, surface): (&Constraints, &Surface),
        material: &Material,
    ) -> f64 {
        let compliance = |stiffness| match stiffness {
            Some(Stiffness::Compliance(compliance)) => f64::from(compliance),
            _ => f64::INFINITY,
        };
        let springs = material.interior_springs.map(|springs| springs.stiffness);
        let compliances = Compliances {
            stretch: compliance(Some(material.stretch)),
            bending: compliance(material.bending),
            interior_springs: compliance(springs),
        };
        let objective = Objective::new(sets(constraints), compliances);
        self.minimizer.value_at(&objective, surface)
    }

    /// Removes the vertices of changed triangles from the factor.
    pub(crate) fn follow_edit(&mut self, surface: &Surface, delta: &TopologyDelta) {
        self.pieces.forget();
        let topology = surface.topology();
        let (added, removed) = (&delta.triangles_added, &delta.triangles_removed);
        let added = added.iter().flat_map(|&t| topology.triangle(t));
        let removed = removed.iter().flat_map(|(_, vertices)| *vertices);
        self.preconditioner
            .forget(added.chain(removed).map(VertexId::index));
    }

    /// Follows a change of masses.
    pub(crate) fn follow_masses(&mut self) {
        self.preconditioner.mark_stale();
    }

    /// Starts a substep from the predicted displacements.
    pub(crate) fn begin(
        &mut self,
        particles: ParticleStates<'_>,
        sets: EnergySets<'_>,
        constants: &StepConstants,
    ) {
        let objective = Objective::new(sets, Compliances::new(constants));
        let fall = (constants.gravity_step).map(|g| f64::from(g * constants.h));
        let pieces = &mut self.pieces;
        let start = (fall, pieces, self.iterations);
        self.minimizer.begin(particles, &objective, start);
        self.max_relative_kinetic =
            (self.settling_size).map(|size| self.minimizer.max_relative_kinetic(size, constants.h));
        self.iterations_left = self.iterations;
    }

    /// Moves the displacements toward the minimum by one iteration, and returns the number done.
    ///
    /// It is 0 or 1: the frame of an edit may leave out the last ones.
    pub(crate) fn iterate(
        &mut self,
        particles: ParticleStates<'_>,
        (sets, volumes): (EnergySets<'_>, &VolumeSet),
        constants: &StepConstants,
    ) -> u32 {
        let Some(left) = self.iterations_left.checked_sub(1) else {
            return 0;
        };
        self.iterations_left = left;
        let objective = Objective::new(sets, Compliances::new(constants));
        let volumes = (!volumes.pieces.is_empty()).then_some(volumes);
        let body = (&objective, volumes);
        self.minimizer
            .iterate(particles, body, &mut self.preconditioner);
        if left == 0
            && let Some(most) = self.max_relative_kinetic
        {
            self.minimizer.settle(particles, &mut self.pieces, most);
        }
        1
    }

    /// Returns the allocated size in elements of 64 bits.
    pub(crate) fn capacity(&self) -> usize {
        self.stats().bytes / size_of::<f64>()
    }

    /// Returns memory and cost.
    pub(crate) fn stats(&self) -> GlobalStats {
        GlobalStats {
            bytes: self.preconditioner.bytes() + self.minimizer.bytes() + self.pieces.bytes(),
            ..self.preconditioner.stats()
        }
    }
}

/// Returns the constraints with an energy.
fn sets(constraints: &Constraints) -> EnergySets<'_> {
    EnergySets {
        stretch: &constraints.stretch,
        bending: constraints.bending.as_ref(),
        interior_springs: constraints.interior_springs.as_ref(),
    }
}
