//! Local edits of the corner table: other ids never change, and freed slots are reused.

use super::{Topology, TopologyError};
use crate::ids::{HalfEdge, TriangleId, VertexId};

impl Topology {
    /// Adds an unused vertex, in a free slot if there is one.
    pub fn add_vertex(&mut self) -> VertexId {
        self.free_vertices.pop().unwrap_or_else(|| {
            self.outgoing.push(HalfEdge::NULL);
            VertexId::from_index(self.outgoing.len() - 1)
        })
    }

    /// Adds a triangle without neighbors; [`Topology::stitch`] connects it.
    ///
    /// # Errors
    /// [`TopologyError`] if the vertices repeat or do not exist; nothing is added then.
    pub fn add_triangle(&mut self, corners: [VertexId; 3]) -> Result<TriangleId, TopologyError> {
        let [a, b, c] = corners;
        let triangle = self
            .free_triangles
            .last()
            .copied()
            .unwrap_or_else(|| TriangleId::from_index(self.triangle_slots()));
        if let Some(&vertex) = corners.iter().find(|v| v.index() >= self.outgoing.len()) {
            return Err(TopologyError::VertexOutOfRange {
                triangle,
                vertex,
                vertices: self.outgoing.len(),
            });
        }
        if a == b || b == c || c == a {
            let vertex = if b == c { b } else { a };
            return Err(TopologyError::RepeatedVertex { triangle, vertex });
        }
        if self.free_triangles.pop().is_none() {
            self.origin.extend([VertexId::NULL; 3]);
            self.twin.extend([HalfEdge::NULL; 3]);
        }
        for (h, v) in triangle.half_edges().into_iter().zip(corners) {
            self.origin[h.index()] = v;
            self.outgoing[v.index()] = h;
        }
        Ok(triangle)
    }

    /// Frees `triangles`, whose neighbors get boundaries there.
    ///
    /// Returns the vertices that become unused, ascending; they are not freed. O(k log k) for k
    /// triangles.
    ///
    /// Every vertex must have a single fan before the call, as in any 2-manifold.
    pub fn remove_triangles(&mut self, triangles: &[TriangleId]) -> Vec<VertexId> {
        let mut touched: Vec<VertexId> = triangles.iter().flat_map(|&t| self.triangle(t)).collect();
        touched.sort_unstable();
        touched.dedup();
        for &v in &touched {
            self.outgoing[v.index()] = HalfEdge::NULL;
        }
        let mut neighbors = Vec::new();
        for h in triangles.iter().flat_map(|t| t.half_edges()) {
            let twin = std::mem::replace(&mut self.twin[h.index()], HalfEdge::NULL);
            if !twin.is_null() {
                self.twin[twin.index()] = HalfEdge::NULL;
                neighbors.push(twin);
            }
            self.origin[h.index()] = VertexId::NULL;
        }
        // A fan with surviving triangles borders a removed one, so neighbors reach every survivor.
        for h in neighbors {
            let (a, b) = (self.origin(h), self.target(h));
            if !a.is_null() {
                self.outgoing[a.index()] = h;
                self.outgoing[b.index()] = h.next();
            }
        }
        self.free_triangles.extend(triangles.iter().rev());
        touched.retain(|&v| self.outgoing(v).is_null());
        touched
    }

    /// Frees unused vertices.
    ///
    /// # Panics
    /// If a triangle uses one of them.
    pub fn remove_vertices(&mut self, vertices: &[VertexId]) {
        for &v in vertices {
            assert!(self.outgoing(v).is_null(), "{v} is still in use");
        }
        self.free_vertices.extend(vertices.iter().rev());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tetrahedron() -> Topology {
        Topology::from_triangles(4, &[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]).unwrap()
    }

    #[test]
    fn removing_and_adding_the_same_triangle_closes_the_hole_again() {
        let mut t = tetrahedron();
        assert!(t.remove_triangles(&[TriangleId(2)]).is_empty());
        t.validate().unwrap();
        assert!(!t.is_closed());
        let back = t
            .add_triangle([VertexId(1), VertexId(2), VertexId(3)])
            .unwrap();
        assert_eq!(back, TriangleId(2), "a freed slot is used again");
        let open: Vec<HalfEdge> = (0..12)
            .map(HalfEdge)
            .filter(|&h| t.twin(h).is_null())
            .collect();
        assert_eq!(open.len(), 6);
        t.stitch(&open).unwrap();
        t.validate().unwrap();
        assert!(t.is_closed());
    }

    #[test]
    fn a_vertex_without_triangles_is_reported() {
        let mut t = tetrahedron();
        let orphans = t.remove_triangles(&[TriangleId(1), TriangleId(2), TriangleId(3)]);
        assert_eq!(orphans, [VertexId(3)]);
        t.remove_vertices(&orphans);
        t.validate().unwrap();
        assert_eq!((t.vertex_count(), t.triangle_count()), (3, 1));
        assert_eq!(t.add_vertex(), VertexId(3));
    }
}
