//! Remeshing around the rim: slivers that the blade made in the old surface go, where the surface need
//! not move by more than a tolerance for that.
//!
//! Two operations, on triangles with a corner on the rim or beside a vertex of it:
//!
//! - an edge between two triangles is flipped;
//! - a vertex off the rim is contracted onto a neighbor, where the link condition holds (Dey et al. 1999).
//!
//! Each makes the smallest angle of the triangles that it changes larger. None turns a triangle over or by
//! more than 30 degrees, crosses an edge with such an angle between its triangles, another material, or a
//! seam of texture or normals, or touches a rim vertex. How far the surface moves is bounded from
//! above, exactly ([`shape::Quad::flip_distance`], [`star::Star::distance_onto`]): one-to-one, so that no point of the
//! old surface is farther from the new one and none of the new one farther from the old. New triangles keep
//! what the farthest of those has moved that they replace, so that distances add up and stay below
//! the tolerance however many operations follow each other. The body at rest and the texture are held to the
//! same bound.

mod few;
mod flip;
mod ring;
mod shape;
mod star;
#[cfg(test)]
mod tests;

use super::contract::Opened;
use incise_mesh::{HalfEdge, Topology, TriangleId, VertexId};
use ring::{Ring, Room, neighbors};
use shape::{Point, Quad, are_alike, quality};
use star::Star;

/// The smallest angle below which a triangle's edges are flipped, 30 degrees, as [`quality`] has it.
const FLIPPED: f64 = 0.25;

/// The smallest angle below which its corners are contracted, 20 degrees.
const CONTRACTED: f64 = 0.116_977_778_440_511;

/// How much better the worst triangle must get, as [`quality`] has it. That a finite number of operations is
/// enough needs any number above 1.
const GAIN: f64 = 1.1;

/// What remeshing did.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Remeshed {
    /// Edges flipped.
    pub(super) flips: usize,
    /// Vertices off the rim contracted.
    pub(super) vertices: usize,
    /// Nodes merged with others.
    pub(super) nodes: usize,
    /// Volume that was moved to do so, without sign \[m^3\].
    pub(super) volume: f64,
    /// No point of the surface moved farther \[m\].
    pub(super) distance: f64,
}

/// Memory of a remeshing.
#[derive(Debug, Clone, Default)]
pub(crate) struct Remesher {
    ring: Ring,
    /// Whether nodes may be merged with others.
    may_merge: bool,
    /// Triangles that are to be looked at, those in it by their places in the ring.
    queue: Vec<TriangleId>,
    is_queued: Vec<bool>,
    /// By corner of the triangle at hand, what is around it; at a node, on both lips.
    stars: [[Star; 2]; 3],
    fan: Vec<HalfEdge>,
    candidates: Vec<(f64, Candidate)>,
    near: Vec<VertexId>,
}

/// What can be done about a triangle.
#[derive(Debug, Clone, Copy)]
enum Candidate {
    /// The half-edge's edge is flipped.
    Flip(HalfEdge),
    /// The vertex of a star is contracted onto its neighbor with this number.
    Contract { star: usize, onto: usize },
    /// The node of two stars is merged with the next one along the rim or with the one before.
    Merge {
        star: usize,
        node: u32,
        onto_next: bool,
    },
}

impl Remesher {
    /// Remeshes around the rim of both lips, moving the surface by at most `tolerance` of the local edge length or,
    /// where that is less, of the section's `width` \[m\]. Without `may_merge` the rim stays as it is.
    pub(super) fn remesh(
        &mut self,
        cut: &mut Opened<'_, '_>,
        tolerance: f64,
        width: f64,
        may_merge: bool,
    ) -> Remeshed {
        self.may_merge = may_merge;
        let mut done = Remeshed::default();
        if tolerance <= 0.0 {
            return done;
        }
        self.ring.find(cut, tolerance, width);
        self.is_queued.clear();
        self.is_queued.resize(self.ring.len(), true);
        self.queue.clear();
        self.queue.extend(self.ring.near());
        self.is_queued[self.queue.len()..].fill(false);
        let mut at = 0;
        while let Some(&t) = self.queue.get(at) {
            at += 1;
            if let Some(place) = self.ring.place(t) {
                self.is_queued[place] = false;
            }
            self.improve(cut, t, &mut done);
        }
        done
    }

    fn enqueue(&mut self, t: TriangleId) {
        if let Some(place) = self.ring.place(t)
            && !std::mem::replace(&mut self.is_queued[place], true)
        {
            self.queue.push(t);
        }
    }

    /// Does the best of what can be done about a triangle, if it is a sliver.
    fn improve(&mut self, cut: &mut Opened<'_, '_>, t: TriangleId, done: &mut Remeshed) {
        let surface = cut.edit.surface();
        if !surface.topology().is_triangle(t) {
            return;
        }
        let own = quality(surface.triangle_positions(t));
        if own >= FLIPPED {
            return;
        }
        self.candidates.clear();
        for h in t.half_edges() {
            self.offer_flip(cut, h);
        }
        if own < CONTRACTED {
            for (i, h) in t.half_edges().into_iter().enumerate() {
                match self.ring.node_of(surface.topology().origin(h)) {
                    Some((node, _)) if self.may_merge => self.offer_merges(cut, i, node),
                    Some(_) => {}
                    None => self.offer_contractions(cut, i, h),
                }
            }
        }
        // Stable: of equals the first.
        (self.candidates).sort_by(|a, b| b.0.total_cmp(&a.0));
        for i in 0..self.candidates.len() {
            let is_done = match self.candidates[i].1 {
                Candidate::Flip(h) => self.flip(cut, h, done),
                Candidate::Contract { star, onto } => self.contract(cut, star, onto, done),
                Candidate::Merge {
                    star,
                    node,
                    onto_next,
                } => self.merge(cut, star, node, onto_next, done),
            };
            if is_done {
                break;
            }
        }
    }

    /// The corners of the triangles at the edge of `h`, which is between the first and the third.
    fn quad(cut: &Opened<'_, '_>, h: HalfEdge) -> Option<Quad> {
        let surface = cut.edit.surface();
        let twin = surface.topology().twin(h);
        let corners = || [h, twin.prev(), twin, h.prev()];
        (!twin.is_null()).then(|| Quad(corners().map(|h| Point::of(surface, h))))
    }

    fn offer_flip(&mut self, cut: &Opened<'_, '_>, h: HalfEdge) {
        let Some(quad) = Self::quad(cut, h) else {
            return;
        };
        let [old, new] = quad.qualities(0);
        if new > GAIN * old {
            self.candidates.push((new, Candidate::Flip(h)));
        }
    }

    fn offer_contractions(&mut self, cut: &Opened<'_, '_>, star: usize, h: HalfEdge) {
        let around = &mut self.stars[star][0];
        if !around.find(cut.edit.surface(), &self.ring, h) {
            return;
        }
        let old = around.quality(0);
        for onto in 0..around.vertices.len() {
            let new = around.quality_onto(onto, 0);
            if new > GAIN * old {
                let candidate = Candidate::Contract { star, onto };
                self.candidates.push((new, candidate));
            }
        }
    }

    fn offer_merges(&mut self, cut: &Opened<'_, '_>, star: usize, node: u32) {
        let around = &mut self.stars[star];
        let mut lips = (0..2).zip(&mut *around);
        if cut.is_on_crease(node)
            || !lips.all(|(lip, around)| around.find_at_node(cut, &self.ring, (node, lip)))
        {
            return;
        }
        let old = around[0].quality(0).min(around[1].quality(0));
        for onto_next in [true, false] {
            let on_lip = |lip: usize| {
                let around = &around[lip];
                around.quality_onto(around.along_rim(lip, onto_next), 0)
            };
            let new = on_lip(0).min(on_lip(1));
            if new > GAIN * old {
                let candidate = Candidate::Merge {
                    star,
                    node,
                    onto_next,
                };
                self.candidates.push((new, candidate));
            }
        }
    }

    /// Flips the edge of `h` if that may be.
    fn flip(&mut self, cut: &mut Opened<'_, '_>, h: HalfEdge, done: &mut Remeshed) -> bool {
        let surface = cut.edit.surface();
        let topology = surface.topology();
        let twin = topology.twin(h);
        let (first, second) = (h.triangle(), twin.triangle());
        let [Some(room), Some(other)] = [first, second].map(|t| self.ring.room(t)) else {
            return false;
        };
        let kind = |t: TriangleId| (surface.material(t), surface.piece(t));
        let across = [twin.prev(), h.prev()].map(|h| topology.origin(h));
        // The cap may need an edge between two vertices of the rim.
        let is_on_rim = |v: VertexId| self.ring.node_of(v).is_some();
        if kind(first) != kind(second)
            || !are_alike(surface, h, twin.next())
            || !are_alike(surface, h.next(), twin)
            || across.into_iter().all(is_on_rim)
        {
            return false;
        }
        if self.would_repeat(topology, h) {
            return false;
        }
        let Some(quad) = Self::quad(cut, h) else {
            return false;
        };
        let [old, new] = quad.qualities(1);
        if new < old && !quad.0.iter().all(Point::is_at_rest) {
            return false;
        }
        let room = quad.flip_distance().and_then(|d| room.with(other).after(d));
        let Some(room) = room else {
            return false;
        };
        if !cut.turn(&self.ring, h) {
            return false;
        }
        done.flips += 1;
        done.volume += quad.volume();
        done.distance = done.distance.max(room.moved);
        for t in [first, second] {
            self.ring.set_room(t, room);
            self.enqueue(t);
        }
        true
    }

    /// Whether the two corners across from the edge of `h` are joined already.
    fn would_repeat(&mut self, topology: &Topology, h: HalfEdge) -> bool {
        self.near.clear();
        neighbors(topology, topology.twin(h).prev(), &mut self.near);
        self.near.contains(&topology.origin(h.prev()))
    }

    /// Whether the vertex of a star and its neighbor that `from_neighbor` leaves have just the two neighbors
    /// in common with which they make triangles.
    fn is_linked_twice(
        &mut self,
        topology: &Topology,
        from_neighbor: HalfEdge,
        star: usize,
    ) -> bool {
        self.near.clear();
        neighbors(topology, from_neighbor, &mut self.near);
        let around = self.stars[star][0].vertices.iter();
        around.filter(|v| self.near.contains(v)).count() == 2
    }

    /// Contracts the vertex of a star onto a neighbor if that may be.
    fn contract(
        &mut self,
        cut: &mut Opened<'_, '_>,
        number: usize,
        onto: usize,
        done: &mut Remeshed,
    ) -> bool {
        let surface = cut.edit.surface();
        let topology = surface.topology();
        let star = &mut self.stars[number][0];
        let node = self.ring.node_of(star.vertices[onto]);
        // The last vertex off the rim stays: without it a tip would be flat.
        if star.joins_rim(onto) || star.is_on_rim.iter().all(|&is_on_rim| is_on_rim) {
            return false;
        }
        let from_vertex = star.fan[onto];
        let pin = |h: HalfEdge| surface.positions[topology.origin(h).index()][3] == 0.0;
        if pin(from_vertex) && !pin(from_vertex.next()) {
            return false;
        }
        let linked = self.is_linked_twice(topology, from_vertex.next(), number);
        let star = &mut self.stars[number][0];
        if !linked {
            return false;
        }
        if !star.is_at_rest() && star.quality_onto(onto, 1) < star.quality(1) {
            return false;
        }
        let distance = star.distance_onto(onto);
        let room = star.room.zip(distance).and_then(|(room, d)| room.after(d));
        let Some(room) = room else {
            return false;
        };
        done.vertices += 1;
        done.volume += star.volume_onto(onto);
        done.distance = done.distance.max(room.moved);
        let to_vertex = topology.twin(from_vertex);
        cut.pull_in(node, to_vertex, &star.fan);
        let fan = std::mem::take(&mut star.fan);
        self.follow(cut, &fan, room);
        self.stars[number][0].fan = fan;
        true
    }

    /// Merges a node with one beside it if that may be.
    fn merge(
        &mut self,
        cut: &mut Opened<'_, '_>,
        number: usize,
        node: u32,
        onto_next: bool,
        done: &mut Remeshed,
    ) -> bool {
        let (next, prev) = (cut.rim.next[node as usize], cut.rim.prev[node as usize]);
        let (kept, edge) = if onto_next {
            (next, node)
        } else {
            (prev, prev)
        };
        if !cut.may_lose_edge(edge) {
            return false;
        }
        let surface = cut.edit.surface();
        let (mut room, mut volume) = (None::<Room>, 0.0);
        for (lip, star) in self.stars[number].iter_mut().enumerate() {
            let onto = star.along_rim(lip, onto_next);
            let pin = |v: VertexId| surface.positions[v.index()][3] == 0.0;
            let is_pinned = pin(cut.lips.vertices[node as usize][lip]);
            self.near.clear();
            let topology = surface.topology();
            (cut.rim).neighbors(topology, cut.lips, kept, lip, &mut self.near);
            let common = star.vertices.iter().filter(|v| self.near.contains(v));
            if common.count() != 1
                || star.joins_rim(onto)
                || (is_pinned && !pin(star.vertices[onto]))
                || (!star.is_at_rest() && star.quality_onto(onto, 1) < star.quality(1))
            {
                return false;
            }
            let distance = star.distance_onto(onto);
            let own = star.room.zip(distance).and_then(|(room, d)| room.after(d));
            let Some(own) = own else {
                return false;
            };
            room = Some(room.map_or(own, |room| room.with(own)));
            volume += star.volume_onto(onto);
        }
        let Some(room) = room else {
            return false;
        };
        done.nodes += 1;
        done.volume += volume;
        done.distance = done.distance.max(room.moved);
        cut.merge_nodes(edge, kept, &mut self.fan);
        for lip in 0..2 {
            let fan = std::mem::take(&mut self.stars[number][lip].fan);
            self.follow(cut, &fan, room);
            self.stars[number][lip].fan = fan;
        }
        true
    }

    /// Notes what the triangles of a fan have moved, and looks at those again that are there.
    fn follow(&mut self, cut: &Opened<'_, '_>, fan: &[HalfEdge], room: Room) {
        let topology = cut.edit.surface().topology();
        for t in fan.iter().map(|h| h.triangle()) {
            if topology.is_triangle(t) {
                self.ring.set_room(t, room);
                self.enqueue(t);
            }
        }
    }
}
