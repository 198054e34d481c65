//! Checks a surface where a cut has changed it.
//!
//! The walls of incisions coincide, and share vertices at tips and ends. A later cut across them
//! may need an edge twice. Nothing local tells so before all parts are joined.

use incise_mesh::{HalfEdge, Surface, TopologyDelta, VertexId};

/// Returns a vertex around which a changed surface is not a manifold, if there is one.
///
/// Every half-edge must run against its twin, and every vertex of a new triangle must have one fan
/// with different neighbors; unless `may_be_open` the fan is closed. O(k log k) for k triangles.
pub(super) fn find_defect(
    surface: &Surface,
    delta: &TopologyDelta,
    may_be_open: bool,
) -> Option<VertexId> {
    let topology = surface.topology();
    let mut corners = Vec::with_capacity(3 * delta.triangles_added.len());
    for h in delta.triangles_added.iter().flat_map(|t| t.half_edges()) {
        let (from, to) = (topology.origin(h), topology.target(h));
        let twin = topology.twin(h);
        let is_paired = if twin.is_null() {
            may_be_open
        } else {
            topology.twin(twin) == h && topology.origin(twin) == to && topology.target(twin) == from
        };
        if !is_paired {
            return Some(from);
        }
        corners.push((from, h));
    }
    corners.sort_unstable();
    let mut neighbors: Vec<VertexId> = Vec::new();
    let is_defect = |own: &&[(VertexId, HalfEdge)]| {
        let vertex = own[0].0;
        neighbors.clear();
        let mut new = 0;
        let mut is_open = false;
        for h in topology.outgoing_fan(vertex) {
            neighbors.push(topology.target(h));
            new += usize::from(own.binary_search(&(vertex, h)).is_ok());
            if topology.twin(h.prev()).is_null() {
                neighbors.push(topology.origin(h.prev()));
                is_open = true;
            }
        }
        let count = neighbors.len();
        neighbors.sort_unstable();
        neighbors.dedup();
        new != own.len() || neighbors.len() != count || count < 3 - usize::from(is_open)
    };
    corners
        .chunk_by(|a, b| a.0 == b.0)
        .find(is_defect)
        .map(|own| own[0].0)
}
