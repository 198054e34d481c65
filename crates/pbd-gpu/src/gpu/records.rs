//! What a body looks like on the device.

use super::layout::{
    BodyRecord, Entry, KEEPS_BENDING, KEEPS_STRETCH, KEEPS_STRUTS, KEEPS_VOLUME, PATCH_LAYERS,
    UNUSED,
};
use super::volumes::VolumePlaces;
use crate::constraints::Batch;
use crate::plan::{Pin, StepConstants};
use crate::solver::{Solver, inverse};
use crate::tethers::Tether;
use incise_mesh::{Surface, VertexId};

/// Entries of a constraint over `N` vertices: its vertices two by two, then rest value and multiplier.
#[expect(clippy::cast_possible_truncation, reason = "two or four vertices")]
pub(super) const fn entries_of<const N: usize>() -> u32 {
    N as u32 / 2 + 1
}

/// Appends the entries of a batch's constraint; its multiplier is 0.
pub(super) fn push_constraint<const N: usize>(out: &mut Vec<Entry>, batch: &Batch<N>, i: usize) {
    push_vertices(out, batch.vertices()[i].map(|v| v.0), batch.rest()[i]);
}

/// Appends the entries of a constraint over vertices as the device names them.
pub(super) fn push_vertices<const N: usize>(out: &mut Vec<Entry>, vertices: [u32; N], rest: f32) {
    out.extend(vertices.chunks(2).map(|pair| [pair[0], pair[1]]));
    out.push([rest.to_bits(), 0]);
}

/// Appends the two entries of a pin.
pub(super) fn push_pin(out: &mut Vec<Entry>, pin: &Pin) {
    let [x, y, z] = pin.target.map(f32::to_bits);
    out.extend([[pin.vertex.0, x], [y, z]]);
}

/// Appends the two entries of a tether.
pub(super) fn push_tether(out: &mut Vec<Entry>, tether: &Tether) {
    let ends = [tether.vertex.0, tether.anchor.0];
    out.extend([ends, [tether.length.to_bits(), 0]]);
}

/// A vertex's inverse mass as the device has it.
pub(super) fn inverse_mass(solver: &Solver, v: u32) -> f32 {
    let vertex = VertexId(v);
    let pinned = |solver: &Solver| {
        solver
            .pins()
            .binary_search_by_key(&vertex, |pin| pin.vertex)
    };
    if !solver.is_vertex(vertex) {
        UNUSED
    } else if pinned(solver).is_ok() {
        0.0
    } else {
        inverse(solver.mass[v as usize])
    }
}

/// A vertex's position and inverse mass.
pub(super) fn position(surface: &Surface, solver: &Solver, v: u32) -> [f32; 4] {
    let [x, y, z, _] = surface.positions[v as usize];
    [x, y, z, inverse_mass(solver, v)]
}

/// Where a body's data lies.
#[derive(Debug, Clone, Copy)]
pub(super) struct Places {
    pub(super) first_vertex: u32,
    pub(super) vertices: u32,
    pub(super) first_pin: u32,
    pub(super) pins: u32,
    pub(super) first_tether: u32,
    pub(super) tethers: u32,
    pub(super) first_run: u32,
    pub(super) stretch_colors: u32,
    pub(super) bending_colors: u32,
    pub(super) patch_tables: [u32; PATCH_LAYERS],
    pub(super) patches: [u32; PATCH_LAYERS],
    pub(super) volumes: VolumePlaces,
    pub(super) strut_colors: u32,
    pub(super) contacts: u32,
    pub(super) first_collider: u32,
    pub(super) colliders: u32,
}

/// The numbers of a body that kernels read.
pub(super) fn body_record(places: Places, constants: &StepConstants) -> BodyRecord {
    let keeps = |yes: bool, bit: u32| if yes { bit } else { 0 };
    BodyRecord {
        first_vertex: places.first_vertex,
        vertices: places.vertices,
        first_pin: places.first_pin,
        pins: places.pins,
        first_tether: places.first_tether,
        tethers: places.tethers,
        stretch_factor: constants.stretch.factor,
        stretch_alpha: constants.stretch.alpha,
        stretch_old: constants.stretch.old,
        bending_factor: constants.bending.factor,
        bending_alpha: constants.bending.alpha,
        bending_old: constants.bending.old,
        kept_velocity: constants.kept_velocity,
        friction: constants.friction,
        flags: keeps(constants.stretch.keeps, KEEPS_STRETCH)
            | keeps(constants.bending.keeps, KEEPS_BENDING)
            | keeps(constants.volume.keeps, KEEPS_VOLUME)
            | keeps(constants.struts.keeps, KEEPS_STRUTS),
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
        volume_returned: constants.volume.returned,
        volume_old: constants.volume.old,
        strut_colors: places.strut_colors,
        strut_factor: constants.struts.factor,
        strut_alpha: constants.struts.alpha,
        strut_old: constants.struts.old,
        contacts: places.contacts,
        first_collider: places.first_collider,
        colliders: places.colliders,
    }
}
