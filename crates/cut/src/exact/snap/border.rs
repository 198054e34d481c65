//! Snapping of vertices on the boundary of a sheet to the ends of curves.

use super::super::contract::Opened;
use super::{Snapped, Snapper};
use crate::intersection::facets::Facets;
use incise_mesh::geometry::area_vector;
use incise_mesh::{HalfEdge, VertexId};

impl Snapper {
    /// Moves the vertex of a sheet's boundary close to an end of a curve onto its node.
    ///
    /// The area that the boundary sweeps counts as one edge thick.
    pub(super) fn take_border_vertex(
        &mut self,
        cut: &mut Opened<'_, '_>,
        facets: &Facets,
        node: u32,
        side: usize,
        vertex: VertexId,
        done: &mut Snapped,
    ) {
        // A tip is the node of a curve that goes on from it.
        let mut parts = facets.tip().parts.iter();
        if parts.any(|part| part.vertices.contains(&vertex)) {
            return;
        }
        let surface = cut.edit.surface();
        let topology = surface.topology();
        let target = cut.sides.vertices[node as usize][side];
        self.far.clear();
        (cut.rim).neighbors(topology, cut.sides, node, side, &mut self.far);
        // The boundary's half-edge is the first or the last side of the node's fan.
        let mut fan = cut.rim.fan(topology, cut.sides, node, side);
        let is_along = |h: HalfEdge| {
            let ends = [topology.origin(h), topology.target(h)];
            topology.twin(h).is_null() && ends.contains(&vertex) && ends.contains(&target)
        };
        let along = fan.find_map(|h| [h, h.prev()].into_iter().find(|&h| is_along(h)));
        drop(fan);
        let Some(along) = along else {
            return;
        };
        let of_vertex = if topology.origin(along) == vertex {
            along
        } else {
            along.next()
        };
        self.fan.clear();
        self.near.clear();
        let mut at = topology.first_in_fan(of_vertex);
        while !at.is_null() {
            self.fan.push(at);
            self.near.push(topology.target(at));
            let back = at.prev();
            at = topology.twin(back);
            if at.is_null() {
                self.near.push(topology.origin(back));
            }
        }
        let is_alone = [along.next(), along.prev()].map(|h| topology.twin(h));
        if self.common_neighbors() != 1 || is_alone == [HalfEdge::NULL; 2] {
            return;
        }
        let ends = [self.near[0], self.near[self.near.len() - 1]];
        let other = if ends[0] == target { ends[1] } else { ends[0] };
        let corners = [other, vertex, target].map(|v| surface.position(v));
        let area = area_vector(corners).norm() / 2.0;
        let limit = self.limit(cut, node);
        let moved = self.moved_volume(surface, facets, [vertex, target], limit);
        let volume = moved.map(|moved| moved + area * cut.nodes[node as usize].local);
        let Some(volume) = volume.filter(|&volume| volume <= limit) else {
            return;
        };
        cut.contract_border(node, side, along, &self.fan);
        done.vertices += 1;
        self.count_volume(cut, node, volume, done);
    }
}
