//! Composes the shader modules: one WGSL file per kernel and one per schedule.

mod constants;

use super::layout::STRUCTS;
use crate::kernels::volume::CHUNK;
use crate::patches::PATCH_VERTICES;

/// Module that writes single words.
pub(crate) const SCATTER: &str = include_str!("shaders/scatter.wgsl");

/// Returns the maximum number of vertices whose displacements fit in workgroup memory.
pub(crate) fn capacity(bytes: u32) -> u32 {
    // 256 bytes are reserved for other shared variables.
    (bytes - 256) / 12 / 64 * 64
}

/// Reduction of the capacity for bodies with volumes, whose reduction trees need memory [vertices].
pub(crate) const LEAVES: usize = (16 * CHUNK).div_ceil(12);

/// Default workgroup size.
#[cfg(test)]
pub(crate) const WORKGROUP_SIZE: u32 = 64;

/// Maximum number of vertices with the 16 KiB of workgroup memory of every adapter.
#[cfg(test)]
pub(crate) const CAPACITY: u32 = 1344;

/// Entry point of the whole-body schedule.
pub(crate) const WHOLE_BODY: &str = "whole_body";

/// Entry point that projects the patches of a layer, one workgroup per patch.
pub(crate) const PATCHES: &str = "patches";
/// Entry point that resets the multipliers of the patches of a layer.
pub(crate) const RESET_PATCHES: &str = "reset_patches";

/// The entry points of passes that are not within patches.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum EntryPoint {
    /// One lane per vertex.
    Predict,
    /// One lane per pin.
    Pins,
    /// One lane per attachment.
    LongRangeAttachments,
    /// One lane per constraint of the longest run of the pass.
    ResetMultipliers,
    /// One lane per edge or interior spring of a color.
    Stretch,
    /// One lane per constraint of a color.
    Bending,
    /// One workgroup per body: several colors of one kind in order, then the overflow.
    Tail,
    /// One workgroup per chunk of vertices.
    SumVolumes,
    /// One workgroup per piece.
    StepVolumes,
    /// One workgroup per chunk of vertices.
    MoveVolumes,
    /// One lane per piece.
    ResetVolumes,
    /// One lane per vertex.
    Colliders,
    /// One lane per vertex.
    Integrate,
    /// One lane per link.
    ResetBounds,
    /// One lane per vertex, after [`EntryPoint::ResetBounds`].
    Bounds,
    /// One workgroup per body, before the first substep.
    BeginGuard,
    /// One workgroup per body, after the last substep.
    EndGuard,
    /// One lane per node of a solid.
    PredictNodes,
    /// One lane per cell of a color.
    Cells,
    /// One workgroup per solid: several colors of cells in order, then the overflow.
    CellTail,
    /// One lane per node, before forces are summed again.
    ClearForces,
    /// One workgroup per solid.
    SolidPins,
    /// One workgroup per solid, before the first substep.
    FindNear,
    /// One workgroup per solid, of the vertices that [`EntryPoint::FindNear`] has listed.
    SolidColliders,
    /// One lane per vertex of a solid, after the last substep.
    Embed,
}

impl EntryPoint {
    /// All entry points; the index of an entry point is its number.
    pub(crate) const ALL: [Self; 25] = [
        Self::Predict,
        Self::Pins,
        Self::LongRangeAttachments,
        Self::ResetMultipliers,
        Self::Stretch,
        Self::Bending,
        Self::Tail,
        Self::SumVolumes,
        Self::StepVolumes,
        Self::MoveVolumes,
        Self::ResetVolumes,
        Self::Colliders,
        Self::Integrate,
        Self::ResetBounds,
        Self::Bounds,
        Self::BeginGuard,
        Self::EndGuard,
        Self::PredictNodes,
        Self::Cells,
        Self::CellTail,
        Self::ClearForces,
        Self::SolidPins,
        Self::FindNear,
        Self::SolidColliders,
        Self::Embed,
    ];

    /// Returns the name of the function.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Predict => "predict",
            Self::Pins => "pins",
            Self::LongRangeAttachments => "attachments",
            Self::ResetMultipliers => "reset_multipliers",
            Self::Stretch => "stretch",
            Self::Bending => "bending",
            Self::Tail => "tail",
            Self::SumVolumes => "sum_volumes",
            Self::StepVolumes => "step_volumes",
            Self::MoveVolumes => "move_volumes",
            Self::ResetVolumes => "reset_volumes",
            Self::Colliders => "colliders",
            Self::Integrate => "integrate",
            Self::ResetBounds => "reset_bounds",
            Self::Bounds => "bounds",
            Self::BeginGuard => "begin_guard",
            Self::EndGuard => "end_guard",
            Self::PredictNodes => "predict_nodes",
            Self::Cells => "cells",
            Self::CellTail => "cell_tail",
            Self::ClearForces => "clear_forces",
            Self::SolidPins => "solid_pins",
            Self::FindNear => "find_near",
            Self::SolidColliders => "solid_colliders",
            Self::Embed => "embed",
        }
    }
}

const SHARED: [&str; 14] = [
    include_str!("shaders/types.wgsl"),
    include_str!("shaders/bits.wgsl"),
    include_str!("shaders/links.wgsl"),
    include_str!("../kernels/predict.wgsl"),
    include_str!("../kernels/pins.wgsl"),
    include_str!("../kernels/attachments.wgsl"),
    include_str!("../kernels/stretch.wgsl"),
    include_str!("../kernels/arctangent.wgsl"),
    include_str!("../kernels/bending.wgsl"),
    include_str!("../kernels/contact_features.wgsl"),
    include_str!("../kernels/contacts.wgsl"),
    include_str!("../kernels/colliders.wgsl"),
    include_str!("../kernels/integrate.wgsl"),
    include_str!("shaders/sweep.wgsl"),
];

/// Returns the module of passes with the entry points of [`EntryPoint`].
pub(crate) fn passes(workgroup_size: u32, tail_size: u32) -> String {
    let parts = [
        include_str!("shaders/storage.wgsl"),
        include_str!("../kernels/volume.wgsl"),
        include_str!("../kernels/bounds.wgsl"),
        include_str!("shaders/volumes.wgsl"),
        include_str!("../kernels/rigid_motion.wgsl"),
        include_str!("../kernels/elastic.wgsl"),
        include_str!("../kernels/cells/modes.wgsl"),
        include_str!("../kernels/cells/rotation.wgsl"),
        include_str!("../kernels/cells/torque.wgsl"),
        include_str!("../kernels/cells/rows.wgsl"),
        include_str!("../kernels/cells.wgsl"),
        include_str!("../kernels/points.wgsl"),
        include_str!("shaders/guard.wgsl"),
        include_str!("shaders/passes.wgsl"),
        include_str!("shaders/solids.wgsl"),
    ];
    let constants = [("WORKGROUP_SIZE", workgroup_size), ("TAIL_SIZE", tail_size)];
    compose(&constants, &parts)
}

/// Returns the module of the whole-body schedule for bodies of up to `capacity` vertices.
pub(crate) fn whole_body(workgroup_size: u32, capacity: u32) -> String {
    let constants = [("WORKGROUP_SIZE", workgroup_size), ("CAPACITY", capacity)];
    let parts = [
        include_str!("shaders/workgroup.wgsl"),
        include_str!("../kernels/volume.wgsl"),
        include_str!("shaders/whole_body.wgsl"),
    ];
    compose(&constants, &parts)
}

/// Returns the module of passes within patches.
pub(crate) fn patches(workgroup_size: u32) -> String {
    let constants = [
        ("WORKGROUP_SIZE", workgroup_size),
        ("PATCH_VERTICES", PATCH_VERTICES),
    ];
    compose(&constants, &[include_str!("shaders/patches.wgsl")])
}

fn compose(constants: &[(&str, u32)], parts: &[&str]) -> String {
    let mut module = constants::text(constants);
    for part in STRUCTS.iter().chain(&SHARED).chain(parts) {
        module.push_str(part);
    }
    module
}

#[cfg(test)]
mod tests;
