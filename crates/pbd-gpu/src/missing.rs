//! Constraints for edges that have none yet, a block of edges at a time: rest values of a whole block are
//! found before any of its constraints is inserted, so that neither waits for the other.

use crate::constraints::ConstraintSet;
use crate::edges::{EdgeId, EdgeTable, Place, Sets};
use crate::patches::Patches;
use crate::rest;
use incise_mesh::{Surface, VertexId};

/// Edges of a block: few enough for the fastest memory.
const BLOCK: usize = 64;

/// What an edge should have and has not.
#[derive(Debug, Clone, Copy)]
struct Missing {
    edge: EdgeId,
    /// The ends, then the vertices across; those are null where nothing bends.
    vertices: [VertexId; 4],
    length: f32,
    angle: f32,
    stretches: bool,
    bends: bool,
}

impl Missing {
    const NOTHING: Self = Self {
        edge: EdgeId::NONE,
        vertices: [VertexId::NULL; 4],
        length: 0.0,
        angle: 0.0,
        stretches: false,
        bends: false,
    };
}

impl EdgeTable {
    /// Adds the constraints that edges should have and have not, in the order of the edges.
    pub(crate) fn add_missing(
        &mut self,
        edges: impl IntoIterator<Item = EdgeId>,
        surface: &Surface,
        sets: &mut Sets<'_>,
    ) {
        let mut edges = edges.into_iter();
        let mut block = [Missing::NOTHING; BLOCK];
        loop {
            let mut len = 0;
            for (entry, edge) in block.iter_mut().zip(edges.by_ref()) {
                *entry = self.missing(edge, surface, sets.bending.is_some());
                len += 1;
            }
            self.insert(&block[..len], sets);
            if len < BLOCK {
                return;
            }
        }
    }

    #[inline]
    fn missing(&mut self, edge: EdgeId, surface: &Surface, bends: bool) -> Missing {
        let record = self.leave_list(edge);
        let stretches = record.stretch().is_none();
        if bends
            && record.bending().is_none()
            && let Some(vertices) = record.hinge(surface.topology())
        {
            let (length, angle) = rest::length_and_angle(surface, vertices);
            return Missing {
                edge,
                vertices,
                length,
                angle,
                stretches,
                bends,
            };
        }
        let wanted = stretches.then(|| record.stretch_wanted(surface)).flatten();
        let Some(([a, b], length)) = wanted else {
            return Missing::NOTHING;
        };
        Missing {
            edge,
            vertices: [a, b, VertexId::NULL, VertexId::NULL],
            length,
            angle: 0.0,
            stretches,
            bends: false,
        }
    }

    fn insert(&mut self, block: &[Missing], sets: &mut Sets<'_>) {
        let patches = &mut sets.patches;
        for entry in block.iter().filter(|entry| entry.stretches) {
            let [a, b, ..] = entry.vertices;
            let place = insert(sets.stretch, patches, [a, b], entry.length, entry.edge);
            self.set_stretch(entry.edge, place);
        }
        let Some(bending) = &mut sets.bending else {
            return;
        };
        for entry in block.iter().filter(|entry| entry.bends) {
            let place = insert(bending, patches, entry.vertices, entry.angle, entry.edge);
            self.set_bending(entry.edge, place);
        }
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
    let layer = patches.as_ref().map_or(0, |p| p.layer_of(&vertices));
    let slot = set.insert_in(layer, vertices, rest, edge);
    if let Some(patches) = patches {
        patches.touch(slot.layer(), &vertices);
    }
    Place::at(slot)
}
