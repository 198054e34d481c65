//! Constraints for edges that have none yet. Those of edges that came are made a block at a time: rest
//! values of all edges of a block are found before any of its constraints is inserted, so that neither
//! waits for the other.

use crate::constraints::ConstraintSet;
use crate::edges::{EdgeId, EdgeTable, Fresh, Lists, Place, Sets};
use crate::patches::Patches;
use crate::rest;
use incise_mesh::{Surface, VertexId};

/// Edges of a block: few enough for the fastest memory.
const BLOCK: usize = 64;

impl EdgeTable {
    /// Adds the constraints that listed edges should have and have not, in the order of the lists.
    pub(crate) fn add_missing(&mut self, lists: &Lists, surface: &Surface, sets: &mut Sets<'_>) {
        for &edge in &lists.touched {
            self.add_missing_of(edge, surface, sets);
        }
        let bends = sets.bending.is_some();
        let mut rest = [(0.0, 0.0); BLOCK];
        for block in lists.fresh.chunks(BLOCK) {
            for (rest, fresh) in rest.iter_mut().zip(block) {
                *rest = rest_values(fresh, surface, bends);
            }
            for (&Fresh { edge, vertices }, (length, angle)) in block.iter().zip(rest) {
                let [a, b, ..] = vertices;
                let stretch = insert(sets.stretch, &mut sets.patches, [a, b], length, edge);
                let bending = match &mut sets.bending {
                    Some(set) if is_hinge(vertices) => {
                        insert(set, &mut sets.patches, vertices, angle, edge)
                    }
                    _ => Place::NOWHERE,
                };
                self.set_places(edge, Some(stretch), Some(bending));
            }
        }
    }

    /// Adds the constraints that an edge should have and has not.
    fn add_missing_of(&mut self, edge: EdgeId, surface: &Surface, sets: &mut Sets<'_>) {
        let record = *self.record(edge);
        let (mut stretch, mut bending) = (None, None);
        if record.stretch().is_none()
            && let Some((ends, length)) = record.stretch_wanted(surface)
        {
            stretch = Some(insert(sets.stretch, &mut sets.patches, ends, length, edge));
        }
        if let Some(set) = &mut sets.bending
            && record.bending().is_none()
            && let Some((vertices, angle)) = record.bending_wanted(surface)
        {
            bending = Some(insert(set, &mut sets.patches, vertices, angle, edge));
        }
        self.set_places(edge, stretch, bending);
    }
}

/// Whether there is a triangle on both sides.
#[inline]
fn is_hinge([_, _, up, down]: [VertexId; 4]) -> bool {
    !(up.is_null() || down.is_null())
}

/// The rest length and, if asked for and between two triangles, the rest angle.
#[inline]
fn rest_values(fresh: &Fresh, surface: &Surface, bends: bool) -> (f32, f32) {
    let [low, high, ..] = fresh.vertices;
    if bends && is_hinge(fresh.vertices) {
        rest::length_and_angle(surface, fresh.vertices)
    } else {
        (rest::length(surface, [low, high]), 0.0)
    }
}

/// Inserts a constraint of an edge into the layer of its vertices.
#[inline]
fn insert<const N: usize>(
    set: &mut ConstraintSet<N>,
    patches: &mut Option<&mut Patches>,
    vertices: [VertexId; N],
    rest: f32,
    edge: EdgeId,
) -> Place {
    let Some(patches) = patches else {
        return Place::at(set.insert_in(0, vertices, rest, edge));
    };
    let slot = set.insert_in(patches.layer_of(&vertices), vertices, rest, edge);
    patches.touch(slot.layer(), &vertices);
    Place::at(slot)
}
