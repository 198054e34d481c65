//! The sources of the shader modules, composed of one file a kernel and one a schedule.

use super::layout::{
    BENDING, BENDING_ENTRIES, CHUNK_ENTRIES, COLLIDER_ENTRIES, CONTACT_ENTRIES, CONTACTS,
    KEEPS_BENDING, KEEPS_STRETCH, KEEPS_STRUTS, KEEPS_VOLUME, PIECE_ENTRIES, PIN_ENTRIES,
    RUN_COLORS, STRETCH, STRETCH_ENTRIES, STRUTS, TETHER_ENTRIES,
};
use crate::colliders::{PLANE, ROUND};
use crate::coloring::MAX_COLORS;
use crate::constraints::OVERFLOW;
use crate::contacts::NO_CORNER;
use crate::kernels::volume::CHUNK;
use crate::patches::PATCH_VERTICES;

/// Writes single words.
pub(crate) const SCATTER: &str = include_str!("shaders/scatter.wgsl");

/// The most vertices of a body whose displacements fit so many bytes of workgroup memory.
pub(crate) fn capacity(bytes: u32) -> u32 {
    // 256 bytes are for what else a workgroup shares.
    (bytes - 256) / 12 / 64 * 64
}

/// So many vertices fewer fit if the body has volumes: the room of the leaves that their sums are made of.
pub(crate) const LEAVES: usize = (16 * CHUNK).div_ceil(12);

/// Lanes of a workgroup where nothing speaks for another number.
#[cfg(test)]
pub(crate) const WORKGROUP_SIZE: u32 = 64;

/// The most vertices of a body whose displacements fit the 16 KiB of workgroup memory that every device
/// has, in whole workgroups of [`WORKGROUP_SIZE`].
#[cfg(test)]
pub(crate) const CAPACITY: u32 = 1344;

/// The entry point of the module for whole bodies.
pub(crate) const WHOLE_BODY: &str = "whole_body";

/// The entry points of the module for patches: all constraints of the layer whose number less 1 is the
/// pass's color, a workgroup a patch; and their multipliers set to zero.
pub(crate) const PATCHES: &str = "patches";
pub(crate) const RESET_PATCHES: &str = "reset_patches";

/// The entry points of the module that has one dispatch a pass.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum EntryPoint {
    /// A lane a vertex.
    Predict,
    /// A lane a pin.
    Pins,
    /// A lane a tether.
    Tethers,
    /// A lane a constraint of the longest run of the pass's colors and, if asked for, the overflow.
    ResetMultipliers,
    /// A lane a constraint of the pass's color, be it edges or struts.
    Stretch,
    /// A lane a constraint of the pass's color.
    Bending,
    /// A workgroup a body: the pass's colors of its kind in order, then the overflow if asked for.
    Tail,
    /// A workgroup a chunk of spokes.
    SumVolumes,
    /// A workgroup a piece.
    StepVolumes,
    /// A workgroup a chunk of spokes.
    MoveVolumes,
    /// A lane a piece.
    ResetVolumes,
    /// A lane a vertex.
    Colliders,
    /// A lane a vertex.
    Ground,
    /// A lane a vertex.
    Integrate,
    /// A lane a link.
    ResetBounds,
    /// A lane a vertex, after [`EntryPoint::ResetBounds`].
    Bounds,
}

impl EntryPoint {
    /// All of them, each at the place of its number.
    pub(crate) const ALL: [Self; 16] = [
        Self::Predict,
        Self::Pins,
        Self::Tethers,
        Self::ResetMultipliers,
        Self::Stretch,
        Self::Bending,
        Self::Tail,
        Self::SumVolumes,
        Self::StepVolumes,
        Self::MoveVolumes,
        Self::ResetVolumes,
        Self::Colliders,
        Self::Ground,
        Self::Integrate,
        Self::ResetBounds,
        Self::Bounds,
    ];

    /// The name of the function.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Predict => "predict",
            Self::Pins => "pins",
            Self::Tethers => "tethers",
            Self::ResetMultipliers => "reset_multipliers",
            Self::Stretch => "stretch",
            Self::Bending => "bending",
            Self::Tail => "tail",
            Self::SumVolumes => "sum_volumes",
            Self::StepVolumes => "step_volumes",
            Self::MoveVolumes => "move_volumes",
            Self::ResetVolumes => "reset_volumes",
            Self::Colliders => "colliders",
            Self::Ground => "ground",
            Self::Integrate => "integrate",
            Self::ResetBounds => "reset_bounds",
            Self::Bounds => "bounds",
        }
    }
}

const SHARED: [&str; 14] = [
    include_str!("shaders/types.wgsl"),
    include_str!("shaders/bits.wgsl"),
    include_str!("shaders/links.wgsl"),
    include_str!("../kernels/predict.wgsl"),
    include_str!("../kernels/pins.wgsl"),
    include_str!("../kernels/tethers.wgsl"),
    include_str!("../kernels/stretch.wgsl"),
    include_str!("../kernels/arctangent.wgsl"),
    include_str!("../kernels/bending.wgsl"),
    include_str!("../kernels/contacts.wgsl"),
    include_str!("../kernels/colliders.wgsl"),
    include_str!("../kernels/ground.wgsl"),
    include_str!("../kernels/integrate.wgsl"),
    include_str!("shaders/sweep.wgsl"),
];

/// The module that has one dispatch a pass; its entry points are those of [`EntryPoint`].
pub(crate) fn colors(workgroup_size: u32, tail_size: u32) -> String {
    let parts = [
        include_str!("shaders/storage.wgsl"),
        include_str!("../kernels/volume.wgsl"),
        include_str!("../kernels/bounds.wgsl"),
        include_str!("shaders/volumes.wgsl"),
        include_str!("shaders/colors.wgsl"),
    ];
    let constants = [("WORKGROUP_SIZE", workgroup_size), ("TAIL_SIZE", tail_size)];
    compose(&constants, &parts)
}

/// The module in which one workgroup steps a body of up to `capacity` vertices through a frame; its
/// entry point is [`WHOLE_BODY`].
pub(crate) fn whole_body(workgroup_size: u32, capacity: u32) -> String {
    let constants = [("WORKGROUP_SIZE", workgroup_size), ("CAPACITY", capacity)];
    let parts = [
        include_str!("shaders/workgroup.wgsl"),
        include_str!("../kernels/volume.wgsl"),
        include_str!("shaders/whole_body.wgsl"),
    ];
    compose(&constants, &parts)
}

/// The module in which one workgroup works on a patch; its entry points are [`PATCHES`] and
/// [`RESET_PATCHES`].
pub(crate) fn patches(workgroup_size: u32) -> String {
    let constants = [
        ("WORKGROUP_SIZE", workgroup_size),
        ("PATCH_VERTICES", PATCH_VERTICES),
    ];
    compose(&constants, &[include_str!("shaders/patches.wgsl")])
}

fn compose(constants: &[(&str, u32)], parts: &[&str]) -> String {
    #[expect(
        clippy::cast_possible_truncation,
        reason = "small constants of this crate"
    )]
    let layout = [
        ("RUN_COLORS", RUN_COLORS as u32),
        ("OVERFLOW", OVERFLOW as u32),
        ("MAX_COLORS", MAX_COLORS as u32),
        ("STRETCH", STRETCH),
        ("BENDING", BENDING),
        ("STRUTS", STRUTS),
        ("CONTACTS", CONTACTS),
        ("CONTACT_ENTRIES", CONTACT_ENTRIES as u32),
        ("NO_CORNER", NO_CORNER),
        ("COLLIDER_ENTRIES", COLLIDER_ENTRIES as u32),
        ("PLANE", PLANE),
        ("ROUND", ROUND),
        ("STRETCH_ENTRIES", STRETCH_ENTRIES as u32),
        ("BENDING_ENTRIES", BENDING_ENTRIES as u32),
        ("PIN_ENTRIES", PIN_ENTRIES as u32),
        ("TETHER_ENTRIES", TETHER_ENTRIES as u32),
        ("KEEPS_STRETCH", KEEPS_STRETCH),
        ("KEEPS_BENDING", KEEPS_BENDING),
        ("PIECE_ENTRIES", PIECE_ENTRIES as u32),
        ("CHUNK_ENTRIES", CHUNK_ENTRIES as u32),
        ("KEEPS_VOLUME", KEEPS_VOLUME),
        ("KEEPS_STRUTS", KEEPS_STRUTS),
        ("CHUNK", CHUNK as u32),
    ];
    let constants = constants
        .iter()
        .chain(&layout)
        .map(|(name, value)| format!("const {name}: u32 = {value}u;\n"));
    constants
        .chain(SHARED.iter().chain(parts).map(|&part| part.to_owned()))
        .collect()
}

#[cfg(test)]
mod tests;
