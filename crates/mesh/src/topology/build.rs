//! Construction of a corner table from a list of triangles.

use super::{Topology, TopologyError};
use crate::bucket_sort::sort_in_buckets;
use crate::ids::{EdgeKey, HalfEdge, TriangleId, VertexId};

impl Topology {
    /// Builds the connectivity of `triangles` over `vertex_count` vertices.
    ///
    /// Boundaries and unused vertices are allowed.
    ///
    /// # Errors
    /// [`TopologyError`] with the first invalid element in index order.
    pub fn from_triangles(
        vertex_count: usize,
        triangles: &[[u32; 3]],
    ) -> Result<Self, TopologyError> {
        let mut topology = Self::unstitched(vertex_count, triangles)?;
        let all: Vec<HalfEdge> = (0..topology.origin.len())
            .map(HalfEdge::from_index)
            .collect();
        topology.stitch(&all)?;
        Ok(topology)
    }

    /// Builds the connectivity of `triangles`, whose pairs of half-edges are known.
    #[cfg(feature = "io")]
    pub(crate) fn from_twins(
        vertex_count: usize,
        triangles: &[[u32; 3]],
        twin: Vec<HalfEdge>,
    ) -> Result<Self, TopologyError> {
        let topology = Self::unstitched(vertex_count, triangles)?;
        Ok(Self { twin, ..topology })
    }

    /// Returns the connectivity of triangles that share no edges yet.
    fn unstitched(vertex_count: usize, triangles: &[[u32; 3]]) -> Result<Self, TopologyError> {
        for (i, corners) in triangles.iter().enumerate() {
            let triangle = TriangleId::from_index(i);
            let [a, b, c] = corners.map(VertexId);
            for vertex in [a, b, c] {
                if vertex.index() >= vertex_count {
                    return Err(TopologyError::VertexOutOfRange {
                        triangle,
                        vertex,
                        vertices: vertex_count,
                    });
                }
            }
            if a == b || b == c || c == a {
                let vertex = if b == c { b } else { a };
                return Err(TopologyError::RepeatedVertex { triangle, vertex });
            }
        }
        let origin: Vec<VertexId> = triangles.iter().flatten().map(|&v| VertexId(v)).collect();
        let mut topology = Self {
            twin: vec![HalfEdge::NULL; origin.len()],
            outgoing: vec![HalfEdge::NULL; vertex_count],
            origin,
            ..Self::default()
        };
        for h in (0..topology.origin.len()).map(HalfEdge::from_index) {
            let v = topology.origin(h);
            if topology.outgoing(v).is_null() {
                topology.outgoing[v.index()] = h;
            }
        }
        Ok(topology)
    }

    /// Pairs those of `half_edges` that share an edge in opposite directions.
    ///
    /// Half-edges without a partner stay boundaries. O(k log k) for k half-edges.
    ///
    /// # Errors
    /// [`TopologyError::NonManifoldEdge`] or [`TopologyError::InconsistentWinding`]; nothing is
    /// paired then.
    pub fn stitch(&mut self, half_edges: &[HalfEdge]) -> Result<(), TopologyError> {
        let key = |&h: &HalfEdge| (EdgeKey::new(self.origin(h), self.target(h)), h);
        let keyed = half_edges.iter().map(key);
        // A bucket per vertex costs too much where an edit stitches a few half-edges.
        let keyed = if half_edges.len() < self.vertex_slots() {
            let mut keyed: Vec<(EdgeKey, HalfEdge)> = keyed.collect();
            keyed.sort_unstable();
            keyed
        } else {
            sort_by_edge(keyed, self.vertex_slots())
        };
        for group in keyed.chunk_by(|x, y| x.0 == y.0) {
            let [a, b] = group[0].0.vertices();
            match *group {
                [_] => {}
                [(_, h), (_, g)] if self.origin(h) == self.origin(g) => {
                    return Err(TopologyError::InconsistentWinding {
                        first: h.triangle(),
                        second: g.triangle(),
                    });
                }
                [_, _] => {}
                _ => return Err(TopologyError::NonManifoldEdge { a, b }),
            }
        }
        for group in keyed.chunk_by(|x, y| x.0 == y.0) {
            if let [(_, h), (_, g)] = *group {
                self.twin[h.index()] = g;
                self.twin[g.index()] = h;
            }
        }
        Ok(())
    }
}

/// Sorts half-edges over `vertex_count` vertices by their edges' keys, then by their ids.
pub(crate) fn sort_by_edge(
    keyed: impl Iterator<Item = (EdgeKey, HalfEdge)> + Clone,
    vertex_count: usize,
) -> Vec<(EdgeKey, HalfEdge)> {
    sort_in_buckets(keyed, vertex_count, |(key, _)| key.vertices()[0].0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_name_the_invalid_triangle() {
        let out = Topology::from_triangles(3, &[[0, 1, 2], [0, 1, 3]]);
        assert_eq!(
            out,
            Err(TopologyError::VertexOutOfRange {
                triangle: TriangleId(1),
                vertex: VertexId(3),
                vertices: 3
            })
        );
        let out = Topology::from_triangles(3, &[[0, 2, 2]]);
        assert_eq!(
            out,
            Err(TopologyError::RepeatedVertex {
                triangle: TriangleId(0),
                vertex: VertexId(2)
            })
        );
        let out = Topology::from_triangles(4, &[[0, 1, 2], [0, 1, 3]]);
        assert_eq!(
            out,
            Err(TopologyError::InconsistentWinding {
                first: TriangleId(0),
                second: TriangleId(1)
            })
        );
        let out = Topology::from_triangles(5, &[[0, 1, 2], [1, 0, 3], [0, 1, 4]]);
        assert_eq!(
            out,
            Err(TopologyError::NonManifoldEdge {
                a: VertexId(0),
                b: VertexId(1)
            })
        );
    }

    #[test]
    fn a_tetrahedron_is_closed() {
        let t = Topology::from_triangles(4, &[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]).unwrap();
        t.validate().unwrap();
        assert_eq!(t.edges().count(), 6);
        assert!(t.is_closed());
    }
}
