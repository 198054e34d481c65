//! Layouts of the GPU buffers. Each struct is declared once, for Rust and for WGSL.

use crate::constraints::batches::OVERFLOW;
use crate::constraints::coloring::LAYERS;
use crate::step::pass::ConstraintKind;
use bytemuck::{Pod, Zeroable};

/// Runs per body and kind of constraint: one per color, the overflow last.
pub(crate) const RUN_COLORS: usize = OVERFLOW + 1;

/// Runs per body: [`STRETCH`], then [`BENDING`], [`INTERIOR_SPRINGS`], [`CELLS`] and [`CONTACTS`].
pub(crate) const RUNS_PER_BODY: usize = 5 * RUN_COLORS;
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

/// Kind of a pass over the cells of a solid.
pub(crate) const CELLS: u32 = 3;

/// Kind of a pass over contacts.
pub(crate) const CONTACTS: u32 = 4;

/// Kind of a pass that finds the features of contacts.
pub(crate) const CONTACT_FEATURES: u32 = 5;

/// Kind of a pass that lets contacts separate without velocity.
pub(crate) const CONTACT_RECOVERIES: u32 = 6;

/// Kind of a pass that adds the forces of cells to those of nodes, as the prediction repeats them.
pub(crate) const CELL_FORCES: u32 = 7;

/// Entries of a cell: nodes; centroid and fraction; bending; mode weights; strain weight; state.
pub(crate) const CELL_ENTRIES: usize = 24;

/// First entry of the state of a cell: rotation; stress; forces of hourglass modes.
pub(crate) const CELL_STATE: usize = 13;

/// Entries of a vertex of a solid: nodes; weights.
pub(crate) const EMBEDDING_ENTRIES: usize = 8;

/// Entries of the start of a pinned vertex of a solid: x and y; z.
pub(crate) const PIN_START_ENTRIES: usize = 2;

/// Entries of a vertex of a solid near a collider: vertex and sum of normal pushes; sum of pushes
/// by friction.
pub(crate) const NEAR_ENTRIES: usize = 3;

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

/// Flag of a body whose pieces meet fast in the frame.
pub(crate) const IS_PRESSED: u32 = 16;

/// Flag of a body with a guard in the frame.
pub(crate) const IS_GUARDED: u32 = 32;

/// Flag of a body whose momenta and energy are conserved.
pub(crate) const CONSERVES: u32 = 64;

/// Flag of a body on which something does unknown work.
pub(crate) const IS_DRIVEN: u32 = 128;

/// Flag of a body with contacts.
pub(crate) const HAS_CONTACTS: u32 = 256;

/// Flag of a body whose energy budget is unlimited at the start of the frame.
pub(crate) const IS_UNLIMITED: u32 = 512;

/// Flag of a body whose elastic energy is measured at the end of the frame.
pub(crate) const MEASURES_ELASTIC_ENERGY: u32 = 1024;

/// Flag of a solid whose forces at nodes are summed again before the frame.
pub(crate) const SUMS_FORCES: u32 = 2048;

/// Entries of a piece of the guard.
///
/// First vertex in the list and number of vertices; motion at the start of the frame; motion at its
/// end and its change.
pub(crate) const GUARD_ENTRIES: usize = 18;

/// Inverse mass of an unused slot, which does not move.
pub(crate) const UNUSED: f32 = -1.0;

/// An entry of the constraint arena.
pub(crate) type Entry = [u32; 2];

/// Returns the name of a type in WGSL.
macro_rules! wgsl_type {
    (f32) => {
        "f32"
    };
    (u32) => {
        "u32"
    };
    ([f32; 3]) => {
        "vec3f"
    };
    ([f32; 4]) => {
        "vec4f"
    };
    ([u32; $count:tt]) => {
        concat!("array<u32, ", stringify!($count), ">")
    };
    ((atomic u32)) => {
        "atomic<u32>"
    };
    ((atomic [u32; $count:tt])) => {
        concat!("array<atomic<u32>, ", stringify!($count), ">")
    };
}

/// Returns a type without the mark of atomics.
macro_rules! rust_type {
    ((atomic $ty:ty)) => {
        $ty
    };
    ($ty:ty) => {
        $ty
    };
}

/// Declares a struct of the buffers for Rust and for WGSL.
macro_rules! gpu_struct {
    (
        $(#[$meta:meta])*
        struct $name:ident as $wgsl:literal {
            $( $(#[$member_meta:meta])* $member:ident: $ty:tt, )*
        }
    ) => {
        $(#[$meta])*
        #[repr(C)]
        #[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
        pub(crate) struct $name {
            $( $(#[$member_meta])* pub(crate) $member: rust_type!($ty), )*
        }

        impl $name {
            /// The declaration in WGSL.
            pub(crate) const WGSL: &str = concat!(
                "struct ", $wgsl, " {\n",
                $( "    ", stringify!($member), ": ", wgsl_type!($ty), ",\n", )*
                "}\n\n",
            );

            /// Names and offsets of the members.
            #[cfg(test)]
            pub(crate) const MEMBERS: &[(&str, usize)] =
                &[$( (stringify!($member), std::mem::offset_of!($name, $member)), )*];
        }
    };
}

/// Declarations of all structs in WGSL.
pub(crate) const STRUCTS: [&str; 7] = [
    FrameUniform::WGSL,
    PassUniform::WGSL,
    BodyRecord::WGSL,
    Run::WGSL,
    Link::WGSL,
    Report::WGSL,
    Motion::WGSL,
];

gpu_struct! {
    /// Parameters of a frame.
    struct FrameUniform as "Frame" {
        /// Change of velocity by gravity per substep [m/s].
        gravity_step: [f32; 3],
        /// Time step of a substep \[s\].
        h: f32,
        substeps: u32,
        iterations: u32,
        /// Rounds of contacts and volumes per iteration.
        contact_rounds: u32,
        /// 1 if the motion of a body is measured, else 0.
        measures_motion: u32,
        /// Time of the frame per substep, by which colliders move \[s\].
        collider_step: f32,
        /// Share of the last displacement by constraints that the prediction repeats.
        lift: f32,
        /// As in [`SolverParams`](crate::SolverParams).
        diagonal_scale: f32,
        pad: f32,
    }
}

gpu_struct! {
    /// Parameters of a dispatch.
    #[derive(Eq)]
    struct PassUniform as "Pass" {
        /// Index of the first [`Link`], whose first group is 0.
        first_link: u32,
        /// Number of links, at least 1.
        links: u32,
        /// [`STRETCH`] or one of the kinds after it.
        kind: u32,
        /// Color, or first color.
        color: u32,
        /// Number of colors of `tail` and `reset_multipliers`; number of substeps of `whole_body`.
        colors: u32,
        /// 1 if these two kernels include the overflow, else 0.
        with_overflow: u32,
        /// Index of the substep in the frame.
        substep: u32,
        /// 1 if `tail` and `patches` project in reverse order, else 0.
        is_back: u32,
    }
}

gpu_struct! {
    /// Offsets and coefficients of a body.
    struct BodyRecord as "Body" {
        /// First particle: a vertex, or a node of a solid.
        first_vertex: u32,
        /// Number of particles: vertex slots, or nodes of a solid.
        vertices: u32,
        /// First vertex of the surface.
        first_surface_vertex: u32,
        /// Vertex slots of the surface.
        surface_vertices: u32,
        /// First pin in the [entries](Entry).
        first_pin: u32,
        pins: u32,
        /// First attachment in the entries.
        first_attachment: u32,
        attachments: u32,
        stretch_factor: f32,
        stretch_alpha: f32,
        bending_factor: f32,
        bending_alpha: f32,
        /// Coulomb friction coefficient.
        friction: f32,
        /// [`KEEPS_STRETCH`] and the flags after it.
        flags: u32,
        /// First of its [`RUNS_PER_BODY`] runs.
        first_run: u32,
        /// Number of colors of stretch constraints.
        stretch_colors: u32,
        /// Number of colors of bending constraints.
        bending_colors: u32,
        /// First entry of the table of each patch layer; a table entry is the first entry of a
        /// block and 0.
        patch_tables: [u32; PATCH_LAYERS],
        /// Number of patches of each layer.
        patches: [u32; PATCH_LAYERS],
        /// First entry and number of pieces with volume.
        first_piece: u32,
        pieces: u32,
        /// First entry and number of chunks.
        first_chunk: u32,
        chunks: u32,
        /// First entry of spokes: vertex and half-edge.
        first_spoke: u32,
        /// First entry and number of half-edges: origin and twin.
        first_corner: u32,
        corners: u32,
        volume_alpha: f32,
        volume_pressure: f32,
        volume_recovery: f32,
        volume_sink: f32,
        /// Number of colors of interior springs.
        spring_colors: u32,
        spring_factor: f32,
        spring_alpha: f32,
        /// Number of contacts.
        contacts: u32,
        /// First entry and number of colliders.
        first_collider: u32,
        colliders: u32,
        /// Number of planes, which are the last colliders.
        planes: u32,
        /// First entry and number of the pieces of the guard.
        first_guard: u32,
        guard_pieces: u32,
        /// Factor of the velocities relative to rigid motions per frame, from damping.
        damping_factor: f32,
        /// Factor of the slack beyond the elastic energy, if that is measured in the frame.
        relaxation: f32,
        /// Number of colors of cells.
        cell_colors: u32,
        /// First entry of the nodes and weights of vertices.
        first_embedding: u32,
        /// First entry of the starts of pinned vertices.
        first_pin_start: u32,
        /// First entry of the vertices near colliders: their number.
        first_near: u32,
        /// Length of the edges of a cell \[m\].
        cell_size: f32,
        /// Coefficients of cells, as in [`CellConstants`](crate::kernels::cells::CellConstants).
        cell_scale: f32,
        cell_unit: f32,
        cell_shape: f32,
        cell_volume: f32,
        cell_hourglass: f32,
        cell_square: f32,
        cell_viscosity: f32,
    }
}

gpu_struct! {
    /// The constraints of one color of a body.
    #[derive(Default, Eq)]
    struct Run as "Run" {
        /// First [entry](Entry).
        first: u32,
        /// Number of constraints.
        len: u32,
    }
}

gpu_struct! {
    /// Assigns the workgroups from `first_group` up to that of the next link to a body.
    ///
    /// The links of a pass ascend; the last one has all remaining groups.
    #[derive(Eq)]
    struct Link as "Link" {
        /// First workgroup in the dispatch.
        first_group: u32,
        /// Index of the body.
        body: u32,
    }
}

gpu_struct! {
    /// The motion of a vertex.
    struct Motion as "Motion" {
        /// Velocity [m/s]; between prediction and integration the last component is the friction
        /// bound of colliders \[m\].
        velocity: [f32; 4],
        /// Displacement by constraints in the last substep \[m\], last component 0.
        correction: [f32; 4],
    }
}

gpu_struct! {
    /// Results of a body from the GPU, as [`ordered`] bits.
    #[derive(Eq)]
    struct Report as "Report" {
        /// Minimum corner of the bounding box \[m\].
        box_min: (atomic [u32; 3]),
        /// Maximum corner of the bounding box \[m\].
        box_max: (atomic [u32; 3]),
        /// First vertex with a position that is not finite, or [`u32::MAX`].
        bad_vertex: (atomic u32),
        /// Substep in which it became so, or [`u32::MAX`].
        bad_substep: (atomic u32),
        /// Maximum displacement along an axis in a substep since the last reset \[m\], as plain
        /// bits.
        max_displacement: (atomic u32),
        /// 1 if a vertex was in a collider in the frame, else 0.
        met_collider: (atomic u32),
        /// Slack of the energy budget \[J\], as plain bits.
        slack: (atomic u32),
    }
}

impl Report {
    /// Returns the report before the first frame, with the slack of the energy budget \[J\].
    pub(crate) fn new(slack: f32) -> Self {
        let (highest, least) = (ordered(f32::INFINITY), ordered(f32::NEG_INFINITY));
        Self {
            box_min: [highest; 3],
            box_max: [least; 3],
            bad_vertex: u32::MAX,
            bad_substep: u32::MAX,
            max_displacement: 0,
            met_collider: 0,
            slack: slack.to_bits(),
        }
    }

    /// Returns the slack of the energy budget \[J\].
    pub(crate) fn slack(&self) -> f32 {
        f32::from_bits(self.slack)
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
pub(crate) const fn ordered(value: f32) -> u32 {
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
