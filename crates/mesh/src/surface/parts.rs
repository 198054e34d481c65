//! Extraction of pieces, compaction, and the order of vertices and triangles.

use super::{CornerAttributes, Domain, Surface};
use crate::bvh::sort_along_curve;
use crate::ids::{HalfEdge, TriangleId, VertexId};

impl Surface {
    /// Returns one piece as a surface without free slots, in slot order.
    ///
    /// O(n); use [`Self::extract_pieces`] for all pieces.
    #[must_use]
    pub fn extract_piece(&self, piece: u32) -> Self {
        let triangles = self.topology.triangles();
        let kept: Vec<TriangleId> = triangles.filter(|&t| self.piece(t) == piece).collect();
        let mut vertex_map = vec![VertexId::NULL; self.topology.vertex_slots()];
        self.gather(&kept, &self.vertices_of(&kept), &mut vertex_map)
    }

    /// Iterates over all pieces in the order of their numbers, as [`Self::extract_piece`] returns
    /// them.
    ///
    /// O(n log n) for all of them.
    pub fn extract_pieces(&self) -> impl Iterator<Item = (u32, Self)> {
        let mut order: Vec<TriangleId> = self.topology.triangles().collect();
        // The sort is stable: slot order within a piece.
        order.sort_by_key(|&t| self.piece(t));
        let mut vertex_map = vec![VertexId::NULL; self.topology.vertex_slots()];
        let mut first = 0;
        std::iter::from_fn(move || {
            let piece = self.piece(*order.get(first)?);
            let kept = &order[first..first + self.piece_triangles(piece)];
            first += kept.len();
            let part = self.gather(kept, &self.vertices_of(kept), &mut vertex_map);
            for v in kept.iter().flat_map(|&t| self.topology.triangle(t)) {
                vertex_map[v.index()] = VertexId::NULL;
            }
            Some((piece, part))
        })
    }

    /// Renumbers vertices and triangles in their order, so that no slot is free.
    ///
    /// Returns the new id, or null, of every old vertex and triangle slot.
    pub fn compact(&mut self) -> (Vec<VertexId>, Vec<TriangleId>) {
        let triangles: Vec<TriangleId> = self.topology.triangles().collect();
        self.renumber(&triangles, &self.vertices_of(&triangles))
    }

    /// Renumbers vertices and triangles along a curve through space, so that no slot is free.
    ///
    /// Neighbors then lie close to each other in memory, and cuts and solvers wait less for it.
    /// Pieces keep their numbers. Returns the new id, or null, of every old vertex and triangle
    /// slot. O(n log n).
    pub fn sort_by_position(&mut self) -> (Vec<VertexId>, Vec<TriangleId>) {
        let mut triangles: Vec<TriangleId> = self.topology.triangles().collect();
        sort_along_curve(self, &mut triangles);
        let mut vertices = self.vertices_of(&triangles);
        let mut first_use = vec![usize::MAX; self.topology.vertex_slots()];
        let corners = triangles.iter().flat_map(|&t| self.topology.triangle(t));
        for (i, v) in corners.enumerate() {
            first_use[v.index()] = i.min(first_use[v.index()]);
        }
        vertices.sort_unstable_by_key(|v| first_use[v.index()]);
        self.renumber(&triangles, &vertices)
    }

    /// Reverses the orientation of all triangles, and renumbers them like [`Self::compact`].
    ///
    /// # Errors
    /// [`TopologyError`](crate::TopologyError) if the surface is no manifold; it is only renumbered
    /// then.
    pub fn flip(&mut self) -> Result<(), crate::TopologyError> {
        self.compact();
        let (topology, positions) = (&self.topology, &self.positions);
        let triangles: Vec<[u32; 3]> = (topology.triangles())
            .map(|t| {
                let [a, b, c] = topology.triangle(t).map(|v| v.0);
                [a, c, b]
            })
            .collect();
        let points: Vec<[f32; 3]> = positions.iter().map(|&[x, y, z, _]| [x, y, z]).collect();
        let mut flipped = Self::from_triangles(&points, &triangles)?;
        for t in topology.triangles() {
            flipped.set_piece(t, self.piece(t));
        }
        flipped.pieces.set_bound(self.piece_bound());
        flipped.positions.clone_from(positions);
        flipped.rest.clone_from(&self.rest);
        flipped.material.clone_from(&self.material);
        flipped.origin = self.origin;
        flipped.corners = CornerAttributes {
            uv: turned(&self.corners.uv),
            normal: turned(&self.corners.normal),
        };
        let corners: Vec<usize> = (0..3 * triangles.len()).collect();
        let corners = turned(&corners);
        let channels = self.channels.iter().map(|channel| match channel.domain() {
            Domain::Vertex => channel.clone(),
            Domain::Corner => channel.gather(corners.iter().copied()),
        });
        flipped.channels = channels.collect();
        *self = flipped;
        Ok(())
    }

    /// Renumbers vertices and triangles in the given order.
    fn renumber(
        &mut self,
        triangles: &[TriangleId],
        vertices: &[VertexId],
    ) -> (Vec<VertexId>, Vec<TriangleId>) {
        let mut new_vertices = vec![VertexId::NULL; self.topology.vertex_slots()];
        let mut new_triangles = vec![TriangleId::NULL; self.topology.triangle_slots()];
        let mut surface = self.gather(triangles, vertices, &mut new_vertices);
        for (new, old) in surface.topology.triangles().zip(triangles) {
            new_triangles[old.index()] = new;
        }
        surface.pieces.set_bound(self.piece_bound());
        *self = surface;
        (new_vertices, new_triangles)
    }

    /// Returns the vertices of triangles, ascending.
    fn vertices_of(&self, triangles: &[TriangleId]) -> Vec<VertexId> {
        let corners = triangles.iter().flat_map(|&t| self.topology.triangle(t));
        let mut vertices: Vec<VertexId> = corners.collect();
        vertices.sort_unstable();
        vertices.dedup();
        vertices
    }

    /// Returns the surface of the given triangles and their vertices, in the given order.
    ///
    /// `vertex_map` is null for every vertex slot and receives the new ids of used vertices.
    fn gather(
        &self,
        kept: &[TriangleId],
        vertices: &[VertexId],
        vertex_map: &mut [VertexId],
    ) -> Self {
        let topology = &self.topology;
        let mut out = Self {
            origin: self.origin,
            ..Self::default()
        };
        for v in vertices {
            vertex_map[v.index()] = out.add_vertex(self.positions[v.index()], self.rest[v.index()]);
        }
        for &t in kept {
            let corners = topology.triangle(t).map(|v| vertex_map[v.index()]);
            let new = out
                .add_triangle(corners, self.piece(t))
                .expect("the corners of a triangle are distinct vertices");
            out.material[new.index()] = self.material(t);
        }
        let half_edges = || kept.iter().flat_map(|t| t.half_edges());
        let uv = half_edges().filter_map(|h| self.corners.uv.get(h.index()));
        let normal = half_edges().filter_map(|h| self.corners.normal.get(h.index()));
        out.corners = CornerAttributes {
            uv: uv.copied().collect(),
            normal: normal.copied().collect(),
        };
        let gathered = self.channels.iter().map(|channel| match channel.domain() {
            Domain::Vertex => channel.gather(vertices.iter().map(|v| v.index())),
            Domain::Corner => channel.gather(half_edges().map(HalfEdge::index)),
        });
        out.channels = gathered.collect();
        let half_edges: Vec<HalfEdge> = out
            .topology
            .triangles()
            .flat_map(TriangleId::half_edges)
            .collect();
        out.stitch(&half_edges)
            .expect("a part of an oriented manifold is one");
        out
    }
}

/// Exchanges the last two corners of every triangle.
fn turned<T: Copy>(values: &[T]) -> Vec<T> {
    let triangles = values.as_chunks::<3>().0.iter();
    triangles.flat_map(|&[a, b, c]| [a, c, b]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::{Blend, Channel};

    #[test]
    fn a_piece_keeps_its_attributes() {
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let positions = [corners, corners, corners].concat();
        let mut surface =
            Surface::from_triangles(&positions, &[[0, 1, 2], [3, 4, 5], [6, 7, 8]]).unwrap();
        for t in [0, 1, 2] {
            surface.set_material(TriangleId(t), 10 + t);
        }
        surface.corners.uv = (0..9_u8).map(|i| [f32::from(i), 0.0]).collect();
        let unused = surface.remove_triangles(&[TriangleId(0)]);
        surface.remove_vertices(&unused);
        let last = surface.extract_piece(2);
        assert_eq!(last.corners.uv, [[6.0, 0.0], [7.0, 0.0], [8.0, 0.0]]);
        assert_eq!(last.material(TriangleId(0)), 12);
        let uv = surface.corners.uv[3..].to_vec();
        surface.compact();
        assert_eq!(surface.corners.uv, uv);
        assert_eq!([0, 1].map(|t| surface.material(TriangleId(t))), [11, 12]);
        assert_eq!([0, 1, 2].map(|p| surface.piece_triangles(p)), [0, 1, 1]);
        assert_eq!(surface.piece_bound(), 3);
    }

    #[test]
    fn two_flips_change_nothing() {
        let mut surface = crate::shapes::torus(0.4, 0.15, 6, 4);
        let corners = 3 * surface.topology().triangle_slots();
        surface.corners.uv = (0..corners).map(|i| [i as f32, 0.0]).collect();
        let values = (0..corners).map(|i| i as f32).collect();
        let channel = Channel::new("c", Domain::Corner, Blend::Linear, 1, values).unwrap();
        surface.set_channel(channel).unwrap();
        surface.set_material(TriangleId(3), 4);
        let (before, volume) = (surface.clone(), surface.volume());
        surface.flip().unwrap();
        assert_eq!(surface.volume(), -volume);
        let value = |h: HalfEdge| surface.channels[0].values()[h.index()];
        for t in surface.topology().triangles() {
            for h in t.half_edges() {
                assert_eq!(value(h), surface.corners.uv[h.index()][0]);
            }
        }
        surface.flip().unwrap();
        assert_eq!(surface, before);
    }

    #[test]
    fn sorting_changes_nothing_but_ids() {
        let ball = crate::icosphere(3, 0.5);
        let count = ball.topology().triangle_count();
        let corners = |t: usize| ball.topology().triangle(TriangleId::from_index(t));
        // 7 has no common divisor with the number of triangles.
        let shuffled: Vec<[u32; 3]> = (0..count)
            .map(|i| corners(7 * i % count).map(|v| v.0))
            .collect();
        let positions: Vec<[f32; 3]> = ball
            .positions
            .iter()
            .map(|&[x, y, z, _]| [x, y, z])
            .collect();
        let mut old = Surface::from_triangles(&positions, &shuffled).unwrap();
        old.corners.uv = (0..3 * count).map(|i| [i as f32, 0.0]).collect();
        for t in 0..count {
            let t = TriangleId::from_index(t);
            old.set_material(t, t.0 % 5);
            old.set_piece(t, t.0 % 3);
        }
        let unused = old.remove_triangles(&[TriangleId(4), TriangleId(9)]);
        old.remove_vertices(&unused);
        let mut new = old.clone();
        let (vertices, triangles) = new.sort_by_position();
        new.validate().unwrap();
        assert_eq!(new.topology().triangle_slots(), count - 2);
        for t in old.topology().triangles() {
            let to = triangles[t.index()];
            let corners = old.topology().triangle(t).map(|v| vertices[v.index()]);
            assert_eq!(new.topology().triangle(to), corners);
            assert_eq!(
                (new.material(to), new.piece(to)),
                (old.material(t), old.piece(t))
            );
            for (a, b) in t.half_edges().into_iter().zip(to.half_edges()) {
                assert_eq!(old.corners.uv[a.index()], new.corners.uv[b.index()]);
            }
        }
        for v in old.topology().vertices() {
            let to = vertices[v.index()];
            assert_eq!(old.positions[v.index()], new.positions[to.index()]);
            assert_eq!(old.rest[v.index()], new.rest[to.index()]);
        }
        let removed = [TriangleId(4), TriangleId(9)].map(|t| triangles[t.index()]);
        assert_eq!(removed, [TriangleId::NULL; 2]);
        // Mean distance of neighbors in memory.
        let apart = |surface: &Surface| {
            let topology = surface.topology();
            let twins = topology.edges().filter(|&h| !topology.twin(h).is_null());
            let apart = |h: HalfEdge| h.triangle().0.abs_diff(topology.twin(h).triangle().0);
            twins.map(|h| u64::from(apart(h))).sum::<u64>()
        };
        assert!(
            10 * apart(&new) < apart(&old),
            "{} of {}",
            apart(&new),
            apart(&old)
        );
        let sorted = new.clone();
        new.sort_by_position();
        assert!(new == sorted, "the order depends on positions alone");
    }

    #[test]
    fn extract_pieces_equals_extract_piece() {
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let positions = [corners, corners, [[9.0; 3]; 3], corners].concat();
        let faces = [[9, 10, 11], [0, 1, 2], [2, 1, 3], [4, 6, 5]];
        let mut surface = Surface::from_triangles(&positions, &faces).unwrap();
        // Two pieces that share vertices, with unordered numbers and gaps.
        for (t, piece) in (0..).zip([7, 2, 5, 2]) {
            surface.set_piece(TriangleId(t), piece);
        }
        let all: Vec<(u32, Surface)> = surface.extract_pieces().collect();
        let numbers: Vec<u32> = all.iter().map(|part| part.0).collect();
        assert_eq!(numbers, [2, 5, 7]);
        for (piece, part) in all {
            assert_eq!(part, surface.extract_piece(piece), "piece {piece}");
            assert_eq!(
                part.topology().triangle_count(),
                surface.piece_triangles(piece)
            );
        }
        assert_eq!(
            surface.extract_piece(5).rest,
            [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0; 3]]
        );
    }
}
