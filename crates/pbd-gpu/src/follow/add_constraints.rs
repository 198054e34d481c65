//! Adds the constraints of new edges, and missing ones of changed edges.
//!
//! New edges are processed in blocks. The rest values of a block are computed before its
//! constraints are inserted, so that arithmetic and memory accesses do not wait for each other.

use crate::constraints::batches::ConstraintSet;
use crate::constraints::edges::{EdgeId, EdgeLists, EdgeTable, NewEdge, PackedSlot, Sets};
use crate::constraints::rest;
use crate::patches::Patches;
use incise_mesh::{Surface, VertexId};

/// Edges per block; a block fits in the L1 cache.
const BLOCK: usize = 64;

impl EdgeTable {
    /// Adds the missing constraints of the listed edges, in the order of the lists.
    pub(crate) fn add_missing(
        &mut self,
        lists: &EdgeLists,
        surface: &Surface,
        sets: &mut Sets<'_>,
    ) {
        for &edge in &lists.changed {
            self.add_missing_of(edge, surface, sets);
        }
        let bends = sets.bending.is_some();
        let mut rest = [(0.0, 0.0); BLOCK];
        for block in lists.added.chunks(BLOCK) {
            for (rest, new) in rest.iter_mut().zip(block) {
                *rest = rest_values(new, surface, bends);
            }
            for (&NewEdge { edge, vertices }, (length, angle)) in block.iter().zip(rest) {
                let [a, b, ..] = vertices;
                let stretch = insert(sets.stretch, &mut sets.patches, [a, b], length, edge);
                let bending = match &mut sets.bending {
                    Some(set) if is_hinge(vertices) => {
                        insert(set, &mut sets.patches, vertices, angle, edge)
                    }
                    _ => PackedSlot::NONE,
                };
                self.set_slots(edge, Some(stretch), Some(bending));
            }
        }
    }

    /// Adds the missing constraints of one edge.
    fn add_missing_of(&mut self, edge: EdgeId, surface: &Surface, sets: &mut Sets<'_>) {
        let record = *self.record(edge);
        let (mut stretch, mut bending) = (None, None);
        if record.stretch().is_none()
            && let Some((ends, length)) = record.expected_stretch(surface)
        {
            stretch = Some(insert(sets.stretch, &mut sets.patches, ends, length, edge));
        }
        if let Some(set) = &mut sets.bending
            && record.bending().is_none()
            && let Some((vertices, angle)) = record.expected_bending(surface)
        {
            bending = Some(insert(set, &mut sets.patches, vertices, angle, edge));
        }
        self.set_slots(edge, stretch, bending);
    }
}

/// Returns true if there is a triangle on both sides.
#[inline]
fn is_hinge([_, _, up, down]: [VertexId; 4]) -> bool {
    !(up.is_null() || down.is_null())
}

/// Returns the rest length, and with bending the rest angle between two triangles.
#[inline]
fn rest_values(new: &NewEdge, surface: &Surface, bends: bool) -> (f32, f32) {
    let [low, high, ..] = new.vertices;
    if bends && is_hinge(new.vertices) {
        rest::length_and_angle(surface, new.vertices)
    } else {
        (rest::length(surface, [low, high]), 0.0)
    }
}

/// Inserts a constraint of an edge into the layer of its vertices and returns its slot.
#[inline]
fn insert<const N: usize>(
    set: &mut ConstraintSet<N>,
    patches: &mut Option<&mut Patches>,
    vertices: [VertexId; N],
    rest: f32,
    edge: EdgeId,
) -> PackedSlot {
    let Some(patches) = patches else {
        return PackedSlot::new(set.insert_in(0, vertices, rest, edge));
    };
    let slot = set.insert_in(patches.layer_of(&vertices), vertices, rest, edge);
    patches.mark_changed(slot.layer(), &vertices);
    PackedSlot::new(slot)
}
