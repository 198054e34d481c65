//! Checks a surface where a cut has changed it.
//!
//! Walls of incisions coincide and share vertices at tips and ends, so a later cut across them may
//! need the same edge twice. This shows only after all parts are joined.

use incise_mesh::{HalfEdge, Surface, TopologyDelta, VertexId};

/// Returns whether a surface has walls of incisions. O(n).
///
/// Two walls are mirror images at rest. So at their tip, two triangles with a common edge have the
/// same third position.
pub(crate) fn has_walls(surface: &Surface) -> bool {
    let topology = surface.topology();
    topology.edges().any(|h| {
        let twin = topology.twin(h);
        let across = |h: HalfEdge| surface.rest_position(topology.origin(h.prev()));
        !twin.is_null() && across(h) == across(twin)
    })
}

/// Returns a vertex around which a changed surface is not a manifold, if there is one.
///
/// Every half-edge must run against its twin. The new triangles of a vertex must be in one closed
/// fan, or if `may_be_open` in open fans, with different neighbors. A fan of two triangles belongs
/// to a part of two, back to back. O(k log k) for k triangles.
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
    let mut reached: Vec<HalfEdge> = Vec::new();
    let is_defect = |own: &&[(VertexId, HalfEdge)]| {
        neighbors.clear();
        reached.clear();
        let mut fans = 0;
        let mut is_open = true;
        for &(_, h) in *own {
            if reached.contains(&h) {
                continue;
            }
            fans += 1;
            let first = topology.first_in_fan(h);
            is_open &= topology.twin(first).is_null();
            let mut at = first;
            loop {
                reached.push(at);
                neighbors.push(topology.target(at));
                let next = topology.twin(at.prev());
                if next.is_null() {
                    neighbors.push(topology.origin(at.prev()));
                }
                if next.is_null() || next == first {
                    break;
                }
                at = next;
            }
        }
        let count = neighbors.len();
        neighbors.sort_unstable();
        neighbors.dedup();
        let is_simple = is_open || fans == 1;
        !is_simple || neighbors.len() != count
    };
    corners
        .chunk_by(|a, b| a.0 == b.0)
        .find(is_defect)
        .map(|own| own[0].0)
}
