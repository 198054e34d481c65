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
        let mut stretch = [Place::NOWHERE; BLOCK];
        let mut bending = [Place::NOWHERE; BLOCK];
        for block in lists.fresh.chunks(BLOCK) {
            for (rest, fresh) in rest.iter_mut().zip(block) {
                *rest = rest_values(fresh, surface, bends);
            }
            for ((place, fresh), (length, _)) in stretch.iter_mut().zip(block).zip(rest) {
                let [a, b, ..] = fresh.vertices;
                *place = insert(sets.stretch, &mut sets.patches, [a, b], length, fresh.edge);
            }
            if let Some(set) = &mut sets.bending {
                for ((place, fresh), (_, angle)) in bending.iter_mut().zip(block).zip(rest) {
                    *place = if is_hinge(fresh) {
                        insert(set, &mut sets.patches, fresh.vertices, angle, fresh.edge)
                    } else {
                        Place::NOWHERE
                    };
                }
            }
            for ((fresh, &stretch), &bending) in block.iter().zip(&stretch).zip(&bending) {
                self.set_places(fresh.edge, Some(stretch), Some(bending));
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
fn is_hinge(fresh: &Fresh) -> bool {
    let [_, _, up, down] = fresh.vertices;
    !(up.is_null() || down.is_null())
}

/// The rest length and, if asked for and between two triangles, the rest angle.
#[inline]
fn rest_values(fresh: &Fresh, surface: &Surface, bends: bool) -> (f32, f32) {
    let [low, high, ..] = fresh.vertices;
    if bends && is_hinge(fresh) {
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
