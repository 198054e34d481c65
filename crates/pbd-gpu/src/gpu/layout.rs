//! What is in the device's buffers: the twins of the structs in `shaders/types.wgsl`.

use crate::coloring::LAYERS;
use crate::constraints::OVERFLOW;
use bytemuck::{Pod, Zeroable};

/// Runs of one kind of constraint that a body has: one a color, the overflow last.
pub(crate) const RUN_COLORS: usize = OVERFLOW + 1;

/// Runs that a body has: [`STRETCH`] first, then [`BENDING`], [`STRUTS`] and [`CONTACTS`].
pub(crate) const RUNS_PER_BODY: usize = 4 * RUN_COLORS;
/// The same number as the device counts.
#[expect(clippy::cast_possible_truncation, reason = "some hundred")]
pub(crate) const RUN_STRIDE: u32 = RUNS_PER_BODY as u32;

/// Layers of colors that patches hold.
pub(crate) const PATCH_LAYERS: usize = LAYERS - 1;

/// The kind of a pass over stretch constraints.
pub(crate) const STRETCH: u32 = 0;

/// The kind of a pass over bending constraints.
pub(crate) const BENDING: u32 = 1;

/// The kind of a pass over struts, which are stretch constraints with a stiffness of their own.
pub(crate) const STRUTS: u32 = 2;

/// The kind of a pass over contacts.
pub(crate) const CONTACTS: u32 = 3;

/// Entries that a contact takes, as its [record](crate::contacts::ContactRecord) lies in memory.
pub(crate) const CONTACT_ENTRIES: usize = size_of::<crate::contacts::ContactRecord>() / 8;

/// Entries that a collider takes, as its [record](crate::colliders::ColliderRecord) lies in memory.
pub(crate) const COLLIDER_ENTRIES: usize = size_of::<crate::colliders::ColliderRecord>() / 8;

/// Entries of the constraint arena that a stretch constraint or a strut takes: its ends; rest and multiplier.
pub(crate) const STRETCH_ENTRIES: usize = 2;

/// Entries that a bending constraint takes: the hinge; the wings; rest and multiplier.
pub(crate) const BENDING_ENTRIES: usize = 3;

/// Entries that a pin takes: vertex and x; y and z.
pub(crate) const PIN_ENTRIES: usize = 2;

/// Entries that a tether takes: vertex and anchor; length.
pub(crate) const TETHER_ENTRIES: usize = 2;

/// Entries of a piece with a volume: first chunk and number of chunks; rest and reach; multiplier and its last change; the
/// vertex from which it is seen.
pub(crate) const PIECE_ENTRIES: usize = 4;

/// Entries of a chunk of spokes: first spoke and number of spokes; piece; its four sums.
pub(crate) const CHUNK_ENTRIES: usize = 4;

/// Flag of a body whose stretch constraints remember their multipliers.
pub(crate) const KEEPS_STRETCH: u32 = 1;

/// Flag of a body whose bending constraints remember their multipliers.
pub(crate) const KEEPS_BENDING: u32 = 2;

/// Flag of a body whose volume constraints remember their multipliers.
pub(crate) const KEEPS_VOLUME: u32 = 4;

/// Flag of a body whose struts remember their multipliers.
pub(crate) const KEEPS_STRUTS: u32 = 8;

/// The inverse mass of a slot that no triangle uses. It does not move, as if it were pinned.
pub(crate) const UNUSED: f32 = -1.0;

/// An entry of the constraint arena.
pub(crate) type Entry = [u32; 2];

/// The numbers of a frame that all bodies share.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub(crate) struct FrameUniform {
    /// Change of velocity a substep [m/s].
    pub(crate) gravity_step: [f32; 3],
    /// Time step of a substep \[s\].
    pub(crate) h: f32,
    /// Height of the ground \[m\]; any finite number without one.
    pub(crate) ground: f32,
    /// Whether there is a ground: 0 or 1.
    pub(crate) has_ground: u32,
    pub(crate) substeps: u32,
    pub(crate) iterations: u32,
    /// Whether somebody wants to know how far bodies move: 0 or 1.
    pub(crate) notes_motion: u32,
    /// As in [`SolverParams`](crate::SolverParams).
    pub(crate) own_weight: f32,
    pub(crate) pad: [u32; 2],
}

/// What one dispatch covers.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
pub(crate) struct PassUniform {
    /// The first [`Link`]; its first group is 0.
    pub(crate) first_link: u32,
    /// How many links there are, at least 1.
    pub(crate) links: u32,
    /// [`STRETCH`], [`BENDING`], [`STRUTS`] or [`CONTACTS`].
    pub(crate) kind: u32,
    /// The color, or the first one.
    pub(crate) color: u32,
    /// How many colors from `color` on `tail` and `reset_multipliers` take; substeps that `whole_body` does.
    pub(crate) colors: u32,
    /// Whether these two take the overflow too: 0 or 1.
    pub(crate) with_overflow: u32,
    /// Number of the substep in its frame.
    pub(crate) substep: u32,
    pub(crate) pad: u32,
}

/// Where the parts of a body are and how it is projected.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub(crate) struct BodyRecord {
    pub(crate) first_vertex: u32,
    /// Vertex slots.
    pub(crate) vertices: u32,
    /// The first pin's place among the [entries](Entry) of the constraint arena.
    pub(crate) first_pin: u32,
    pub(crate) pins: u32,
    /// The first tether's place among the entries.
    pub(crate) first_tether: u32,
    pub(crate) tethers: u32,
    pub(crate) stretch_factor: f32,
    pub(crate) stretch_alpha: f32,
    pub(crate) stretch_old: f32,
    pub(crate) bending_factor: f32,
    pub(crate) bending_alpha: f32,
    pub(crate) bending_old: f32,
    /// What is left of a velocity after a substep's damping.
    pub(crate) kept_velocity: f32,
    /// Coulomb's coefficient.
    pub(crate) friction: f32,
    /// [`KEEPS_STRETCH`], [`KEEPS_BENDING`], [`KEEPS_VOLUME`] and [`KEEPS_STRUTS`].
    pub(crate) flags: u32,
    /// The first of its [`RUNS_PER_BODY`] runs.
    pub(crate) first_run: u32,
    /// Colors of stretch constraints, from color 0 on.
    pub(crate) stretch_colors: u32,
    /// Colors of bending constraints, from color 0 on; 0 without bending.
    pub(crate) bending_colors: u32,
    /// Of each layer of patches, the entry where their table begins. It has an entry a patch: where its
    /// block begins, and 0.
    pub(crate) patch_tables: [u32; PATCH_LAYERS],
    /// How many patches each layer has.
    pub(crate) patches: [u32; PATCH_LAYERS],
    /// Where the pieces that have a volume begin among the entries, and how many there are.
    pub(crate) first_piece: u32,
    pub(crate) pieces: u32,
    /// Where their chunks do.
    pub(crate) first_chunk: u32,
    pub(crate) chunks: u32,
    /// Where their spokes do: an entry each, vertex and half-edge.
    pub(crate) first_spoke: u32,
    /// Where the surface's half-edges do: an entry each, origin and twin.
    pub(crate) first_corner: u32,
    pub(crate) corners: u32,
    pub(crate) volume_alpha: f32,
    pub(crate) volume_pressure: f32,
    pub(crate) volume_returned: f32,
    pub(crate) volume_old: f32,
    /// Colors of struts, from color 0 on; 0 without struts.
    pub(crate) strut_colors: u32,
    pub(crate) strut_factor: f32,
    pub(crate) strut_alpha: f32,
    pub(crate) strut_old: f32,
    /// How many contacts there are.
    pub(crate) contacts: u32,
    /// Where the colliders begin among the entries, and how many there are.
    pub(crate) first_collider: u32,
    pub(crate) colliders: u32,
}

/// The constraints of one color of one body.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Pod, Zeroable)]
pub(crate) struct Run {
    /// The first one's place among the [entries](Entry).
    pub(crate) first: u32,
    /// How many constraints there are.
    pub(crate) len: u32,
}

/// That a body is worked on by the workgroups from `first_group` to the next link's. A pass's links
/// ascend; its last one takes all groups that are left.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
pub(crate) struct Link {
    /// The first workgroup, counted from the first one of the dispatch.
    pub(crate) first_group: u32,
    /// Number of the body.
    pub(crate) body: u32,
}

/// What a device finds out about a body. Numbers are [`ordered`].
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
pub(crate) struct Report {
    /// The lowest predicted height of even and odd substeps \[m\].
    pub(crate) lowest: [u32; 2],
    /// The least corner of the box \[m\].
    pub(crate) box_min: [u32; 3],
    /// The greatest corner of the box \[m\].
    pub(crate) box_max: [u32; 3],
    /// The first vertex that left the numbers, [`u32::MAX`] if none did.
    pub(crate) bad_vertex: u32,
    /// In which substep it did, [`u32::MAX`] if none did.
    pub(crate) bad_substep: u32,
    /// The farthest that a vertex moved along an axis in a substep since the host set it to 0 \[m\]: plain bits.
    pub(crate) farthest: u32,
    pub(crate) pad: u32,
}

impl Report {
    /// Before the first frame: nothing is known and nothing is wrong.
    pub(crate) fn new() -> Self {
        let (highest, least) = (ordered(f32::INFINITY), ordered(f32::NEG_INFINITY));
        Self {
            lowest: [highest; 2],
            box_min: [highest; 3],
            box_max: [least; 3],
            bad_vertex: u32::MAX,
            bad_substep: u32::MAX,
            farthest: 0,
            pad: 0,
        }
    }

    /// The box, least corner first \[m\].
    pub(crate) fn bounds(&self) -> [[f32; 3]; 2] {
        [self.box_min, self.box_max].map(|corner| corner.map(from_ordered))
    }

    /// The first vertex that left the numbers and the substep in which it did.
    pub(crate) fn non_finite(&self) -> Option<(u32, u32)> {
        (self.bad_vertex != u32::MAX).then_some((self.bad_vertex, self.bad_substep))
    }
}

/// Bits that compare as the numbers do, so that a device can take the least of them with integer
/// atomics; -0 comes before 0.
pub(crate) fn ordered(value: f32) -> u32 {
    let bits = value.to_bits();
    bits ^ if value.is_sign_negative() {
        u32::MAX
    } else {
        1 << 31
    }
}

/// The number of [`ordered`] bits.
pub(crate) fn from_ordered(bits: u32) -> f32 {
    f32::from_bits(bits ^ if bits >> 31 == 0 { u32::MAX } else { 1 << 31 })
}

#[cfg(test)]
mod tests {
    use super::*;

    const ASCENDING: [f32; 12] = [
        f32::NEG_INFINITY,
        f32::MIN,
        -1.5,
        -1.0,
        -f32::MIN_POSITIVE,
        -1e-45,
        -0.0,
        0.0,
        1e-45,
        f32::MIN_POSITIVE,
        f32::MAX,
        f32::INFINITY,
    ];

    #[test]
    fn ordered_bits_ascend_with_the_numbers() {
        for pair in ASCENDING.windows(2) {
            assert!(ordered(pair[0]) < ordered(pair[1]), "{pair:?}");
        }
        // The shaders know these two by heart.
        assert_eq!(ordered(f32::INFINITY), 0xff80_0000);
        assert_eq!(ordered(f32::NEG_INFINITY), 0x007f_ffff);
    }

    #[test]
    fn ordered_bits_go_there_and_back() {
        for value in ASCENDING {
            assert_eq!(from_ordered(ordered(value)).to_bits(), value.to_bits());
        }
        for i in 0..=u32::MAX >> 12 {
            let bits = i.wrapping_mul(0x9e37_79b9);
            assert_eq!(ordered(from_ordered(bits)), bits);
        }
    }
}
