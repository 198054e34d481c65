//! Prepares a frame: updates the plan and computes the constants that kernels read.

use crate::constraints::Constraints;
use crate::constraints::interior_springs::DIAGONAL_SCALE;
use crate::error::StepError;
use crate::kernels::cells::CellConstants;
use crate::material::{InteriorSprings, Material, Stiffness, Volume};
use crate::particles::Particles;
use crate::step::StepState;
use crate::step::constants::StepConstants;
use crate::step::constants::{Projection, VolumeProjection};
use crate::step::params::{Integrator, SolverParams};
use crate::step::plan::PlanKey;
use crate::step::second_order::{Orders, SUBSTEP_RATIO};
use crate::step::substeps::Substeps;

/// Inputs of a frame of one body: its length, contacts and collisions.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FrameInputs {
    /// Length of the frame \[s\].
    pub(crate) dt: f32,
    /// Substeps of the frame. A part of their time may be left over from the last frame.
    pub(crate) substeps: Substeps,
    /// Whether the body may touch others in the frame.
    pub(crate) has_contacts: bool,
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
    let h = frame.substeps.h;
    let rounds = frame.contact_rounds;
    // Contacts act and end at once. Only the dissipation of implicit Euler brings stacks to rest.
    let is_smooth = !frame.has_contacts && constraints.contacts.is_empty();
    let lift = match params.integrator {
        Integrator::Euler if is_smooth => params.lift,
        _ => 0.0,
    };
    let mut constants = constants_of(material, &frame, h, lift, params);
    if let (Some(interior), Some(solid)) = (&mut constraints.interior, &material.solid) {
        constants.cells = interior.begin_frame(solid, h);
        constants.lift = 1.0;
    }
    constants.check()?;
    let pieces = constraints.volumes.pieces().iter();
    let max_volume = pieces.map(|piece| piece.rest().abs()).fold(0.0, f32::max);
    if !(constants.volume.alpha * max_volume).is_finite() {
        return Err(StepError::SubstepTooShort { h });
    }
    if params.integrator == Integrator::Bdf2 {
        constants_of(material, &frame, SUBSTEP_RATIO * h, lift, params).check()?;
    }
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
        interior,
        ..
    } = constraints;
    if attachments {
        list.update(stretch, &particles.pins, particles.len());
    }
    let key = PlanKey {
        attachments,
        iterations: params.iterations,
        contact_rounds: rounds,
        pins: !particles.pins.is_empty(),
        volumes: !volumes.pieces().is_empty(),
        contacts: !contacts.is_empty(),
        colliders: frame.reaches_colliders && !colliders.records().is_empty(),
        multipliers: constants.accumulates_lambda(),
    };
    let cells = interior.as_ref().map(|interior| &interior.cells);
    let (bending, springs) = (bending.as_ref(), interior_springs.as_ref());
    (step.plan).update(key, stretch, bending, springs, cells);
    Ok(constants)
}

/// Returns the constants of single substeps of first and second order, for BDF2.
pub(crate) fn both_orders(
    material: &Material,
    frame: &FrameInputs,
    params: &SolverParams,
) -> Orders {
    let order = |h| StepConstants {
        substeps: 1,
        ..constants_of(material, frame, h, 0.0, params)
    };
    Orders {
        first: order(frame.substeps.h),
        second: order(SUBSTEP_RATIO * frame.substeps.h),
    }
}

/// Returns the constants of the substeps of a frame, for a length of `h` \[s\].
fn constants_of(
    material: &Material,
    frame: &FrameInputs,
    h: f32,
    lift: f32,
    params: &SolverParams,
) -> StepConstants {
    // The prediction repeats a share of the constraint forces, and projections do the rest.
    let softer = 1.0 / (1.0 - lift);
    let projection_of = |stiffness: Stiffness| {
        let projection = stiffness.projection(params.iterations.saturating_mul(2), h);
        Projection {
            alpha: projection.alpha * softer,
            diagonal_scale: params.diagonal_scale,
            ..projection
        }
    };
    let stretch = projection_of(material.stretch);
    let bending = |stiffness| projection_of(stiffness).beside_edges(stretch.alpha);
    let interior_springs = |springs: InteriorSprings| Projection {
        diagonal_scale: DIAGONAL_SCALE,
        ..projection_of(springs.stiffness)
    };
    let gravity_step = params.gravity.map(|g| g * h);
    let volume = |volume: Volume| {
        let projection = volume.projection(params.iterations, h, gravity_step);
        VolumeProjection {
            alpha: projection.alpha * softer,
            diagonal_scale: params.diagonal_scale,
            is_pressed: frame.contact_rounds > 1,
            ..projection
        }
    };
    let springs = material.interior_springs;
    StepConstants {
        h,
        substeps: frame.substeps.count,
        contact_rounds: frame.contact_rounds,
        collider_step: frame.dt / frame.substeps.count.max(1) as f32,
        lift,
        gravity_step,
        stretch,
        bending: material.bending.map_or(Projection::NONE, bending),
        interior_springs: springs.map_or(Projection::NONE, interior_springs),
        volume: material.volume.map_or(VolumeProjection::NONE, volume),
        cells: CellConstants::NONE,
        friction: material.friction,
        // A single iteration cannot end early.
        residual: params.residual.filter(|_| params.iterations > 1),
        threads: params.threads,
    }
}
