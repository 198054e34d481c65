//! Opens the surface along the curves: replaces hit triangles by their parts on two sides.

use super::split::{Corner, EdgeRole, Part, Splitter};
use crate::interpolate::{OldTriangle, add_vertex};
use crate::intersection::node::Node;
use crate::intersection::trace::Trace;
use incise_mesh::{Edit, HalfEdge, Surface, TriangleId, VertexId};

/// Both sides of the rim. Side 0 is below the sweep, side 1 above it.
#[derive(Debug, Clone, Default)]
pub(crate) struct Sides {
    /// The vertices of each node, by side.
    pub(super) vertices: Vec<[VertexId; 2]>,
    /// The boundary half-edges along the rim's edge that begins at each node, by side. On side 0 it
    /// runs to the node, on side 1 from it.
    pub(super) rim: Vec<[HalfEdge; 2]>,
    /// Hit triangles and how their edges are to be joined, ascending.
    seams: Vec<Seam>,
    added: Vec<TriangleId>,
}

/// A hit triangle before the cut, and the half-edges of its parts.
#[derive(Debug, Clone, Copy)]
struct Seam {
    old: OldTriangle,
    /// Half-edges of the neighbors.
    beyond: [HalfEdge; 3],
    piece: u32,
    material: u32,
    /// New half-edges along each edge, in order; null where there are fewer.
    along: [[HalfEdge; 3]; 3],
}

impl Sides {
    /// Adds two vertices per node and replaces hit triangles by their parts.
    pub(super) fn open(
        &mut self,
        edit: &mut Edit<'_>,
        trace: &Trace,
        is_valley: bool,
        splitter: &mut Splitter,
    ) {
        self.vertices.clear();
        for node in &trace.nodes {
            let vertex = [0, 1].map(|_| add_vertex(edit, node.position, node.origin()));
            self.vertices.push(vertex);
        }
        self.rim.clear();
        self.rim.resize(trace.nodes.len(), [HalfEdge::NULL; 2]);
        self.seams.clear();
        // All before the first removal, which makes its neighbors boundaries.
        let hits = || trace.chords.chunk_by(|a, b| a.triangle == b.triangle);
        (self.seams).extend(hits().map(|chords| Seam::of(edit.surface(), chords[0].triangle)));
        for (i, chords) in hits().enumerate() {
            let mut seam = self.seams[i];
            let corners = edit.surface().triangle_positions(seam.old.triangle);
            splitter.split(corners, seam.beyond, &trace.nodes, is_valley, chords);
            self.replace(edit, &trace.nodes, &mut seam, &splitter.parts);
            self.seams[i] = seam;
        }
        self.join(edit);
    }

    /// Replaces a hit triangle by its parts.
    fn replace(&mut self, edit: &mut Edit<'_>, nodes: &[Node], seam: &mut Seam, parts: &[Part]) {
        edit.remove_triangle(seam.old.triangle);
        self.added.clear();
        for part in parts {
            let corners = part.corners.map(|corner| match corner {
                Corner::Old(k) => seam.old.corners[k],
                Corner::Node { node, side } => self.vertices[node as usize][side],
            });
            let t = edit.add_triangle(corners, seam.piece, seam.material);
            self.added.push(t);
            if seam.old.is_plain() {
                continue;
            }
            for (h, corner) in t.half_edges().into_iter().zip(part.corners) {
                let weights = match corner {
                    Corner::Old(k) => [0, 1, 2].map(|i| if i == k { 1.0 } else { 0.0 }),
                    Corner::Node { node, .. } => nodes[node as usize].weights_in(seam.old.corners),
                };
                seam.old.interpolate(edit, h, weights);
            }
        }
        for (t, part) in self.added.iter().zip(parts) {
            for (h, role) in t.half_edges().into_iter().zip(part.edges) {
                match role {
                    EdgeRole::Outer { edge, part } => seam.along[edge][part] = h,
                    EdgeRole::Rim { node, side } => self.rim[node as usize][side] = h,
                    EdgeRole::Inner { other, edge } => {
                        let twin = self.added[other].half_edges()[edge];
                        if h < twin {
                            edit.set_twins(h, twin);
                        }
                    }
                }
            }
        }
    }

    /// Joins the parts to each other and to the triangles around.
    fn join(&self, edit: &mut Edit<'_>) {
        for seam in &self.seams {
            for (beyond, along) in seam.beyond.into_iter().zip(seam.along) {
                if beyond.is_null() {
                    continue;
                }
                let other = self
                    .seams
                    .binary_search_by_key(&beyond.triangle(), |s| s.old.triangle);
                let Ok(other) = other else {
                    edit.set_twins(along[0], beyond);
                    continue;
                };
                if beyond.triangle() < seam.old.triangle {
                    continue;
                }
                let [first, ..] = beyond.triangle().half_edges();
                let edge = beyond.index() - first.index();
                let across = self.seams[other].along[edge];
                let parts = along.iter().filter(|h| !h.is_null()).count();
                for part in 0..parts {
                    edit.set_twins(along[part], across[parts - 1 - part]);
                }
            }
        }
    }
}

impl Seam {
    fn of(surface: &Surface, triangle: TriangleId) -> Self {
        Self {
            old: OldTriangle::new(surface, triangle),
            beyond: triangle.half_edges().map(|h| surface.topology().twin(h)),
            piece: surface.piece(triangle),
            material: surface.material(triangle),
            along: [[HalfEdge::NULL; 3]; 3],
        }
    }
}
