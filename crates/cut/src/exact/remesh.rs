//! Removes slivers around the rim; moves the surface by no more than a tolerance.
//!
//! Operations on triangles with a corner on the rim or beside a vertex of it:
//!
//! - [`flip`]: an edge between two triangles is flipped;
//! - a vertex off the rim is contracted onto a neighbor, where the link condition holds (Dey et al.
//!   1999);
//! - [`merge`]: a node of the rim is merged with the one beside it.
//!
//! Each enlarges the smallest angle of the triangles that it changes. None turns a triangle by more
//! than 30 degrees or touches an edge that is a feature: a dihedral angle of more than 30 degrees,
//! a border between materials, or a seam of texture or normals.
//!
//! The displacement of the surface is bounded from above ([`shape::Quad::flip_distance`],
//! [`star::Star::distance_onto`]). The bound holds one-to-one, from old to new and from new to old.
//! A new triangle inherits the largest displacement of the replaced triangles, so the sum over all
//! operations stays below the tolerance. The same bound holds at rest and in the texture.

mod flip;
mod merge;
mod ring;
mod shape;
mod star;
#[cfg(test)]
mod tests;

use super::contract::Opened;
use incise_mesh::{HalfEdge, Topology, TriangleId, VertexId};
use ring::{DisplacementBudget, Ring, neighbors};
use shape::quality;
use star::Star;

/// Quality below which edges are flipped: a smallest angle of 30 degrees, see [`quality`].
const FLIP_QUALITY: f64 = 0.25;

/// Quality below which vertices are contracted: a smallest angle of 20 degrees.
const CONTRACT_QUALITY: f64 = 0.116_977_778_440_511;

/// Minimum ratio of the worst [`quality`] after and before an operation. Above 1, so that remeshing
/// ends.
const MIN_GAIN: f64 = 1.1;

/// Counters of a remeshing.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Remeshed {
    /// Edges flipped.
    pub(super) flips: usize,
    /// Vertices off the rim contracted.
    pub(super) vertices: usize,
    /// Nodes merged with others.
    pub(super) nodes: usize,
    /// Moved volume, without sign \[m^3\].
    pub(super) volume: f64,
    /// Maximum displacement of the surface \[m\].
    pub(super) distance: f64,
}

/// Scratch memory of a remeshing.
#[derive(Debug, Clone, Default)]
pub(crate) struct Remesher {
    ring: Ring,
    /// Whether nodes may be merged with others.
    may_merge: bool,
    /// Triangles to examine; by place in the ring, whether a triangle is queued.
    queue: Vec<TriangleId>,
    is_queued: Vec<bool>,
    /// By corner of the current triangle, its star; at a node, one per side.
    stars: [[Star; 2]; 3],
    fan: Vec<HalfEdge>,
    candidates: Vec<(f64, Candidate)>,
    near: Vec<VertexId>,
}

/// An operation that would improve a triangle.
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
    /// Remeshes around the rim of both sides.
    ///
    /// Moves the surface by at most `tolerance` of the local edge length or, where that is less, of
    /// its curve's entry of `widths` \[m\]. Without `may_merge` the rim stays as it is.
    pub(super) fn remesh(
        &mut self,
        cut: &mut Opened<'_, '_>,
        tolerance: f64,
        widths: &[f64],
        may_merge: bool,
    ) -> Remeshed {
        self.may_merge = may_merge;
        let mut done = Remeshed::default();
        if tolerance <= 0.0 {
            return done;
        }
        self.ring.find(cut, tolerance, widths);
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

    /// Applies the best valid operation to a triangle if it is a sliver.
    fn improve(&mut self, cut: &mut Opened<'_, '_>, t: TriangleId, done: &mut Remeshed) {
        let surface = cut.edit.surface();
        if !surface.topology().is_triangle(t) {
            return;
        }
        let own = quality(surface.triangle_positions(t));
        if own >= FLIP_QUALITY {
            return;
        }
        self.candidates.clear();
        for h in t.half_edges() {
            self.propose_flip(cut, h);
        }
        if own < CONTRACT_QUALITY {
            for (i, h) in t.half_edges().into_iter().enumerate() {
                match self.ring.node_of(surface.topology().origin(h)) {
                    Some((node, _)) if self.may_merge => self.propose_merges(cut, i, node),
                    Some(_) => {}
                    None => self.propose_contractions(cut, i, h),
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

    fn propose_contractions(&mut self, cut: &Opened<'_, '_>, star: usize, h: HalfEdge) {
        let around = &mut self.stars[star][0];
        if !around.find(cut.edit.surface(), &self.ring, h) {
            return;
        }
        let old = around.quality(0);
        for onto in 0..around.vertices.len() {
            let new = around.quality_onto(onto, 0);
            if new > MIN_GAIN * old {
                let candidate = Candidate::Contract { star, onto };
                self.candidates.push((new, candidate));
            }
        }
    }

    /// Returns whether the link condition holds for the vertex of a star and the origin of
    /// `from_neighbor`: they have exactly two common neighbors.
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

    /// Contracts the vertex of a star onto a neighbor if that is valid.
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
        if node.is_some_and(|(node, _)| cut.rim.is_near_end(node)) {
            return false;
        }
        if star.joins_rim(onto) || star.is_on_rim.iter().all(|&is_on_rim| is_on_rim) {
            return false;
        }
        let from_vertex = star.fan[onto];
        let pin = |h: HalfEdge| surface.positions()[topology.origin(h).index()][3] == 0.0;
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
        let budget = star
            .budget
            .zip(distance)
            .and_then(|(budget, d)| budget.after(d));
        let Some(budget) = budget else {
            return false;
        };
        done.vertices += 1;
        done.volume += star.volume_onto(onto);
        done.distance = done.distance.max(budget.moved);
        let to_vertex = topology.twin(from_vertex);
        cut.contract(node, to_vertex, &star.fan);
        let fan = std::mem::take(&mut star.fan);
        self.follow(cut, &fan, budget);
        self.stars[number][0].fan = fan;
        true
    }

    /// Records the displacement of a fan and queues its remaining triangles.
    fn follow(&mut self, cut: &Opened<'_, '_>, fan: &[HalfEdge], budget: DisplacementBudget) {
        let topology = cut.edit.surface().topology();
        for t in fan.iter().map(|h| h.triangle()) {
            if topology.is_triangle(t) {
                self.ring.set_budget(t, budget);
                self.enqueue(t);
            }
        }
    }
}
