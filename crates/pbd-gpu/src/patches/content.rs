//! What is in a patch.

use crate::constraints::Slot;
use crate::solver::Solver;
use incise_mesh::{HalfEdge, Surface, VertexId};

impl Solver {
    /// Where the constraints of a patch of `layer` stand, ascending and so in the order of their colors.
    /// Nothing in layer 0, which has no patches. O(k log k) for k edges around the patch's vertices.
    #[cfg_attr(
        not(test),
        allow(dead_code, reason = "asked for by backends that go by patch")
    )]
    pub(crate) fn constraints_of_patch(
        &self,
        surface: &Surface,
        layer: usize,
        patch: u32,
        stretch: &mut Vec<Slot>,
        bending: &mut Vec<Slot>,
    ) {
        stretch.clear();
        bending.clear();
        let Some(patching) = self.patches.as_ref().and_then(|p| p.of_layer(layer)) else {
            return;
        };
        let in_layer = |slot: &Slot| slot.layer() == layer;
        for &v in patching.vertices(patch) {
            // Every constraint is found at the smaller end of its edge.
            for (h, _) in around(surface, v).filter(|&(_, w)| v < w) {
                if let Some(edge) = self.edges.of(h) {
                    let record = self.edges.record(edge);
                    stretch.extend(record.stretch().filter(in_layer));
                    bending.extend(record.bending().filter(in_layer));
                }
            }
        }
        stretch.sort_unstable();
        bending.sort_unstable();
    }
}

/// The edges around `v`, each once, with the vertex at the other end.
fn around(surface: &Surface, v: VertexId) -> impl Iterator<Item = (HalfEdge, VertexId)> {
    let topology = surface.topology();
    topology.outgoing_fan(v).flat_map(move |h| {
        let before = h.prev();
        let on_rim = topology.twin(before).is_null();
        let last = on_rim.then(|| (before, topology.origin(before)));
        [(h, topology.target(h))].into_iter().chain(last)
    })
}
