//! Constants of Rust that the shaders use, as WGSL.

use crate::constraints::batches::OVERFLOW;
use crate::constraints::colliders::{PLANE, ROUND};
use crate::constraints::coloring::MAX_COLORS;
use crate::constraints::contacts::{ContactKind, NO_VERTEX, SupportedSide};
use crate::constraints::interior_springs;
use crate::gpu::layout::{
    ATTACHMENT_ENTRIES, BENDING, BENDING_ENTRIES, CELL_ENTRIES, CELL_FORCES, CELL_STATE, CELLS,
    CHUNK_ENTRIES, COLLIDER_ENTRIES, CONSERVES, CONTACT_ENTRIES, CONTACT_FEATURES,
    CONTACT_RECOVERIES, CONTACTS, EMBEDDING_ENTRIES, GUARD_ENTRIES, HAS_CONTACTS, INTERIOR_SPRINGS,
    IS_DRIVEN, IS_GUARDED, IS_PRESSED, IS_UNLIMITED, KEEPS_BENDING, KEEPS_INTERIOR_SPRINGS,
    KEEPS_STRETCH, KEEPS_VOLUME, MEASURES_ELASTIC_ENERGY, NEAR_ENTRIES, PATCH_LAYERS,
    PIECE_ENTRIES, PIN_ENTRIES, PIN_START_ENTRIES, RUN_COLORS, STRETCH, STRETCH_ENTRIES,
    SUMS_FORCES, ordered,
};
use crate::kernels::arctangent::COEFFICIENTS;
use crate::kernels::cells::rotation;
use crate::kernels::volume::{self, CHUNK, motion, steps};
use crate::kernels::{
    attachments, bending, cells, colliders, contact_features, contacts, elastic, points,
    rigid_motion,
};
use crate::step::{body, guard};
use std::f32::consts::{FRAC_PI_2, PI, TAU};
use std::fmt::Write;

/// Constants of the layout and of constraints.
#[expect(
    clippy::cast_possible_truncation,
    reason = "small constants of this crate"
)]
const INTEGERS: [(&str, u32); 52] = [
    ("RUN_COLORS", RUN_COLORS as u32),
    ("PATCH_LAYERS", PATCH_LAYERS as u32),
    ("OVERFLOW", OVERFLOW as u32),
    ("MAX_COLORS", MAX_COLORS as u32),
    ("STRETCH", STRETCH),
    ("BENDING", BENDING),
    ("INTERIOR_SPRINGS", INTERIOR_SPRINGS),
    ("CELLS", CELLS),
    ("CELL_FORCES", CELL_FORCES),
    ("CELL_ENTRIES", CELL_ENTRIES as u32),
    ("CELL_STATE", CELL_STATE as u32),
    ("EMBEDDING_ENTRIES", EMBEDDING_ENTRIES as u32),
    ("PIN_START_ENTRIES", PIN_START_ENTRIES as u32),
    ("NEAR_ENTRIES", NEAR_ENTRIES as u32),
    ("NO_COPY", incise_lattice::NO_COPY),
    ("PIN_SWEEPS", points::PIN_SWEEPS as u32),
    ("MAX_ROTATION_ITERATIONS", rotation::MAX_ITERATIONS as u32),
    ("SUMS_FORCES", SUMS_FORCES),
    ("CONTACTS", CONTACTS),
    ("CONTACT_FEATURES", CONTACT_FEATURES),
    ("CONTACT_RECOVERIES", CONTACT_RECOVERIES),
    ("CONTACT_VERTEX_POINT", ContactKind::VertexPoint as u32),
    ("CONTACT_EDGE_EDGE", ContactKind::EdgeEdge as u32),
    ("CONTACT_PLANE", ContactKind::Plane as u32),
    ("CARRIED_FIRST", SupportedSide::First as u32),
    ("CARRIED_SECOND", SupportedSide::Second as u32),
    ("CONTACT_ENTRIES", CONTACT_ENTRIES as u32),
    ("NO_VERTEX", NO_VERTEX),
    ("COLLIDER_ENTRIES", COLLIDER_ENTRIES as u32),
    ("PLANE", PLANE),
    ("ROUND", ROUND),
    ("STRETCH_ENTRIES", STRETCH_ENTRIES as u32),
    ("BENDING_ENTRIES", BENDING_ENTRIES as u32),
    ("PIN_ENTRIES", PIN_ENTRIES as u32),
    ("ATTACHMENT_ENTRIES", ATTACHMENT_ENTRIES as u32),
    ("IS_PRESSED", IS_PRESSED),
    ("IS_GUARDED", IS_GUARDED),
    ("CONSERVES", CONSERVES),
    ("IS_DRIVEN", IS_DRIVEN),
    ("HAS_CONTACTS", HAS_CONTACTS),
    ("IS_UNLIMITED", IS_UNLIMITED),
    ("MEASURES_ELASTIC_ENERGY", MEASURES_ELASTIC_ENERGY),
    ("GUARD_ENTRIES", GUARD_ENTRIES as u32),
    ("KEEPS_STRETCH", KEEPS_STRETCH),
    ("KEEPS_BENDING", KEEPS_BENDING),
    ("PIECE_ENTRIES", PIECE_ENTRIES as u32),
    ("CHUNK_ENTRIES", CHUNK_ENTRIES as u32),
    ("KEEPS_VOLUME", KEEPS_VOLUME),
    ("KEEPS_INTERIOR_SPRINGS", KEEPS_INTERIOR_SPRINGS),
    ("CHUNK", CHUNK as u32),
    ("ORDERED_INFINITY", ordered(f32::INFINITY)),
    ("ORDERED_NEGATIVE_INFINITY", ordered(f32::NEG_INFINITY)),
];

/// Constants of kernels.
pub(super) const FLOATS: [(&str, f32); 44] = [
    ("PI", PI),
    ("TAU", TAU),
    ("HALF_PI", FRAC_PI_2),
    ("RETURN", attachments::RETURN),
    ("FLAT", bending::FLAT),
    ("MAX_TURN", bending::MAX_TURN),
    ("RECOVERY", bending::RECOVERY),
    ("HOLD", bending::HOLD),
    ("FOLLOW", bending::FOLLOW),
    ("FREE", bending::FREE),
    ("LIMP", bending::LIMP),
    ("FIRM", bending::FIRM),
    ("SPRING_DIAGONAL_SCALE", interior_springs::DIAGONAL_SCALE),
    ("TOUCH", colliders::TOUCH),
    ("INACTIVE", contact_features::INACTIVE),
    ("MIN_SQUARED_SINE", contact_features::MIN_SQUARED_SINE),
    ("MAX_SHARE", contacts::MAX_SHARE),
    ("CONTACT_RECOVERY", contacts::RECOVERY),
    ("MAX_MISSING", contacts::MAX_MISSING),
    ("MIN_SLIDE", contacts::MIN_SLIDE),
    ("LIFT", contacts::LIFT),
    ("SIXTH", volume::SIXTH),
    ("THIRD", volume::THIRD),
    ("AREA", steps::AREA),
    ("CRUSHED", steps::CRUSHED),
    ("STEP", motion::STEP),
    ("PRESS", steps::PRESS),
    ("EASE", steps::EASE),
    ("MIN_INERTIA", rigid_motion::MIN_INERTIA),
    ("MIN_ENERGY", elastic::MIN_ENERGY),
    ("PIN_WEIGHT", rigid_motion::PIN_WEIGHT),
    ("UNITS", elastic::UNITS),
    ("UNLIMITED", guard::UNLIMITED),
    ("RESOLVED", cells::RESOLVED),
    ("CONVERGED_TURN", rotation::CONVERGED),
    ("LAST_TURN", rotation::LAST_TURN),
    ("MAX_CELL_TURN", rotation::MAX_TURN),
    ("FLAT_CELL", rotation::FLAT),
    ("MIN_FIRST_MINOR", rotation::MIN_MINORS[0]),
    ("MIN_SECOND_MINOR", rotation::MIN_MINORS[1]),
    ("MIN_THIRD_MINOR", rotation::MIN_MINORS[2]),
    ("RECOVERY_SPEED", points::RECOVERY_SPEED),
    ("PIN_TOLERANCE", points::PIN_TOLERANCE),
    ("MARGIN", body::MARGIN),
];

/// Returns the declarations of all constants, and of `more`.
pub(super) fn text(more: &[(&str, u32)]) -> String {
    let mut text = String::new();
    for (name, value) in INTEGERS.iter().chain(more) {
        let _ = writeln!(text, "const {name}: u32 = {value}u;");
    }
    for (name, value) in FLOATS {
        let _ = writeln!(text, "const {name}: f32 = {value:e}f;");
    }
    let coefficients = COEFFICIENTS.map(|value| format!("{value:e}f")).join(", ");
    let _ = writeln!(text, "const COEFFICIENTS = array({coefficients});");
    text
}
