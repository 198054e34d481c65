//! Flips an edge beside the rim.

use super::super::contract::Opened;
use super::ring::{Ring, neighbors};
use super::shape::{Point, Quad};
use super::{Candidate, MIN_GAIN, Remeshed, Remesher};
use incise_mesh::{HalfEdge, Topology, TriangleId, VertexId};

impl Remesher {
    /// Proposes a flip of the edge of `h`.
    pub(super) fn propose_flip(&mut self, cut: &Opened<'_, '_>, h: HalfEdge) {
        let Some(quad) = quad(cut, h) else {
            return;
        };
        let [old, new] = quad.qualities(0);
        if new > MIN_GAIN * old {
            self.candidates.push((new, Candidate::Flip(h)));
        }
    }

    /// Flips the edge of `h` if that is valid.
    pub(super) fn flip(
        &mut self,
        cut: &mut Opened<'_, '_>,
        h: HalfEdge,
        done: &mut Remeshed,
    ) -> bool {
        let surface = cut.edit.surface();
        let topology = surface.topology();
        let twin = topology.twin(h);
        let (first, second) = (h.triangle(), twin.triangle());
        let [Some(budget), Some(other)] = [first, second].map(|t| self.ring.budget(t)) else {
            return false;
        };
        let kind = |t: TriangleId| (surface.material(t), surface.piece(t));
        let across = [twin.prev(), h.prev()].map(|h| topology.origin(h));
        // The cap may need an edge between two vertices of the rim.
        let is_on_rim = |v: VertexId| self.ring.node_of(v).is_some();
        if kind(first) != kind(second)
            || !surface.has_equal_corners(h, twin.next())
            || !surface.has_equal_corners(h.next(), twin)
            || across.into_iter().all(is_on_rim)
        {
            return false;
        }
        if self.would_repeat(topology, h) {
            return false;
        }
        let Some(quad) = quad(cut, h) else {
            return false;
        };
        let [old, new] = quad.qualities(1);
        if new < old && !quad.0.iter().all(Point::is_at_rest) {
            return false;
        }
        let budget = quad
            .flip_distance()
            .and_then(|d| budget.with(other).after(d));
        let Some(budget) = budget else {
            return false;
        };
        if !cut.flip_beside_rim(&self.ring, h) {
            return false;
        }
        done.flips += 1;
        done.volume += quad.volume();
        done.distance = done.distance.max(budget.moved);
        for t in [first, second] {
            self.ring.set_budget(t, budget);
            self.enqueue(t);
        }
        true
    }

    /// Returns whether the two corners across from the edge of `h` are joined already.
    pub(super) fn would_repeat(&mut self, topology: &Topology, h: HalfEdge) -> bool {
        self.near.clear();
        neighbors(topology, topology.twin(h).prev(), &mut self.near);
        self.near.contains(&topology.origin(h.prev()))
    }
}

/// Returns the corners of the two triangles at the edge of `h`; the edge joins the first and the
/// third.
fn quad(cut: &Opened<'_, '_>, h: HalfEdge) -> Option<Quad> {
    let surface = cut.edit.surface();
    let twin = surface.topology().twin(h);
    let corners = || [h, twin.prev(), twin, h.prev()];
    (!twin.is_null()).then(|| Quad(corners().map(|h| Point::new(surface, h))))
}

impl Opened<'_, '_> {
    /// Flips the edge of `h` and updates the rim. Both triangles keep their slots.
    ///
    /// Returns false, and changes nothing, if a boundary off the rim would change its half-edge.
    fn flip_beside_rim(&mut self, ring: &Ring, h: HalfEdge) -> bool {
        let topology = self.edit.surface().topology();
        let g = topology.twin(h);
        // From corner a to c, with d and b across: the sides d-a and b-c change their triangles,
        // or, where both of these are boundaries, a-b and c-d could.
        let sides = [(h, g.prev()), (g, h.prev())];
        let beyond = sides.map(|(_, outer)| topology.twin(outer));
        let mut rims = [None; 2];
        for (rim, (&(new, outer), beyond)) in rims.iter_mut().zip(sides.iter().zip(beyond)) {
            if beyond.is_null() {
                let [from, to] = [topology.origin(outer), topology.target(outer)];
                let (Some(from), Some(to)) = (ring.node_of(from), ring.node_of(to)) else {
                    return false;
                };
                let (node, side) = if from.1 == 0 { to } else { from };
                if self.sides.rim[node as usize][side] != outer {
                    return false;
                }
                *rim = Some((node, side, new));
            }
        }
        if rims.iter().all(Option::is_some) {
            return false;
        }
        if self.edit.flip_edge(h).is_err() {
            return false;
        }
        for (node, side, new) in rims.into_iter().flatten() {
            self.sides.rim[node as usize][side] = new;
        }
        true
    }
}
