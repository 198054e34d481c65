//! [`PieceVertices`]: the vertices of every connected piece.

use incise_lattice::Lattice;
use incise_mesh::{Partition, Surface, VertexId, index_u32};
use std::ops::Range;

/// The vertices of a body, by piece and ascending.
#[derive(Debug, Clone, Default)]
pub(crate) struct PieceVertices {
    vertices: Vec<VertexId>,
    /// End of each piece in the list; pieces without vertices are left out.
    ends: Vec<u32>,
    /// Scratch memory: the next index in the list, shape [piece numbers].
    next: Vec<u32>,
    is_current: bool,
    generation: u64,
}

impl PieceVertices {
    /// Returns the vertices of each piece.
    pub(crate) fn iter(&self) -> impl ExactSizeIterator<Item = &[VertexId]> {
        (0..self.ends.len()).map(|i| &self.vertices[self.range(i)])
    }

    /// Returns the number of pieces.
    pub(crate) fn len(&self) -> usize {
        self.ends.len()
    }

    /// Returns a number that changes whenever the lists do.
    #[cfg(feature = "gpu")]
    pub(crate) fn generation(&self) -> u64 {
        self.generation
    }

    /// Returns the place of a piece in the list of vertices.
    pub(crate) fn range(&self, piece: usize) -> Range<usize> {
        let first = piece.checked_sub(1).map_or(0, |before| self.ends[before]);
        first as usize..self.ends[piece] as usize
    }

    /// Makes the next [`Self::update`] find the pieces again, after an edit.
    pub(crate) fn invalidate(&mut self) {
        self.is_current = false;
    }

    /// Finds the pieces of the surface as it is now, if it was edited since. O(n).
    pub(crate) fn update(&mut self, surface: &Surface) {
        if std::mem::replace(&mut self.is_current, true) {
            return;
        }
        self.generation += 1;
        let topology = surface.topology();
        let piece_of = |v: VertexId| surface.piece(topology.outgoing(v).triangle()) as usize;
        self.next.clear();
        self.next.resize(surface.piece_bound() as usize, 0);
        for v in topology.vertices() {
            self.next[piece_of(v)] += 1;
        }
        let mut end = 0;
        self.ends.clear();
        for next in &mut self.next {
            let count = std::mem::replace(next, end);
            end += count;
            self.ends.extend((count > 0).then_some(end));
        }
        self.vertices.clear();
        self.vertices.resize(index(end), VertexId::NULL);
        for v in topology.vertices() {
            let next = &mut self.next[piece_of(v)];
            self.vertices[index(*next)] = v;
            *next += 1;
        }
    }

    /// Finds the pieces of a lattice as it is now, if it was edited since: nodes that copies of
    /// cells connect. O(n).
    pub(crate) fn update_nodes(&mut self, lattice: &Lattice) {
        if std::mem::replace(&mut self.is_current, true) {
            return;
        }
        self.generation += 1;
        let count = lattice.node_positions.len();
        let mut sets = Partition::new(count);
        for (copy, nodes) in (0..).zip(&lattice.nodes) {
            if lattice.is_copy(copy) {
                for &node in &nodes[1..] {
                    sets.join(nodes[0], node);
                }
            }
        }
        let nodes = (0..index_u32(count)).filter(|&node| lattice.is_node(node));
        let mut order: Vec<(u32, u32)> = nodes.map(|node| (sets.find(node), node)).collect();
        order.sort_unstable();
        self.vertices.clear();
        self.ends.clear();
        for nodes in order.chunk_by(|a, b| a.0 == b.0) {
            self.vertices
                .extend(nodes.iter().map(|&(_, node)| VertexId(node)));
            self.ends.push(index_u32(self.vertices.len()));
        }
    }

    /// Returns the allocated size in elements.
    pub(crate) fn capacity(&self) -> usize {
        self.vertices.capacity() + self.ends.capacity() + self.next.capacity()
    }
}

fn index(number: u32) -> usize {
    number as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use incise_mesh::icosphere;

    #[test]
    fn every_vertex_is_in_the_list_of_its_piece() {
        let (mut corners, mut faces) = (Vec::new(), Vec::new());
        for ball in [0, 1, 0].map(|level| icosphere(level, 1.0)) {
            let first = index_u32(corners.len());
            corners.extend_from_slice(ball.rest_positions());
            let topology = ball.topology();
            faces.extend((topology.triangles()).map(|t| topology.triangle(t).map(|v| v.0 + first)));
        }
        let surface = Surface::from_triangles(&corners, &faces).unwrap();
        let mut pieces = PieceVertices::default();
        pieces.update(&surface);
        let counts: Vec<usize> = pieces.iter().map(<[VertexId]>::len).collect();
        assert_eq!(counts, [12, 42, 12]);
        for (i, vertices) in pieces.iter().enumerate() {
            assert!(vertices.is_sorted());
            let piece = |v: &VertexId| surface.piece(surface.topology().outgoing(*v).triangle());
            assert!(vertices.iter().all(|v| piece(v) as usize == i));
        }
    }
}
