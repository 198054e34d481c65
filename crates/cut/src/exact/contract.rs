//! A vertex beside the rim, or anywhere in a surface, contracted along an edge onto another one: what
//! snapping and remeshing share.

use super::chart::Chart;
use super::node::{Node, On};
use super::open::Lips;
use super::rim::Rim;
use incise_mesh::geometry::area_vector;
use incise_mesh::{Edit, HalfEdge, Topology, Vec3};

/// How far a stored coordinate may be off, and with it the height of a triangle [of the coordinate].
const ROUNDING: f64 = 8.0 * f32::EPSILON as f64;

/// The cut at hand.
pub(super) struct Opened<'a, 'e> {
    pub(super) edit: &'a mut Edit<'e>,
    pub(super) nodes: &'a [Node],
    pub(super) lips: &'a mut Lips,
    pub(super) rim: &'a mut Rim,
}

impl Opened<'_, '_> {
    /// Contracts the edge of `to_vertex` onto the vertex that it leaves: that of `node` on its lip, or one
    /// off the rim. All half-edges of the vertex that goes are in `fan`.
    pub(super) fn pull_in(
        &mut self,
        node: Option<(u32, usize)>,
        to_vertex: HalfEdge,
        fan: &[HalfEdge],
    ) {
        let topology = self.edit.surface().topology();
        let from_vertex = topology.twin(to_vertex);
        let (left, right) = (to_vertex.triangle(), from_vertex.triangle());
        let charts = [
            Chart::of(self.edit.surface(), to_vertex.next(), to_vertex),
            Chart::of(self.edit.surface(), from_vertex, from_vertex.next()),
        ];
        // Each triangle of the edge folds up; the edges on its two other sides become one.
        let inward = topology.twin(to_vertex.next());
        let outward = topology.twin(from_vertex.prev());
        let arriving = topology.twin(to_vertex.prev());
        let leaving = topology.twin(from_vertex.next());
        let target = topology.origin(to_vertex);
        for &h in fan {
            if h.triangle() != left && h.triangle() != right {
                self.edit.set_corner(h, target);
                for chart in &charts {
                    chart.follow(self.edit, h);
                }
            }
        }
        self.edit.remove_triangle(left);
        self.edit.remove_triangle(right);
        for (kept, across, arrives) in [(inward, arriving, true), (outward, leaving, false)] {
            if !across.is_null() {
                self.edit.join(kept, across);
            } else if let Some((node, lip)) = node {
                // On lip 0 the rim's half-edges run to their nodes, on lip 1 from them.
                let own = arrives == (lip == 0);
                let at = if own {
                    node
                } else {
                    self.rim.prev[node as usize]
                };
                self.lips.rim[at as usize][lip] = kept;
            }
        }
    }

    /// Whether a node is where the crease pierces the surface: there the rim has a corner.
    pub(super) fn is_on_crease(&self, node: u32) -> bool {
        matches!(self.nodes[node as usize].on, On::Face { .. })
    }

    /// Whether the rim's edge that begins at `node` may be contracted as far as the loop and the triangles
    /// along it tell: a loop keeps three edges, and two triangles that are all of a lip stay.
    pub(super) fn may_lose_edge(&self, node: u32) -> bool {
        let next = self.rim.next[node as usize];
        let (before, after) = (self.rim.prev[node as usize], self.rim.next[next as usize]);
        let ring = [before, node, next, after];
        let size = self.rim.sizes[self.rim.loop_of[node as usize] as usize];
        let topology = self.edit.surface().topology();
        let is_alone = |lip: usize| {
            let along = self.lips.rim[node as usize][lip];
            [along.next(), along.prev()].map(|h| topology.twin(h)) == [HalfEdge::NULL; 2]
        };
        let may = |lip| !is_alone(lip) && (size > 4 || !self.is_a_pair(ring, lip));
        size >= 4 && (0..2).all(may)
    }

    /// Whether all that is left of a lip with these four nodes is two triangles: one less and its cap is
    /// the same triangle again.
    fn is_a_pair(&self, ring: [u32; 4], lip: usize) -> bool {
        let [a, b, c, d] = ring.map(|n| self.lips.rim[n as usize][lip].triangle());
        (a == b && c == d) || (b == c && d == a)
    }

    /// Contracts the rim's edge that begins at `node` on both lips, so that of its two nodes only `kept` is
    /// there. `fan` is memory.
    pub(super) fn merge_nodes(&mut self, node: u32, kept: u32, fan: &mut Vec<HalfEdge>) {
        let next = self.rim.next[node as usize];
        let gone = if kept == node { next } else { node };
        for lip in 0..2 {
            self.fold_rim(node, kept, gone, lip, fan);
        }
        if gone == next {
            self.lips.rim[node as usize] = self.lips.rim[next as usize];
        }
        self.rim.take_out(gone);
    }

    /// Contracts the rim's edge that begins at `node` on one lip.
    fn fold_rim(&mut self, node: u32, kept: u32, gone: u32, lip: usize, fan: &mut Vec<HalfEdge>) {
        let next = self.rim.next[node as usize];
        let topology = self.edit.surface().topology();
        let along = self.lips.rim[node as usize][lip];
        let ahead = topology.twin(along.next());
        let behind = topology.twin(along.prev());
        let target = self.lips.vertices[kept as usize][lip];
        fan.clear();
        fan.extend(self.rim.fan(topology, self.lips, gone, lip));
        // The corners of the triangle that goes: of the node that goes, and of the one that is kept.
        let origin_goes = (gone == next) == (lip == 0);
        let chart = if origin_goes {
            Chart::of(self.edit.surface(), along, along.next())
        } else {
            Chart::of(self.edit.surface(), along.next(), along)
        };
        for &h in &*fan {
            if h.triangle() != along.triangle() {
                self.edit.set_corner(h, target);
                chart.follow(self.edit, h);
            }
        }
        self.edit.remove_triangle(along.triangle());
        // On lip 0 the rim runs against the order of nodes.
        let prev = self.rim.prev[node as usize];
        let (before, after) = if lip == 0 { (next, prev) } else { (prev, next) };
        if ahead.is_null() {
            self.lips.rim[after as usize][lip] = behind;
        } else if behind.is_null() {
            self.lips.rim[before as usize][lip] = ahead;
        } else {
            self.edit.join(ahead, behind);
        }
    }
}

/// Collects the half-edges that leave the origin of `start`, counterclockwise; false where the surface is
/// open there.
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

/// Whether a triangle is flat to rounding, so that it has no side to turn to: nodes stand on a vertex
/// where the sweep passes exactly through it. Its doubled area as a vector too.
pub(super) fn flatness([a, b, c]: [Vec3; 3]) -> (Vec3, bool) {
    let doubled = area_vector([a, b, c]);
    let size = (b - a).norm().max((c - a).norm());
    let reach = a.amax().max(b.amax()).max(c.amax());
    (doubled, doubled.norm() <= ROUNDING * reach * size)
}

/// The signed volume between triangle `from`, `b`, `c` and the one that has `to` in the place of `from`.
pub(super) fn swept_volume([from, b, c]: [Vec3; 3], to: Vec3) -> f64 {
    (to - from).dot(&(b - from).cross(&(c - from))) / 6.0
}
