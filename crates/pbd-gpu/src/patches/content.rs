//! Lists the constraints of a patch for the GPU.

use crate::constraints::Constraints;
use crate::constraints::batches::Slot;
use incise_mesh::{HalfEdge, Surface, VertexId};

impl Constraints {
    /// Lists the slots of the constraints of a patch of `layer`, ascending, that is by color.
    ///
    /// There are none in layer 0, which has no patches. O(k log k) for k edges at the vertices of
    /// the patch.
    pub(crate) fn of_patch(
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
            // Every edge is visited from its smaller end.
            for (h, _) in edges_at(surface, v).filter(|&(_, w)| v < w) {
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

/// Returns the edges at `v`, each once, with their other ends.
fn edges_at(surface: &Surface, v: VertexId) -> impl Iterator<Item = (HalfEdge, VertexId)> {
    let topology = surface.topology();
    topology.outgoing_fan(v).flat_map(move |h| {
        let before = h.prev();
        let is_boundary = topology.twin(before).is_null();
        let last = is_boundary.then(|| (before, topology.origin(before)));
        [(h, topology.target(h))].into_iter().chain(last)
    })
}
