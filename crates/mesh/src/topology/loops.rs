//! Boundary loops.

use super::Topology;
use crate::ids::HalfEdge;

impl Topology {
    /// Returns the boundary loops: chains of half-edges without a twin, in their triangles'
    /// direction.
    ///
    /// The hole is on the right of its loop. No loop passes a vertex twice: holes that touch at a
    /// vertex have separate loops. Loops are in the order of their smallest half-edge. O(n) for n
    /// triangles.
    ///
    /// ```
    /// use incise_mesh::icosphere;
    ///
    /// let mut body = icosphere(1, 0.5);
    /// assert!(body.topology().boundary_loops().is_empty());
    /// let t = body.topology().triangles().next().expect("a sphere has triangles");
    /// let rim = t.half_edges().map(|h| body.topology().twin(h));
    /// body.remove_triangles(&[t]);
    /// let loops = body.topology().boundary_loops();
    /// assert_eq!(loops.len(), 1);
    /// assert!(rim.iter().all(|h| loops[0].contains(h)));
    /// ```
    #[must_use]
    pub fn boundary_loops(&self) -> Vec<Vec<HalfEdge>> {
        let mut loops = Vec::new();
        let mut seen = vec![false; self.twin.len()];
        // Position of each vertex on the current path.
        let mut place = vec![u32::MAX; self.vertex_slots()];
        let mut path: Vec<HalfEdge> = Vec::new();
        let half_edges = self.triangles().flat_map(|t| t.half_edges());
        for start in half_edges.filter(|&h| self.twin(h).is_null()) {
            let mut at = start;
            while !std::mem::replace(&mut seen[at.index()], true) {
                let v = self.origin(at).index();
                if let Some(first) = path.get(place[v] as usize) {
                    debug_assert_eq!(self.origin(*first).index(), v, "places are kept");
                    loops.push(path.split_off(place[v] as usize));
                    for h in loops.last().into_iter().flatten() {
                        place[self.origin(*h).index()] = u32::MAX;
                    }
                }
                place[v] = HalfEdge::from_index(path.len()).0;
                path.push(at);
                at = self.following_boundary(at);
            }
            for h in &path {
                place[self.origin(*h).index()] = u32::MAX;
            }
            if !path.is_empty() {
                loops.push(std::mem::take(&mut path));
            }
        }
        loops
    }

    /// Returns the boundary half-edge after boundary half-edge `h`, in the same fan.
    fn following_boundary(&self, h: HalfEdge) -> HalfEdge {
        let mut at = h.next();
        while !self.twin(at).is_null() {
            at = self.twin(at).next();
        }
        at
    }
}

#[cfg(test)]
mod tests {
    use crate::ids::VertexId;
    use crate::{Surface, TriangleId, icosphere};

    /// Returns a grid of n x n squares of two triangles.
    fn grid(n: u32) -> Surface {
        let mut positions = Vec::new();
        for (y, x) in (0..=n).flat_map(|y| (0..=n).map(move |x| (y, x))) {
            positions.push([x, y, 0].map(|i| f32::from(u16::try_from(i).unwrap())));
        }
        let at = |x: u32, y: u32| y * (n + 1) + x;
        let squares = (0..n).flat_map(|y| (0..n).map(move |x| (x, y)));
        let triangles: Vec<[u32; 3]> = squares
            .flat_map(|(x, y)| {
                let [a, b, c, d] = [at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)];
                [[a, b, c], [a, c, d]]
            })
            .collect();
        Surface::from_triangles(&positions, &triangles).unwrap()
    }

    fn check(surface: &Surface, sizes: &[usize]) {
        let topology = surface.topology();
        let loops = topology.boundary_loops();
        let mut found: Vec<usize> = loops.iter().map(Vec::len).collect();
        found.sort_unstable();
        assert_eq!(found, sizes, "edges of each loop");
        for rim in &loops {
            for (i, &h) in rim.iter().enumerate() {
                assert!(topology.twin(h).is_null(), "{h} is on the boundary");
                let next = rim[(i + 1) % rim.len()];
                assert_eq!(topology.target(h), topology.origin(next), "it is a chain");
            }
            let mut vertices: Vec<VertexId> = rim.iter().map(|&h| topology.origin(h)).collect();
            vertices.sort_unstable();
            vertices.dedup();
            assert_eq!(vertices.len(), rim.len(), "no vertex twice");
        }
    }

    #[test]
    fn holes_and_the_outer_boundary_have_loops() {
        check(&icosphere(1, 0.5), &[]);
        check(&grid(4), &[16]);
        let mut surface = grid(6);
        // The square at (2, 2), and a distant triangle.
        surface.remove_triangles(&[28, 29, 50].map(TriangleId));
        check(&surface, &[3, 4, 24]);
    }

    #[test]
    fn holes_that_touch_in_a_vertex_have_a_loop_each() {
        let mut surface = grid(6);
        // The squares at (1, 1), (2, 2) and (3, 3) touch at corners; (3, 1) touches (2, 2) too.
        let squares = [7u32, 14, 21, 9];
        let holes: Vec<TriangleId> = squares
            .iter()
            .flat_map(|s| [TriangleId(2 * s), TriangleId(2 * s + 1)])
            .collect();
        surface.remove_triangles(&holes);
        check(&surface, &[4, 4, 4, 4, 24]);
    }
}
