//! Prepares a frame: updates the plan and computes the constants that kernels read.

use crate::constraints::Constraints;
use crate::constraints::interior_springs::DIAGONAL_SCALE;
use crate::error::StepError;
use crate::material::{InteriorSprings, Material, Stiffness, Volume};
use crate::particles::Particles;
use crate::step::StepState;
use crate::step::constants::StepConstants;
use crate::step::constants::{Projection, VolumeProjection};
#[cfg(feature = "global")]
use crate::step::params::Scheme;
use crate::step::params::{Integrator, SolverParams};
use crate::step::plan::PlanKey;
use crate::step::second_order::{Orders, SUBSTEP_RATIO};

/// Decay time of the longest recent substep [lengths of that substep].
const MEMORY: f32 = 10.0;

/// Inputs of a frame of one body: its length, contacts and collisions.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FrameInputs {
    /// Length of the frame \[s\].
    pub(crate) dt: f32,
    /// Whether a contact joins two pieces.
    pub(crate) joins_pieces: bool,
    /// Rounds of contacts and volumes per iteration, more where heavy pieces press thin ones.
    pub(crate) contact_rounds: u32,
    /// Whether a collider may reach the body within the frame; true if that is not known.
    pub(crate) reaches_colliders: bool,
}

/// Updates the plan and returns the constants of a frame.
///
/// # Errors
/// [`StepError::SubstepTooShort`]; nothing is changed then.
pub(crate) fn prepare(
    step: &mut StepState,
    constraints: &mut Constraints,
    particles: &Particles,
    material: &Material,
    frame: FrameInputs,
    params: &SolverParams,
) -> Result<StepConstants, StepError> {
    let h = frame.dt / params.substeps as f32;
    let global = takes_global_step(step, params);
    // Stacked bodies come to rest only if the sweep over lengths is symmetric.
    let sweeps_back = (frame.joins_pieces || constraints.contacts.joins_pieces()) && !global;
    let rounds = frame.contact_rounds;
    let mut constants = constants_of(material, h, params.substeps, sweeps_back, rounds, params);
    constants.check()?;
    let pieces = constraints.volumes.pieces().iter();
    let max_volume = pieces.map(|piece| piece.rest().abs()).fold(0.0, f32::max);
    if !(constants.volume.alpha * max_volume).is_finite() {
        return Err(StepError::SubstepTooShort { h });
    }
    if params.integrator == Integrator::Bdf2 {
        constants_of(material, SUBSTEP_RATIO * h, 1, sweeps_back, rounds, params).check()?;
    }
    constants.set_error_carryover(error_carryover(&mut step.longest_substep, frame.dt, h));
    let attachments =
        params.attachments && !particles.pins.is_empty() && material.stretch.is_rigid();
    let Constraints {
        stretch,
        bending,
        interior_springs,
        volumes,
        contacts,
        colliders,
        attachments: list,
        ..
    } = constraints;
    if attachments {
        list.update(stretch, &particles.pins, particles.len());
    }
    let key = PlanKey {
        attachments,
        global,
        sweeps_back,
        iterations: params.iterations,
        contact_rounds: rounds,
        pins: !particles.pins.is_empty(),
        volumes: !volumes.pieces().is_empty(),
        contacts: !contacts.is_empty(),
        colliders: frame.reaches_colliders && !colliders.records().is_empty(),
        multipliers: constants.accumulates_lambda(),
    };
    (step.plan).update(key, stretch, bending.as_ref(), interior_springs.as_ref());
    Ok(constants)
}

/// Returns whether the global step replaces the projections of a body.
#[cfg(feature = "global")]
pub(crate) fn takes_global_step(step: &StepState, params: &SolverParams) -> bool {
    // The choice is that of the last frame on the CPU; the GPU steps with sweeps only.
    step.choice.is_global() && params.scheme != Scheme::Sweeps
}

/// Returns false for every body: the global step is not compiled.
#[cfg(not(feature = "global"))]
pub(crate) fn takes_global_step(_: &StepState, _: &SolverParams) -> bool {
    false
}

/// Returns the fraction of old errors that rigid constraints leave in a frame of `dt` \[s\].
///
/// Velocities follow from displacements, so the remaining error of a long substep would be an
/// impulse in a short one. It is corrected as fast as in the longest recent substep instead.
fn error_carryover(longest_substep: &mut f32, dt: f32, h: f32) -> f32 {
    let longest = *longest_substep;
    if h >= longest {
        *longest_substep = h;
        return 0.0;
    }
    *longest_substep -= dt / MEMORY;
    1.0 - h / longest
}

/// Returns the constants of single substeps of first and second order, for BDF2.
pub(crate) fn both_orders(
    material: &Material,
    constants: &StepConstants,
    params: &SolverParams,
) -> Orders {
    let order = |h| {
        let &StepConstants {
            sweeps_back,
            contact_rounds,
            ..
        } = constants;
        let mut order = constants_of(material, h, 1, sweeps_back, contact_rounds, params);
        order.stretch.error_carryover = constants.stretch.error_carryover;
        order.bending.error_carryover = constants.bending.error_carryover;
        order.interior_springs.error_carryover = constants.interior_springs.error_carryover;
        order.volume.error_carryover = constants.volume.error_carryover;
        order
    };
    Orders {
        first: order(constants.h),
        second: order(SUBSTEP_RATIO * constants.h),
    }
}

/// Returns the constants of substeps of `h` \[s\].
fn constants_of(
    material: &Material,
    h: f32,
    substeps: u32,
    sweeps_back: bool,
    contact_rounds: u32,
    params: &SolverParams,
) -> StepConstants {
    let damping = 1.0 + material.damping * h;
    // Damping acts on constraint forces as on gravity; otherwise it would hold up a soft body that
    // hangs at rest.
    let projection_of = |stiffness: Stiffness, sweeps: u32| {
        let projection = stiffness.projection(params.iterations.saturating_mul(sweeps), h);
        Projection {
            alpha: projection.alpha * damping,
            diagonal_scale: params.diagonal_scale,
            ..projection
        }
    };
    let of_length = |stiffness| projection_of(stiffness, 1 + u32::from(sweeps_back));
    let stretch = of_length(material.stretch);
    let bending = |stiffness| projection_of(stiffness, 1).beside_edges(stretch.alpha);
    let interior_springs = |springs: InteriorSprings| Projection {
        diagonal_scale: DIAGONAL_SCALE,
        ..of_length(springs.stiffness)
    };
    let gravity_step = params.gravity.map(|g| g * h);
    let volume = |volume: Volume| {
        let projection = volume.projection(params.iterations, h, gravity_step);
        VolumeProjection {
            alpha: projection.alpha * damping,
            diagonal_scale: params.diagonal_scale,
            is_pressed: contact_rounds > 1,
            ..projection
        }
    };
    let springs = material.interior_springs;
    StepConstants {
        h,
        substeps,
        contact_rounds,
        sweeps_back,
        gravity_step,
        velocity_factor: 1.0 / damping,
        stretch,
        bending: material.bending.map_or(Projection::NONE, bending),
        interior_springs: springs.map_or(Projection::NONE, interior_springs),
        volume: material.volume.map_or(VolumeProjection::NONE, volume),
        friction: material.friction,
        // A single iteration cannot end early.
        residual: params.residual.filter(|_| params.iterations > 1),
        threads: params.threads,
    }
}
