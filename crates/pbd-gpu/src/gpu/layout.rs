//! Layouts of the GPU buffers, as in `shaders/types.wgsl`.

use crate::constraints::batches::OVERFLOW;
use crate::constraints::coloring::LAYERS;
use crate::step::pass::ConstraintKind;
use bytemuck::{Pod, Zeroable};

/// Runs per body and kind of constraint: one per color, the overflow last.
pub(crate) const RUN_COLORS: usize = OVERFLOW + 1;

/// Runs per body: [`STRETCH`], then [`BENDING`], [`INTERIOR_SPRINGS`] and [`CONTACTS`].
pub(crate) const RUNS_PER_BODY: usize = 4 * RUN_COLORS;
/// [`RUNS_PER_BODY`] as a 32-bit number.
#[expect(clippy::cast_possible_truncation, reason = "some hundred")]
pub(crate) const RUN_STRIDE: u32 = RUNS_PER_BODY as u32;

/// Layers of constraints within patches.
pub(crate) const PATCH_LAYERS: usize = LAYERS - 1;

/// Kind of a pass over stretch constraints.
pub(crate) const STRETCH: u32 = ConstraintKind::Stretch as u32;

/// Kind of a pass over bending constraints.
pub(crate) const BENDING: u32 = ConstraintKind::Bending as u32;

/// Kind of a pass over interior springs, which are projected like stretch constraints.
pub(crate) const INTERIOR_SPRINGS: u32 = ConstraintKind::InteriorSpring as u32;

/// Kind of a pass over contacts.
pub(crate) const CONTACTS: u32 = 3;

/// Kind of a pass that finds the features of contacts.
pub(crate) const CONTACT_FEATURES: u32 = 4;

/// Kind of a pass that lets contacts separate without velocity.
pub(crate) const CONTACT_RECOVERIES: u32 = 5;

/// Entries of a contact, see [`ContactRecord`](crate::constraints::contacts::ContactRecord).
pub(crate) const CONTACT_ENTRIES: usize =
    size_of::<crate::constraints::contacts::ContactRecord>() / 8;

/// Entries of a collider, see [`ColliderRecord`](crate::constraints::colliders::ColliderRecord).
pub(crate) const COLLIDER_ENTRIES: usize =
    size_of::<crate::constraints::colliders::ColliderRecord>() / 8;

/// Entries of a stretch constraint or an interior spring: ends; rest length and multiplier.
pub(crate) const STRETCH_ENTRIES: usize = 2;

/// Entries of a bending constraint: ends; opposite vertices; rest angle and multiplier.
pub(crate) const BENDING_ENTRIES: usize = 3;

/// Entries of a pin: vertex and x; y and z.
pub(crate) const PIN_ENTRIES: usize = 2;

/// Entries of a long range attachment: vertex and anchor; length.
pub(crate) const ATTACHMENT_ENTRIES: usize = 2;

/// Entries of a piece with volume: first chunk and number of chunks; rest volume and maximum
/// displacement; multiplier and its last change; reference vertex and step of positions; mean
/// displacement and number of the round; motion of the round.
pub(crate) const PIECE_ENTRIES: usize = 8;

/// Entries of a chunk: first spoke and number of spokes; piece; four sums; four sums of the motion.
pub(crate) const CHUNK_ENTRIES: usize = 6;

/// Flag of a body whose stretch multipliers accumulate.
pub(crate) const KEEPS_STRETCH: u32 = 1;

/// Flag of a body whose bending multipliers accumulate.
pub(crate) const KEEPS_BENDING: u32 = 2;

/// Flag of a body whose volume multipliers accumulate.
pub(crate) const KEEPS_VOLUME: u32 = 4;

/// Flag of a body whose interior spring multipliers accumulate.
pub(crate) const KEEPS_INTERIOR_SPRINGS: u32 = 8;

/// Flag of a body whose lengths are projected forward and back.
pub(crate) const SWEEPS_BACK: u32 = 16;

/// Flag of a body whose pieces meet fast in the frame.
pub(crate) const IS_PRESSED: u32 = 32;

/// Inverse mass of an unused slot, which does not move.
pub(crate) const UNUSED: f32 = -1.0;

/// An entry of the constraint arena.
pub(crate) type Entry = [u32; 2];

/// Parameters of a frame.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub(crate) struct FrameUniform {
    /// Change of velocity by gravity per substep [m/s].
    pub(crate) gravity_step: [f32; 3],
    /// Time step of a substep \[s\].
    pub(crate) h: f32,
    /// Height of the ground \[m\]; unused without ground.
    pub(crate) ground: f32,
    /// 1 if there is a ground, else 0.
    pub(crate) has_ground: u32,
    pub(crate) substeps: u32,
    pub(crate) iterations: u32,
    /// Rounds of contacts and volumes per iteration.
    pub(crate) contact_rounds: u32,
    /// 1 if the motion of a body is measured, else 0.
    pub(crate) measures_motion: u32,
    /// As in [`SolverParams`](crate::SolverParams).
    pub(crate) diagonal_scale: f32,
    pub(crate) pad: u32,
}

/// Parameters of a dispatch.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
pub(crate) struct PassUniform {
    /// Index of the first [`Link`], whose first group is 0.
    pub(crate) first_link: u32,
    /// Number of links, at least 1.
    pub(crate) links: u32,
    /// [`STRETCH`], [`BENDING`], [`INTERIOR_SPRINGS`] or [`CONTACTS`].
    pub(crate) kind: u32,
    /// Color, or first color.
    pub(crate) color: u32,
    /// Number of colors of `tail` and `reset_multipliers`; number of substeps of `whole_body`.
    pub(crate) colors: u32,
    /// 1 if these two kernels include the overflow, else 0.
    pub(crate) with_overflow: u32,
    /// Index of the substep in the frame.
    pub(crate) substep: u32,
    /// 1 if `tail` and `patches` project lengths in reverse order, else 0.
    pub(crate) is_back: u32,
}

/// Offsets and coefficients of a body.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub(crate) struct BodyRecord {
    pub(crate) first_vertex: u32,
    /// Vertex slots.
    pub(crate) vertices: u32,
    /// First pin in the [entries](Entry).
    pub(crate) first_pin: u32,
    pub(crate) pins: u32,
    /// First attachment in the entries.
    pub(crate) first_attachment: u32,
    pub(crate) attachments: u32,
    pub(crate) stretch_factor: f32,
    pub(crate) stretch_alpha: f32,
    pub(crate) stretch_carryover: f32,
    pub(crate) bending_factor: f32,
    pub(crate) bending_alpha: f32,
    pub(crate) bending_carryover: f32,
    /// Factor of velocities per substep, from damping.
    pub(crate) velocity_factor: f32,
    /// Coulomb friction coefficient.
    pub(crate) friction: f32,
    /// [`KEEPS_STRETCH`], [`KEEPS_BENDING`], [`KEEPS_VOLUME`], [`KEEPS_INTERIOR_SPRINGS`] and
    /// [`SWEEPS_BACK`], [`IS_PRESSED`].
    pub(crate) flags: u32,
    /// First of its [`RUNS_PER_BODY`] runs.
    pub(crate) first_run: u32,
    /// Number of colors of stretch constraints.
    pub(crate) stretch_colors: u32,
    /// Number of colors of bending constraints.
    pub(crate) bending_colors: u32,
    /// First entry of the table of each patch layer; a table entry is the first entry of a block
    /// and 0.
    pub(crate) patch_tables: [u32; PATCH_LAYERS],
    /// Number of patches of each layer.
    pub(crate) patches: [u32; PATCH_LAYERS],
    /// First entry and number of pieces with volume.
    pub(crate) first_piece: u32,
    pub(crate) pieces: u32,
    /// First entry and number of chunks.
    pub(crate) first_chunk: u32,
    pub(crate) chunks: u32,
    /// First entry of spokes: vertex and half-edge.
    pub(crate) first_spoke: u32,
    /// First entry and number of half-edges: origin and twin.
    pub(crate) first_corner: u32,
    pub(crate) corners: u32,
    pub(crate) volume_alpha: f32,
    pub(crate) volume_pressure: f32,
    pub(crate) volume_recovery: f32,
    pub(crate) volume_sink: f32,
    pub(crate) volume_carryover: f32,
    /// Number of colors of interior springs.
    pub(crate) spring_colors: u32,
    pub(crate) spring_factor: f32,
    pub(crate) spring_alpha: f32,
    pub(crate) spring_carryover: f32,
    /// Number of contacts.
    pub(crate) contacts: u32,
    /// First entry and number of colliders.
    pub(crate) first_collider: u32,
    pub(crate) colliders: u32,
}

/// The constraints of one color of a body.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Pod, Zeroable)]
pub(crate) struct Run {
    /// First [entry](Entry).
    pub(crate) first: u32,
    /// Number of constraints.
    pub(crate) len: u32,
}

/// Assigns the workgroups from `first_group` up to that of the next link to a body.
///
/// The links of a pass ascend; the last one has all remaining groups.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
pub(crate) struct Link {
    /// First workgroup in the dispatch.
    pub(crate) first_group: u32,
    /// Index of the body.
    pub(crate) body: u32,
}

/// Results of a body from the GPU, as [`ordered`] bits.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
pub(crate) struct Report {
    /// Minimum predicted height of even and odd substeps \[m\].
    pub(crate) lowest: [u32; 2],
    /// Minimum corner of the bounding box \[m\].
    pub(crate) box_min: [u32; 3],
    /// Maximum corner of the bounding box \[m\].
    pub(crate) box_max: [u32; 3],
    /// First vertex with a position that is not finite, or [`u32::MAX`].
    pub(crate) bad_vertex: u32,
    /// Substep in which it became so, or [`u32::MAX`].
    pub(crate) bad_substep: u32,
    /// Maximum displacement along an axis in a substep since the last reset \[m\], as plain bits.
    pub(crate) max_displacement: u32,
    pub(crate) pad: u32,
}

impl Report {
    /// Returns the report before the first frame.
    pub(crate) fn new() -> Self {
        let (highest, least) = (ordered(f32::INFINITY), ordered(f32::NEG_INFINITY));
        Self {
            lowest: [highest; 2],
            box_min: [highest; 3],
            box_max: [least; 3],
            bad_vertex: u32::MAX,
            bad_substep: u32::MAX,
            max_displacement: 0,
            pad: 0,
        }
    }

    /// Returns minimum and maximum corner of the bounding box \[m\].
    pub(crate) fn bounds(&self) -> [[f32; 3]; 2] {
        [self.box_min, self.box_max].map(|corner| corner.map(from_ordered))
    }

    /// Returns the first vertex with a position that is not finite, and the substep.
    pub(crate) fn non_finite(&self) -> Option<(u32, u32)> {
        (self.bad_vertex != u32::MAX).then_some((self.bad_vertex, self.bad_substep))
    }
}

/// Returns bits in the order of the floats, for integer atomics; -0 comes before 0.
pub(crate) fn ordered(value: f32) -> u32 {
    let bits = value.to_bits();
    bits ^ if value.is_sign_negative() {
        u32::MAX
    } else {
        1 << 31
    }
}

/// Returns the float of [`ordered`] bits.
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
    fn ordered_bits_have_the_order_of_floats() {
        for pair in ASCENDING.windows(2) {
            assert!(ordered(pair[0]) < ordered(pair[1]), "{pair:?}");
        }
        // The shaders contain these two constants.
        assert_eq!(ordered(f32::INFINITY), 0xff80_0000);
        assert_eq!(ordered(f32::NEG_INFINITY), 0x007f_ffff);
    }

    #[test]
    fn ordered_bits_round_trip() {
        for value in ASCENDING {
            assert_eq!(from_ordered(ordered(value)).to_bits(), value.to_bits());
        }
        for i in 0..=u32::MAX >> 12 {
            let bits = i.wrapping_mul(0x9e37_79b9);
            assert_eq!(ordered(from_ordered(bits)), bits);
        }
    }
}
