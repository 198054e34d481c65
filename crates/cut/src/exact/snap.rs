//! Snapping: contracts edges on and to the rim that are much shorter than the local edge length.
//!
//! Two kinds of contraction, each only where the link condition holds (Dey et al. 1999), so that
//! the surface stays the manifold that it is and no piece appears or disappears:
//!
//! - a node takes a mesh vertex that is close to it into the rim: the vertex moves along its mesh
//!   edge onto the sweep;
//! - two nodes that are close to each other merge, on both sides.
//!
//! Neither inverts a triangle or moves more volume than [`MAX_MOVED_VOLUME`]; all of them together
//! move no more than [`MAX_TOTAL_VOLUME`]. A curve that ends at the boundary of a sheet keeps its
//! ends, which take vertices of the boundary. So a corner of a coarse body stays in place and
//! leaves a short rim edge, which the report counts.
//!
//! Where a sweep ends inside the body, the next step goes on. So neither changes a triangle at the
//! end of such a curve or moves one across the sweep's boundary.

mod border;

use super::contract::{Opened, closed_fan, flatness, swept_volume};
use super::rim::NO_NODE;
use super::volumes::SmallerPart;
use crate::intersection::facets::Facets;
use crate::intersection::node::{Node, On};
use crate::intersection::trace::Curve;
use crate::sizing::{self, RestShape};
use incise_mesh::geometry::area_vector;
use incise_mesh::{HalfEdge, Surface, Topology, Vec3, VertexId, index_u32};

/// Maximum volume that one contraction moves [cubes of the local edge length].
const MAX_MOVED_VOLUME: f64 = 5e-3;

/// Maximum volume that all contractions at a curve move [volume of the smaller part].
///
/// The part is known only after the cut; [`SmallerPart::volume`] is a lower bound.
const MAX_TOTAL_VOLUME: f64 = 1e-3;

/// Counters of snapping.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Snapped {
    /// Mesh vertices taken into the rim.
    pub(super) vertices: usize,
    /// Nodes merged into others.
    pub(super) nodes: usize,
    /// Moved volume, without sign \[m^3\].
    pub(super) volume: f64,
}

/// Scratch memory of snapping.
#[derive(Debug, Clone, Default)]
pub(crate) struct Snapper {
    /// By curve, volume that may still be moved \[m^3\].
    volumes_left: Vec<f64>,
    boundary: Boundary,
    /// By node, whether another one is on the coincident wall of an incision.
    is_shared: Vec<bool>,
    crosses_walls: bool,
    near: Vec<VertexId>,
    far: Vec<VertexId>,
    fan: Vec<HalfEdge>,
}

/// The boundary of a sweep that ends inside the body. Empty for others.
#[derive(Debug, Clone, Default)]
struct Boundary {
    /// The vertices at which curves end, ascending.
    ends: Vec<VertexId>,
    /// The sweep's edges from end to end.
    edges: Vec<u32>,
}

impl Boundary {
    fn read(&mut self, cut: &Opened<'_, '_>, facets: &Facets) {
        let ends = (cut.nodes.iter().zip(&cut.sides.vertices)).filter(|(node, _)| node.is_end);
        self.ends.clear();
        self.ends.extend(ends.map(|(_, vertices)| vertices[0]));
        self.ends.sort_unstable();
        self.edges.clear();
        if !self.ends.is_empty() {
            let is_boundary =
                |&e: &u32| !facets.edges()[e as usize].is_crease() && facets.may_have_chain(e);
            let edges = 0..index_u32(facets.edges().len());
            self.edges.extend(edges.filter(is_boundary));
        }
    }

    fn has_end(&self, vertex: VertexId) -> bool {
        self.ends.binary_search(&vertex).is_ok()
    }

    fn pierces(&self, facets: &Facets, corners: [Vec3; 3]) -> bool {
        self.edges.iter().any(|&e| facets.pierces(e, corners))
    }
}

impl Snapper {
    /// Finds the nodes that have a partner on a coincident wall: on an edge or a triangle of equal
    /// rest positions. O(k log k).
    ///
    /// They stay in place, so that both walls remain mirror images.
    pub(super) fn find_shared(&mut self, surface: &Surface, shape: RestShape, nodes: &[Node]) {
        self.is_shared.clear();
        self.is_shared.resize(nodes.len(), false);
        self.crosses_walls = false;
        let bits = |v: VertexId| shape.bits(surface, v);
        let mut places: Vec<([[u32; 3]; 3], [VertexId; 3], usize)> = Vec::new();
        for (i, node) in nodes.iter().enumerate() {
            let corners = match node.on {
                On::Edge { ends: [a, b], .. } => [a, b, b],
                On::Face { corners, .. } => corners,
                On::Tip(vertex) => {
                    self.is_shared[i] = true;
                    [vertex; 3]
                }
            };
            places.push((corners.map(bits), corners, i));
        }
        places.sort_unstable();
        for own in places.chunk_by(|a, b| a.0 == b.0) {
            let is_shared = own.iter().any(|place| place.1 != own[0].1);
            self.crosses_walls |= is_shared;
            for &(.., i) in own {
                self.is_shared[i] |= is_shared;
            }
        }
    }

    /// Returns whether snapping may move a node of a curve: one without a partner.
    pub(super) fn may_snap(&self, curve: &Curve) -> bool {
        let mut nodes = curve.nodes.clone();
        nodes.any(|node| !self.is_shared[node as usize])
    }

    /// Returns whether nodes are on coincident walls.
    pub(super) fn crosses_walls(&self) -> bool {
        self.crosses_walls
    }

    /// Contracts edges shorter than `snap` times the local edge length.
    ///
    /// `parts` has the smaller part of each curve.
    pub(super) fn snap(
        &mut self,
        cut: &mut Opened<'_, '_>,
        facets: &Facets,
        snap: f64,
        parts: &[SmallerPart],
    ) -> Snapped {
        let mut done = Snapped::default();
        if snap <= 0.0 {
            return done;
        }
        self.volumes_left.clear();
        (self.volumes_left).extend(parts.iter().map(|part| MAX_TOTAL_VOLUME * part.volume));
        self.boundary.read(cut, facets);
        let count = index_u32(cut.nodes.len());
        for node in 0..count {
            self.take_vertex(cut, facets, node, snap, &mut done);
        }
        // A merge makes the edges beside it longer, which may still be short.
        loop {
            let before = done.nodes;
            for node in 0..count {
                while !cut.rim.is_removed[node as usize]
                    && Self::is_short(cut, node, snap)
                    && self.merge(cut, facets, node, &mut done)
                {}
            }
            if done.nodes == before {
                break;
            }
        }
        done
    }

    /// Returns the number of rim edges shorter than `snap` times the local edge length.
    pub(super) fn short_edges(cut: &Opened<'_, '_>, snap: f64) -> usize {
        let rings = (0..cut.rim.sizes.len()).flat_map(|i| cut.rim.ring(i));
        rings.filter(|&n| Self::is_short(cut, n, snap)).count()
    }

    /// Returns the maximum volume that a contraction at `node` may move now.
    fn limit(&self, cut: &Opened<'_, '_>, node: u32) -> f64 {
        let local = cut.nodes[node as usize].local;
        let left = self.volumes_left[cut.rim.curve_of[node as usize] as usize];
        left.min(MAX_MOVED_VOLUME * local.powi(3))
    }

    fn is_short(cut: &Opened<'_, '_>, node: u32, snap: f64) -> bool {
        let next = cut.rim.next[node as usize];
        if next == NO_NODE {
            return false;
        }
        let [a, b] = [node, next].map(|n| &cut.nodes[n as usize]);
        (b.position - a.position).norm() < snap * a.local.min(b.local)
    }

    /// Moves the mesh vertex close to a node onto the node, if there is one.
    fn take_vertex(
        &mut self,
        cut: &mut Opened<'_, '_>,
        facets: &Facets,
        node: u32,
        snap: f64,
        done: &mut Snapped,
    ) {
        let On::Edge { ends, t, rises, .. } = cut.nodes[node as usize].on else {
            return;
        };
        if cut.is_near_end(node) || self.is_shared[node as usize] {
            return;
        }
        let t = f64::from(t);
        let (vertex, side) = if t < snap {
            (ends[0], usize::from(!rises))
        } else if 1.0 - t < snap {
            (ends[1], usize::from(rises))
        } else {
            return;
        };
        if sizing::is_made(cut.edit.surface(), vertex) {
            return;
        }
        if cut.is_at_border(node) {
            self.take_border_vertex(cut, facets, node, side, vertex, done);
            return;
        }
        let topology = cut.edit.surface().topology();
        let mut fan = cut.rim.fan(topology, cut.sides, node, side);
        let Some(to_vertex) = fan.find(|&h| topology.target(h) == vertex) else {
            return;
        };
        drop(fan);
        // All around the vertex; nothing of it may be open.
        let start = topology.twin(to_vertex);
        if !closed_fan(topology, start, &mut self.fan) {
            return;
        }
        // The last vertex off the rim stays: without it a tip would be flat, as sheets are anyway.
        let is_at_boundary = |&h: &HalfEdge| is_at_boundary(topology, topology.twin(h));
        if cut.rim.is_capped(node) && self.fan.iter().all(is_at_boundary) {
            return;
        }
        self.near.clear();
        self.near
            .extend(self.fan.iter().map(|&h| topology.target(h)));
        self.far.clear();
        (cut.rim).neighbors(topology, cut.sides, node, side, &mut self.far);
        if self.common_neighbors() != 2 {
            return;
        }
        let target = cut.sides.vertices[node as usize][side];
        let (surface, limit) = (cut.edit.surface(), self.limit(cut, node));
        let Some(volume) = self.moved_volume(surface, facets, [vertex, target], limit) else {
            return;
        };
        cut.contract(Some((node, side)), to_vertex, &self.fan);
        done.vertices += 1;
        self.count_volume(cut, node, volume, done);
    }

    /// Adds a volume that a contraction at `node` moved to the counters.
    fn count_volume(&mut self, cut: &Opened<'_, '_>, node: u32, volume: f64, done: &mut Snapped) {
        done.volume += volume;
        let left = &mut self.volumes_left[cut.rim.curve_of[node as usize] as usize];
        *left = (*left - volume).max(0.0);
    }

    fn common_neighbors(&self) -> usize {
        self.near.iter().filter(|v| self.far.contains(v)).count()
    }

    /// Merges a node and the next one, on both sides.
    fn merge(
        &mut self,
        cut: &mut Opened<'_, '_>,
        facets: &Facets,
        node: u32,
        done: &mut Snapped,
    ) -> bool {
        let next = cut.rim.next[node as usize];
        if !cut.may_lose_edge(node) {
            return false;
        }
        let (before, after) = (cut.rim.prev[node as usize], cut.rim.next[next as usize]);
        let room = |node: u32, beyond: u32| match cut.nodes.get(beyond as usize) {
            Some(beyond) => (beyond.position - cut.nodes[node as usize].position).norm(),
            None => 0.0,
        };
        // The one with less room on its other side goes; what lies on the crease stays, and so does
        // an end of the curve.
        let next_goes = room(next, after) <= room(node, before);
        let orders = if next_goes {
            [true, false]
        } else {
            [false, true]
        };
        for next_goes in orders {
            let (kept, gone) = if next_goes {
                (node, next)
            } else {
                (next, node)
            };
            if cut.is_on_sweep_edge(gone) || cut.rim.is_end(gone) || self.is_shared[gone as usize] {
                continue;
            }
            let mut volume = 0.0;
            let may = [0, 1].into_iter().all(|side| {
                let moved = self.may_merge(cut, facets, node, [kept, gone], side);
                volume += moved.unwrap_or(0.0);
                moved.is_some()
            });
            if may {
                cut.merge_nodes(node, kept, &mut self.fan);
                done.nodes += 1;
                self.count_volume(cut, node, volume, done);
                return true;
            }
        }
        false
    }

    /// Returns the volume that a merge moves on one side; none if the merge is invalid.
    fn may_merge(
        &mut self,
        cut: &Opened<'_, '_>,
        facets: &Facets,
        node: u32,
        [kept, gone]: [u32; 2],
        side: usize,
    ) -> Option<f64> {
        let topology = cut.edit.surface().topology();
        self.near.clear();
        (cut.rim).neighbors(topology, cut.sides, kept, side, &mut self.near);
        self.far.clear();
        (cut.rim).neighbors(topology, cut.sides, gone, side, &mut self.far);
        if self.common_neighbors() != 1 {
            return None;
        }
        self.fan.clear();
        (self.fan).extend(cut.rim.fan(topology, cut.sides, gone, side));
        let ends = [gone, kept].map(|n| cut.sides.vertices[n as usize][side]);
        self.moved_volume(cut.edit.surface(), facets, ends, self.limit(cut, node))
    }

    /// Returns the volume between the triangles of the fan of `vertex` before and after its move to
    /// `target`.
    ///
    /// None if a triangle would be inverted or cross the sweep's boundary, if one is at the end of
    /// a curve, or if the volume exceeds `limit`.
    fn moved_volume(
        &self,
        surface: &Surface,
        facets: &Facets,
        [vertex, target]: [VertexId; 2],
        limit: f64,
    ) -> Option<f64> {
        let topology = surface.topology();
        let (from, to) = (surface.position(vertex), surface.position(target));
        let mut volume = 0.0;
        for &h in &self.fan {
            let (b, c) = (topology.target(h), topology.origin(h.prev()));
            if self.boundary.has_end(b) || self.boundary.has_end(c) {
                return None;
            }
            if b == target || c == target {
                continue;
            }
            let [b, c] = [b, c].map(|v: VertexId| surface.position(v));
            let (before, is_flat) = flatness([from, b, c]);
            if !is_flat && before.dot(&area_vector([to, b, c])) <= 0.0 {
                return None;
            }
            if self.boundary.pierces(facets, [to, b, c]) {
                return None;
            }
            volume += swept_volume([from, b, c], to);
        }
        (volume.abs() <= limit).then_some(volume.abs())
    }
}

/// Returns whether the vertex that `h` leaves is on a boundary.
fn is_at_boundary(topology: &Topology, h: HalfEdge) -> bool {
    let mut at = h;
    loop {
        at = topology.twin(at.prev());
        if at.is_null() || at == h {
            return at.is_null();
        }
    }
}
