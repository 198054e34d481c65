//! The triangles around the rim that may change, each with its displacement budget.

use super::super::contract::Opened;
use super::super::sparse_set::SparseSet;
use incise_mesh::{HalfEdge, Topology, TriangleId, VertexId};

/// Allowed and past displacement of the surface at a triangle \[m\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct DisplacementBudget {
    pub(super) limit: f64,
    pub(super) moved: f64,
}

impl DisplacementBudget {
    /// Returns the budget of two triangles together: the smaller limit, the larger displacement.
    pub(super) fn with(self, other: Self) -> Self {
        Self {
            limit: self.limit.min(other.limit),
            moved: self.moved.max(other.moved),
        }
    }

    /// Returns the budget after another displacement by `distance`; none beyond the limit.
    pub(super) fn after(self, distance: f64) -> Option<Self> {
        let moved = self.moved + distance;
        (moved <= self.limit).then_some(Self { moved, ..self })
    }
}

/// A triangle of the ring.
#[derive(Debug, Clone, Copy)]
struct Member {
    triangle: TriangleId,
    budget: DisplacementBudget,
}

/// Triangles with a corner on the rim or beside a vertex of it.
#[derive(Debug, Clone, Default)]
pub(super) struct Ring {
    found: SparseSet,
    members: Vec<Member>,
    /// Number of members with a corner on the rim; they come first.
    near_count: usize,
    rim: SparseSet,
    /// The node and the side of each rim vertex.
    places: Vec<(u32, usize)>,
}

impl Ring {
    /// Finds the ring of both sides.
    ///
    /// The limit of a triangle is `tolerance` times the local edge length at its nodes, or times
    /// the entry of `widths` for their curve \[m\] if that is less.
    pub(super) fn find(&mut self, cut: &Opened<'_, '_>, tolerance: f64, widths: &[f64]) {
        let topology = cut.edit.surface().topology();
        self.found.clear(topology.triangle_slots());
        self.rim.clear(topology.vertex_slots());
        self.members.clear();
        self.places.clear();
        for (i, &width) in widths.iter().enumerate() {
            for node in cut.rim.ring(i) {
                let limit = tolerance * cut.nodes[node as usize].local.min(width);
                for side in 0..2 {
                    let (_, is_new) = self.rim.insert(cut.sides.vertices[node as usize][side].0);
                    // Where a curve ends, both sides have the same vertex.
                    if is_new {
                        self.places.push((node, side));
                    }
                    for h in cut.rim.fan(topology, cut.sides, node, side) {
                        self.add(h.triangle(), limit);
                    }
                }
            }
        }
        self.near_count = self.members.len();
        for i in 0..self.near_count {
            let Member { triangle, budget } = self.members[i];
            for h in triangle.half_edges() {
                if self.node_of(topology.origin(h)).is_none() {
                    around(topology, h, |h| self.add(h.triangle(), budget.limit));
                }
            }
        }
    }

    /// Adds a triangle; one that was added before keeps the smaller limit \[m\].
    pub(super) fn add(&mut self, triangle: TriangleId, limit: f64) {
        let (place, is_new) = self.found.insert(triangle.0);
        if is_new {
            let budget = DisplacementBudget { limit, moved: 0.0 };
            self.members.push(Member { triangle, budget });
        } else {
            let budget = &mut self.members[place].budget;
            budget.limit = budget.limit.min(limit);
        }
    }

    /// Returns the triangles that had a corner on the rim when the ring was found.
    pub(super) fn near(&self) -> impl Iterator<Item = TriangleId> + '_ {
        self.members[..self.near_count].iter().map(|m| m.triangle)
    }

    /// Returns the place of a triangle in the ring, if it has one.
    pub(super) fn place(&self, t: TriangleId) -> Option<usize> {
        self.found.find(t.0)
    }

    /// Returns the number of triangles.
    pub(super) fn len(&self) -> usize {
        self.members.len()
    }

    /// Returns the budget of a triangle; none outside the ring.
    pub(super) fn budget(&self, t: TriangleId) -> Option<DisplacementBudget> {
        Some(self.members[self.place(t)?].budget)
    }

    /// Sets the budget of a triangle of the ring.
    pub(super) fn set_budget(&mut self, t: TriangleId, budget: DisplacementBudget) {
        if let Some(place) = self.place(t) {
            self.members[place].budget = budget;
        }
    }

    /// Returns the node and the side of a vertex of the rim.
    pub(super) fn node_of(&self, v: VertexId) -> Option<(u32, usize)> {
        Some(self.places[self.rim.find(v.0)?])
    }
}

/// Calls `each` with the half-edges that leave the origin of `h`, from boundary to boundary at the
/// rim.
pub(super) fn around(topology: &Topology, h: HalfEdge, mut each: impl FnMut(HalfEdge)) {
    let mut at = h;
    loop {
        each(at);
        at = topology.twin(at.prev());
        if at == h {
            return;
        }
        if at.is_null() {
            break;
        }
    }
    let mut at = topology.twin(h);
    while !at.is_null() {
        at = at.next();
        each(at);
        at = topology.twin(at);
    }
}

/// Appends the neighbors of the origin of `h`.
pub(super) fn neighbors(topology: &Topology, h: HalfEdge, out: &mut Vec<VertexId>) {
    around(topology, h, |h| {
        out.push(topology.target(h));
        if topology.twin(h.prev()).is_null() {
            out.push(topology.origin(h.prev()));
        }
    });
}
