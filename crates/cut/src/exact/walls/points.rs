//! The points of walls: sets of vertices with equal rest positions.

use crate::exact::sparse_set::SparseSet;
use crate::sizing::RestShape;
use incise_mesh::{HalfEdge, Surface, Topology, VertexId, index_u32};

/// The points near a cut.
#[derive(Debug, Clone, Default)]
pub(super) struct Points {
    /// The vertices near the cut.
    known: SparseSet,
    /// By place of a vertex: a half-edge that leaves it, null once it is gone; its point.
    starts: Vec<HalfEdge>,
    point_of: Vec<u32>,
    /// By place, the next vertex of its point, by its place; [`LAST`] for the last one.
    next: Vec<u32>,
    /// By point, the place of its first vertex.
    first: Vec<u32>,
}

/// No next vertex of a point.
const LAST: u32 = u32::MAX;

impl Points {
    /// Collects the origins of half-edges and their neighbors.
    pub(super) fn find(&mut self, surface: &Surface, shape: RestShape, starts: &[HalfEdge]) {
        let topology = surface.topology();
        self.known.clear(topology.vertex_slots());
        self.starts.clear();
        for &h in starts {
            self.add(topology, h);
        }
        for i in 0..self.starts.len() {
            let first = self.starts[i];
            let mut at = first;
            loop {
                self.add(topology, at.next());
                at = topology.twin(at.prev());
                if at.is_null() || at == first {
                    break;
                }
            }
        }
        let mut keyed: Vec<([u32; 3], VertexId)> = (self.starts.iter())
            .map(|&h| topology.origin(h))
            .map(|v| (shape.bits(surface, v), v))
            .collect();
        keyed.sort_unstable();
        self.first.clear();
        self.point_of.clear();
        self.point_of.resize(self.starts.len(), 0);
        self.next.clear();
        self.next.resize(self.starts.len(), LAST);
        for own in keyed.chunk_by(|a, b| a.0 == b.0) {
            let point = index_u32(self.first.len());
            self.first.push(LAST);
            for &(_, v) in own.iter().rev() {
                if let Some(place) = self.known.find(v.0) {
                    self.point_of[place] = point;
                    self.next[place] = self.first[point as usize];
                    self.first[point as usize] = index_u32(place);
                }
            }
        }
    }

    /// Adds a new vertex, which the half-edge `h` leaves, to a point.
    pub(super) fn insert(&mut self, v: VertexId, h: HalfEdge, point: u32) {
        let (place, is_new) = self.known.insert(v.0);
        if is_new {
            self.starts.push(HalfEdge::NULL);
            self.point_of.push(point);
            self.next.push(LAST);
        }
        self.starts[place] = h;
        self.point_of[place] = point;
        self.next[place] = self.first[point as usize];
        self.first[point as usize] = index_u32(place);
    }

    fn add(&mut self, topology: &Topology, h: HalfEdge) {
        if self.known.insert(topology.origin(h).0).1 {
            self.starts.push(h);
        }
    }

    /// Returns the number of points.
    pub(super) fn len(&self) -> u32 {
        index_u32(self.first.len())
    }

    /// Iterates over half-edges that leave the vertices of a point, one for each.
    pub(super) fn starts(&self, point: u32) -> impl Iterator<Item = HalfEdge> + '_ {
        let place = |place: u32| Some(place).filter(|&place| place != LAST);
        let first = place(self.first[point as usize]);
        std::iter::successors(first, move |&last| place(self.next[last as usize]))
            .map(|place| self.starts[place as usize])
            .filter(|h| !h.is_null())
    }

    /// Returns the point of a vertex, if it is near the cut.
    pub(super) fn point_of(&self, v: VertexId) -> Option<u32> {
        Some(self.point_of[self.known.find(v.0)?])
    }

    /// Sets the half-edge that leaves its origin; null for a vertex that is gone.
    pub(super) fn set_start(&mut self, v: VertexId, h: HalfEdge) {
        if let Some(place) = self.known.find(v.0) {
            self.starts[place] = h;
        }
    }
}
