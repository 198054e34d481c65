//! Edge contraction beside the rim, shared by snapping and remeshing.

use super::open::Sides;
use super::rim::{NO_NODE, Rim};
use crate::intersection::node::{Node, On};
use incise_mesh::geometry::area_vector;
use incise_mesh::{CornerValues, Edit, HalfEdge, Surface, Topology, Vec3, VertexId};

/// Rounding error of a stored coordinate [of the coordinate].
const ROUNDING: f64 = 8.0 * f32::EPSILON as f64;

/// A cut in progress: the opened surface with its rim.
pub(super) struct Opened<'a, 'e> {
    pub(super) edit: &'a mut Edit<'e>,
    pub(super) nodes: &'a [Node],
    pub(super) sides: &'a mut Sides,
    pub(super) rim: &'a mut Rim,
}

impl Opened<'_, '_> {
    /// Contracts the edge of `to_vertex` onto its origin, the vertex of `node` or one off the rim.
    ///
    /// `fan` has all half-edges of the removed vertex.
    pub(super) fn contract(
        &mut self,
        node: Option<(u32, usize)>,
        to_vertex: HalfEdge,
        fan: &[HalfEdge],
    ) {
        let topology = self.edit.surface().topology();
        let from_vertex = topology.twin(to_vertex);
        let (left, right) = (to_vertex.triangle(), from_vertex.triangle());
        let charts = [
            Chart::new(self.edit.surface(), to_vertex.next(), to_vertex),
            Chart::new(self.edit.surface(), from_vertex, from_vertex.next()),
        ];
        // Each triangle of the edge collapses; its two other edges become one.
        let inward = topology.twin(to_vertex.next());
        let outward = topology.twin(from_vertex.prev());
        let arriving = topology.twin(to_vertex.prev());
        let leaving = topology.twin(from_vertex.next());
        let target = topology.origin(to_vertex);
        for &h in fan {
            if h.triangle() != left && h.triangle() != right {
                self.edit.set_corner(h, target);
                for chart in &charts {
                    chart.update(self.edit, h);
                }
            }
        }
        self.edit.remove_triangle(left);
        self.edit.remove_triangle(right);
        for (kept, across, arrives) in [(inward, arriving, true), (outward, leaving, false)] {
            if !across.is_null() {
                self.edit.set_twins(kept, across);
            } else if let Some((node, side)) = node {
                // On side 0 the rim's half-edges run to their nodes, on side 1 from them.
                let own = arrives == (side == 0);
                let at = if own {
                    node
                } else {
                    self.rim.prev[node as usize]
                };
                self.sides.rim[at as usize][side] = kept;
            }
        }
    }

    /// Returns whether a node lies on a sweep edge, where the rim has a corner or ends.
    pub(super) fn is_on_sweep_edge(&self, node: u32) -> bool {
        !matches!(self.nodes[node as usize].on, On::Edge { .. })
    }

    /// Returns whether a curve ends inside the surface at a node or at one beside it.
    ///
    /// The next step of an incision goes on from there, so such nodes stay as they are.
    pub(super) fn is_near_end(&self, node: u32) -> bool {
        let [prev, next] = [&self.rim.prev, &self.rim.next].map(|list| list[node as usize]);
        [prev, node, next]
            .into_iter()
            .any(|node| node != NO_NODE && self.rim.is_end(node) && !self.is_at_border(node))
    }

    /// Returns whether a curve begins or ends at a node on the boundary of the sheet.
    pub(super) fn is_at_border(&self, node: u32) -> bool {
        self.rim.is_end(node) && !self.nodes[node as usize].is_end && !self.is_on_sweep_edge(node)
    }

    /// Returns whether the curve stays valid without the rim edge that begins at `node`.
    ///
    /// A loop keeps three edges, a curve across a sheet one, and a side keeps two triangles.
    /// Nothing changes near ends inside the surface.
    pub(super) fn may_lose_edge(&self, node: u32) -> bool {
        let Some(&next) = self.rim.next.get(node as usize) else {
            return false;
        };
        if next == NO_NODE || self.is_near_end(node) || self.is_near_end(next) {
            return false;
        }
        let is_closed = self.rim.is_closed(node);
        let size = self.rim.sizes[self.rim.curve_of[node as usize] as usize];
        let topology = self.edit.surface().topology();
        let is_alone = |side: usize| {
            let along = self.sides.rim[node as usize][side];
            [along.next(), along.prev()].map(|h| topology.twin(h)) == [HalfEdge::NULL; 2]
        };
        let is_a_pair = |side: usize| {
            let (before, after) = (self.rim.prev[node as usize], self.rim.next[next as usize]);
            size <= 4 && is_closed && self.is_a_pair([before, node, next, after], side)
        };
        let may = |side| !is_alone(side) && !is_a_pair(side);
        size >= if is_closed { 4 } else { 3 } && (0..2).all(may)
    }

    /// Returns whether two triangles are all of a side with these four nodes.
    ///
    /// Without one of them, the cap would repeat the other.
    fn is_a_pair(&self, ring: [u32; 4], side: usize) -> bool {
        let [a, b, c, d] = ring.map(|n| self.sides.rim[n as usize][side].triangle());
        (a == b && c == d) || (b == c && d == a)
    }

    /// Contracts the rim edge that begins at `node` on both sides and keeps the node `kept`.
    ///
    /// `fan` is scratch memory.
    pub(super) fn merge_nodes(&mut self, node: u32, kept: u32, fan: &mut Vec<HalfEdge>) {
        let next = self.rim.next[node as usize];
        let gone = if kept == node { next } else { node };
        for side in 0..2 {
            self.contract_rim_edge(node, kept, gone, side, fan);
        }
        if gone == next {
            self.sides.rim[node as usize] = self.sides.rim[next as usize];
        }
        self.rim.remove(gone);
    }

    /// Contracts the rim edge that begins at `node` on one side.
    fn contract_rim_edge(
        &mut self,
        node: u32,
        kept: u32,
        gone: u32,
        side: usize,
        fan: &mut Vec<HalfEdge>,
    ) {
        let next = self.rim.next[node as usize];
        let topology = self.edit.surface().topology();
        let along = self.sides.rim[node as usize][side];
        let target = self.sides.vertices[kept as usize][side];
        fan.clear();
        fan.extend(self.rim.fan(topology, self.sides, gone, side));
        let origin_goes = (gone == next) == (side == 0);
        let [ahead, behind] = self.contract_boundary_edge(along, origin_goes, target, fan);
        // On side 0 the rim runs against the order of nodes.
        let prev = self.rim.prev[node as usize];
        let (before, after) = if side == 0 {
            (next, prev)
        } else {
            (prev, next)
        };
        if ahead.is_null() {
            self.set_rim(after, side, behind);
        } else if behind.is_null() {
            self.set_rim(before, side, ahead);
        }
    }

    /// Sets the half-edge along the rim edge that begins at `node`, if there is one.
    fn set_rim(&mut self, node: u32, side: usize, h: HalfEdge) {
        if node != NO_NODE && self.rim.next[node as usize] != NO_NODE {
            self.sides.rim[node as usize][side] = h;
        }
    }

    /// Contracts the edge of a sheet's boundary from `node`, an end of a curve, onto the node.
    ///
    /// `along` is the half-edge of that edge. `fan` has all half-edges of the removed vertex.
    pub(super) fn contract_border(
        &mut self,
        node: u32,
        side: usize,
        along: HalfEdge,
        fan: &[HalfEdge],
    ) {
        let target = self.sides.vertices[node as usize][side];
        let origin_goes = self.edit.surface().topology().origin(along) != target;
        let [ahead, behind] = self.contract_boundary_edge(along, origin_goes, target, fan);
        // The triangle's other edge at the node may be that of the rim.
        let [own, other] = if origin_goes {
            [ahead, behind]
        } else {
            [behind, ahead]
        };
        if own.is_null() {
            let prev = self.rim.prev[node as usize];
            self.set_rim(if prev == NO_NODE { node } else { prev }, side, other);
        }
    }

    /// Contracts the edge of the boundary half-edge `along` onto `target`, one of its ends.
    ///
    /// `fan` has all half-edges of the other end. Returns the half-edges across the next and the
    /// previous edge of the removed triangle.
    fn contract_boundary_edge(
        &mut self,
        along: HalfEdge,
        origin_goes: bool,
        target: VertexId,
        fan: &[HalfEdge],
    ) -> [HalfEdge; 2] {
        let topology = self.edit.surface().topology();
        let across = [along.next(), along.prev()].map(|h| topology.twin(h));
        // The corners of the removed triangle at the removed and at the kept vertex.
        let chart = if origin_goes {
            Chart::new(self.edit.surface(), along, along.next())
        } else {
            Chart::new(self.edit.surface(), along.next(), along)
        };
        for &h in fan {
            if h.triangle() != along.triangle() {
                self.edit.set_corner(h, target);
                chart.update(self.edit, h);
            }
        }
        self.edit.remove_triangle(along.triangle());
        let [ahead, behind] = across;
        if !ahead.is_null() && !behind.is_null() {
            self.edit.set_twins(ahead, behind);
        }
        across
    }
}

/// Collects the half-edges that leave the origin of `start`, counterclockwise.
///
/// Returns false at a boundary.
pub(super) fn closed_fan(topology: &Topology, start: HalfEdge, fan: &mut Vec<HalfEdge>) -> bool {
    fan.clear();
    let mut at = start;
    loop {
        if at.is_null() {
            return false;
        }
        fan.push(at);
        at = topology.twin(at.prev());
        if at == start {
            return true;
        }
    }
}

/// Returns a triangle's area vector, doubled, and whether the area is zero up to rounding.
///
/// Such a triangle has no orientation. It occurs where the sweep passes exactly through a vertex.
pub(super) fn flatness([a, b, c]: [Vec3; 3]) -> (Vec3, bool) {
    let doubled = area_vector([a, b, c]);
    let size = (b - a).norm().max((c - a).norm());
    let reach = a.amax().max(b.amax()).max(c.amax());
    (doubled, doubled.norm() <= ROUNDING * reach * size)
}

/// Returns the signed volume between triangle `from`, `b`, `c` and triangle `to`, `b`, `c`.
pub(super) fn swept_volume([from, b, c]: [Vec3; 3], to: Vec3) -> f64 {
    (to - from).dot(&(b - from).cross(&(c - from))) / 6.0
}

/// Attribute values of a vertex in one chart, before and after it moves.
///
/// Corners with the old value get the new one. Other charts keep theirs.
struct Chart {
    from: CornerValues,
    to: CornerValues,
}

impl Chart {
    /// Corner `from` has the old values, corner `to` those at the new position.
    fn new(surface: &Surface, from: HalfEdge, to: HalfEdge) -> Self {
        let [from, to] = [from, to].map(|h| surface.corner_values(h));
        Self { from, to }
    }

    /// Updates a corner of the vertex if it belongs to this chart.
    fn update(&self, edit: &mut Edit<'_>, h: HalfEdge) {
        edit.replace_corner_values(h, &self.from, &self.to);
    }
}
