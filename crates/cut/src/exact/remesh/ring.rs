//! The triangles around the rim that may change, and by how much the surface may still move there.

use super::super::contract::Opened;
use super::few::Few;
use incise_mesh::{HalfEdge, Topology, TriangleId, VertexId};

/// How far the surface may move at a triangle, and how far it has at most \[m\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Room {
    pub(super) limit: f64,
    pub(super) moved: f64,
}

impl Room {
    /// What holds for all of some triangles when it holds for each.
    pub(super) fn with(self, other: Self) -> Self {
        Self {
            limit: self.limit.min(other.limit),
            moved: self.moved.max(other.moved),
        }
    }

    /// The room that is left after another move by `distance`; none if there is not as much.
    pub(super) fn after(self, distance: f64) -> Option<Self> {
        let moved = self.moved + distance;
        (moved <= self.limit).then_some(Self { moved, ..self })
    }
}

/// A triangle of the ring.
#[derive(Debug, Clone, Copy)]
struct Member {
    triangle: TriangleId,
    room: Room,
}

/// Triangles with a corner on the rim or beside a vertex of it.
#[derive(Debug, Clone, Default)]
pub(super) struct Ring {
    found: Few,
    members: Vec<Member>,
    /// How many of the members have a corner on the rim.
    near: usize,
    rim: Few,
    /// The node and the lip of each rim vertex.
    places: Vec<(u32, usize)>,
}

impl Ring {
    /// Finds the ring of both lips. At a triangle the surface may move by `tolerance` of the local edge
    /// length at the nodes beside it, or of the section's `width` where that is less \[m\].
    pub(super) fn find(&mut self, cut: &Opened<'_, '_>, tolerance: f64, width: f64) {
        let topology = cut.edit.surface().topology();
        self.found.begin(topology.triangle_slots());
        self.rim.begin(topology.vertex_slots());
        self.members.clear();
        self.places.clear();
        for i in 0..cut.rim.sizes.len() {
            for node in cut.rim.ring(i) {
                let limit = tolerance * cut.nodes[node as usize].local.min(width);
                for lip in 0..2 {
                    let (_, is_new) = self.rim.mark(cut.lips.vertices[node as usize][lip].0);
                    debug_assert!(is_new, "a lip has a vertex of its own for every node");
                    self.places.push((node, lip));
                    for h in cut.rim.fan(topology, cut.lips, node, lip) {
                        self.add(h.triangle(), limit);
                    }
                }
            }
        }
        self.near = self.members.len();
        for i in 0..self.near {
            let Member { triangle, room } = self.members[i];
            for h in triangle.half_edges() {
                if self.node_of(topology.origin(h)).is_none() {
                    around(topology, h, |h| self.add(h.triangle(), room.limit));
                }
            }
        }
    }

    /// Takes a triangle in, with the least limit that it was taken in with \[m\].
    pub(super) fn add(&mut self, triangle: TriangleId, limit: f64) {
        let (place, is_new) = self.found.mark(triangle.0);
        if is_new {
            let room = Room { limit, moved: 0.0 };
            self.members.push(Member { triangle, room });
        } else {
            let room = &mut self.members[place].room;
            room.limit = room.limit.min(limit);
        }
    }

    /// The triangles that had a corner on the rim when the ring was found.
    pub(super) fn near(&self) -> impl Iterator<Item = TriangleId> + '_ {
        self.members[..self.near].iter().map(|m| m.triangle)
    }

    /// The place of a triangle in the ring, if it is in it.
    pub(super) fn place(&self, t: TriangleId) -> Option<usize> {
        self.found.find(t.0)
    }

    /// How many triangles were found.
    pub(super) fn len(&self) -> usize {
        self.members.len()
    }

    /// The room at a triangle; none outside the ring.
    pub(super) fn room(&self, t: TriangleId) -> Option<Room> {
        Some(self.members[self.place(t)?].room)
    }

    /// Changes the room at a triangle of the ring.
    pub(super) fn set_room(&mut self, t: TriangleId, room: Room) {
        if let Some(place) = self.place(t) {
            self.members[place].room = room;
        }
    }

    /// The node and the lip of a vertex of the rim.
    pub(super) fn node_of(&self, v: VertexId) -> Option<(u32, usize)> {
        Some(self.places[self.rim.find(v.0)?])
    }
}

/// Calls `each` with the half-edges that leave the origin of `h`, from boundary to boundary at the rim.
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
