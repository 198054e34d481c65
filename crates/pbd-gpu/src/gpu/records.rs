//! Converts constraints, pins and parameters of bodies and frames to their GPU records.

use super::layout::{
    BodyRecord, CONSERVES, Entry, FrameUniform, HAS_CONTACTS, IS_DRIVEN, IS_GUARDED, IS_PRESSED,
    IS_UNLIMITED, KEEPS_BENDING, KEEPS_INTERIOR_SPRINGS, KEEPS_STRETCH, KEEPS_VOLUME,
    MEASURES_ELASTIC_ENERGY, Motion, PATCH_LAYERS, SUMS_FORCES, UNUSED,
};
use super::solid::SolidPlaces;
use super::volumes::VolumePlaces;
use crate::constraints::attachments::LongRangeAttachment;
use crate::constraints::batches::Batch;
use crate::particles::Pin;
use crate::solver::Solver;
use crate::step::constants::StepConstants;
use crate::step::guard::GuardInputs;
use crate::step::params::SolverParams;
use incise_mesh::{Surface, VertexId};

/// Entries of a constraint over `N` vertices: pairs of vertices, then rest value and multiplier.
#[expect(clippy::cast_possible_truncation, reason = "two or four vertices")]
pub(super) const fn entries_of<const N: usize>() -> u32 {
    N as u32 / 2 + 1
}

/// Appends the entries of a batch's constraint; its multiplier is 0.
pub(super) fn push_constraint<const N: usize>(out: &mut Vec<Entry>, batch: &Batch<N>, i: usize) {
    push_vertices(out, batch.vertices()[i].map(|v| v.0), batch.rest()[i]);
}

/// Appends the entries of a constraint with given vertex indices.
pub(super) fn push_vertices<const N: usize>(out: &mut Vec<Entry>, vertices: [u32; N], rest: f32) {
    out.extend(vertices.chunks(2).map(|pair| [pair[0], pair[1]]));
    out.push([rest.to_bits(), 0]);
}

/// Appends the two entries of a pin.
pub(super) fn push_pin(out: &mut Vec<Entry>, pin: &Pin) {
    let [x, y, z] = pin.target.map(f32::to_bits);
    out.extend([[pin.vertex.0, x], [y, z]]);
}

/// Appends the two entries of an attachment.
pub(super) fn push_attachment(out: &mut Vec<Entry>, attachment: &LongRangeAttachment) {
    let ends = [attachment.vertex.0, attachment.anchor.0];
    out.extend([ends, [attachment.length.to_bits(), 0]]);
}

/// Returns the inverse mass of a vertex as stored on the GPU.
pub(super) fn inverse_mass(solver: &Solver, v: u32) -> f32 {
    let (particles, vertex) = (solver.particles(), VertexId(v));
    if particles.is_used(vertex) {
        particles.inverse_mass(vertex)
    } else {
        UNUSED
    }
}

/// Returns position and inverse mass of a vertex as stored on the GPU.
pub(super) fn position(surface: &Surface, solver: &Solver, v: u32) -> [f32; 4] {
    let [x, y, z, _] = surface.positions()[v as usize];
    [x, y, z, inverse_mass(solver, v)]
}

/// Returns the motion of a vertex as stored on the GPU.
pub(super) fn motion(solver: &Solver, v: u32) -> Motion {
    let particles = solver.particles();
    Motion {
        velocity: particles.velocities[v as usize],
        correction: particles.corrections[v as usize],
    }
}

/// Offsets of a body's data.
#[derive(Debug, Clone, Copy)]
pub(super) struct Places {
    pub(super) first_vertex: u32,
    pub(super) vertices: u32,
    pub(super) first_surface_vertex: u32,
    pub(super) surface_vertices: u32,
    pub(super) first_pin: u32,
    pub(super) pins: u32,
    pub(super) first_attachment: u32,
    pub(super) attachments: u32,
    pub(super) first_run: u32,
    pub(super) stretch_colors: u32,
    pub(super) bending_colors: u32,
    pub(super) patch_tables: [u32; PATCH_LAYERS],
    pub(super) patches: [u32; PATCH_LAYERS],
    pub(super) volumes: VolumePlaces,
    pub(super) spring_colors: u32,
    pub(super) contacts: u32,
    pub(super) first_collider: u32,
    pub(super) colliders: u32,
    pub(super) planes: u32,
    pub(super) first_guard: u32,
    pub(super) guard_pieces: u32,
    pub(super) solid: SolidPlaces,
    /// Whether the forces at nodes are summed again before the frame.
    pub(super) sums_forces: bool,
}

/// Returns the record of a body that kernels read.
pub(super) fn body_record(
    places: Places,
    constants: &StepConstants,
    guard: Option<&GuardInputs>,
) -> BodyRecord {
    let has = |of: fn(&GuardInputs) -> bool| guard.is_some_and(of);
    let relaxation = guard.and_then(|guard| guard.relaxation);
    let flag = |is_set: bool, bit: u32| if is_set { bit } else { 0 };
    BodyRecord {
        first_vertex: places.first_vertex,
        vertices: places.vertices,
        first_surface_vertex: places.first_surface_vertex,
        surface_vertices: places.surface_vertices,
        first_pin: places.first_pin,
        pins: places.pins,
        first_attachment: places.first_attachment,
        attachments: places.attachments,
        stretch_factor: constants.stretch.factor,
        stretch_alpha: constants.stretch.alpha,
        bending_factor: constants.bending.factor,
        bending_alpha: constants.bending.alpha,
        friction: constants.friction,
        flags: flag(constants.stretch.accumulates_lambda, KEEPS_STRETCH)
            | flag(constants.bending.accumulates_lambda, KEEPS_BENDING)
            | flag(constants.volume.accumulates_lambda, KEEPS_VOLUME)
            | flag(
                constants.interior_springs.accumulates_lambda,
                KEEPS_INTERIOR_SPRINGS,
            )
            | flag(constants.volume.is_pressed, IS_PRESSED)
            | flag(guard.is_some(), IS_GUARDED)
            | flag(has(|guard| guard.conserves), CONSERVES)
            | flag(has(|guard| guard.is_driven), IS_DRIVEN)
            | flag(has(|guard| guard.has_contacts), HAS_CONTACTS)
            | flag(has(|guard| guard.is_unlimited), IS_UNLIMITED)
            | flag(relaxation.is_some(), MEASURES_ELASTIC_ENERGY)
            | flag(places.sums_forces, SUMS_FORCES),
        first_run: places.first_run,
        stretch_colors: places.stretch_colors,
        bending_colors: places.bending_colors,
        patch_tables: places.patch_tables,
        patches: places.patches,
        first_piece: places.volumes.first_piece,
        pieces: places.volumes.pieces,
        first_chunk: places.volumes.first_chunk,
        chunks: places.volumes.chunks,
        first_spoke: places.volumes.first_spoke,
        first_corner: places.volumes.first_corner,
        corners: places.volumes.corners,
        volume_alpha: constants.volume.alpha,
        volume_pressure: constants.volume.pressure,
        volume_recovery: constants.volume.recovery,
        volume_sink: constants.volume.sink,
        spring_colors: places.spring_colors,
        spring_factor: constants.interior_springs.factor,
        spring_alpha: constants.interior_springs.alpha,
        contacts: places.contacts,
        first_collider: places.first_collider,
        colliders: places.colliders,
        planes: places.planes,
        first_guard: places.first_guard,
        guard_pieces: places.guard_pieces,
        damping_factor: guard.map_or(1.0, |guard| guard.damping_factor),
        relaxation: relaxation.unwrap_or_default(),
        cell_colors: places.solid.cell_colors,
        first_embedding: places.solid.first_embedding,
        first_pin_start: places.solid.first_pin_start,
        first_near: places.solid.first_near,
        cell_size: places.solid.cell_size,
        cell_scale: constants.cells.scale,
        cell_unit: constants.cells.unit,
        cell_shape: constants.cells.shape,
        cell_volume: constants.cells.volume,
        cell_hourglass: constants.cells.hourglass,
        cell_square: constants.cells.square,
        cell_viscosity: constants.cells.viscosity,
    }
}

/// Returns the record of a frame that kernels read.
pub(super) fn frame_record(constants: &StepConstants, params: &SolverParams) -> FrameUniform {
    FrameUniform {
        gravity_step: constants.gravity_step,
        h: constants.h,
        substeps: constants.substeps,
        iterations: params.iterations,
        contact_rounds: constants.contact_rounds,
        measures_motion: 0,
        collider_step: constants.collider_step,
        lift: constants.lift,
        diagonal_scale: params.diagonal_scale,
        pad: 0.0,
    }
}
