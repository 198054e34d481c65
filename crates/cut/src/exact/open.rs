//! Opens the surface along the curves: replaces hit triangles by their parts on two sides.

use super::rest::add_vertex_between;
use super::split::{Corner, EdgeRole, Hit, Part, Splitter};
use crate::error::CutError;
use crate::intersection::facets::Facets;
use crate::intersection::node::{Node, On};
use crate::intersection::trace::Trace;
use incise_mesh::{Edit, HalfEdge, Surface, TriangleCorners, TriangleId, VertexId};

/// Both sides of the rim. Side 0 is below the sweep, side 1 above it.
#[derive(Debug, Clone, Default)]
pub(crate) struct Sides {
    /// The vertices of each node, by side; the same vertex twice where a curve ends.
    pub(super) vertices: Vec<[VertexId; 2]>,
    /// The boundary half-edges along the rim's edge that begins at each node, by side. On side 0 it
    /// runs to the node, on side 1 from it. Null at the last node of an open curve.
    pub(super) rim: Vec<[HalfEdge; 2]>,
    /// Hit triangles and how their edges are to be joined, ascending.
    seams: Vec<Seam>,
    /// New half-edges along the edges of hit triangles, in the order of the edges.
    along: Vec<HalfEdge>,
    added: Vec<TriangleId>,
}

/// A hit triangle before the cut, and the half-edges of its parts.
#[derive(Debug, Clone)]
struct Seam {
    old: TriangleCorners,
    /// Half-edges of the neighbors.
    beyond: [HalfEdge; 3],
    piece: u32,
    material: u32,
    /// Range of the new half-edges along edge k: from entry k to entry k + 1.
    along: [usize; 4],
}

impl Sides {
    /// Adds the vertices of the nodes and replaces hit triangles by their parts.
    ///
    /// # Errors
    /// [`CutError::NotManifold`] if a part has a vertex twice: a tip or an end on a mesh edge.
    /// [`CutError::TipBlocked`] as of [`Splitter::split`].
    pub(super) fn open(
        &mut self,
        edit: &mut Edit<'_>,
        trace: &Trace,
        facets: &Facets,
        splitter: &mut Splitter,
    ) -> Result<(), CutError> {
        self.vertices.clear();
        let mut add =
            |node: &Node| add_vertex_between(edit, node.position, node.origin(), |mean| mean);
        for node in &trace.nodes {
            let first = match node.on {
                On::Tip(vertex) => vertex,
                _ => add(node),
            };
            let second = if node.is_end { first } else { add(node) };
            self.vertices.push([first, second]);
        }
        self.rim.clear();
        self.rim.resize(trace.nodes.len(), [HalfEdge::NULL; 2]);
        self.seams.clear();
        self.along.clear();
        // All before the first removal, which makes its neighbors boundaries.
        let hits = || trace.chords.chunk_by(|a, b| a.triangle == b.triangle);
        (self.seams).extend(hits().map(|chords| Seam::of(edit.surface(), chords[0].triangle)));
        let mut seams = std::mem::take(&mut self.seams);
        let replaced = hits().zip(&mut seams).try_for_each(|(chords, seam)| {
            let hit = Hit {
                vertices: seam.old.vertices,
                corners: edit.surface().triangle_positions(seam.old.triangle),
                beyond: seam.beyond,
                chords,
            };
            splitter.split(hit, &trace.nodes, facets)?;
            self.replace(edit, &trace.nodes, seam, &splitter.parts)
        });
        self.seams = seams;
        replaced?;
        self.join(edit);
        self.open_tips(edit, trace, facets);
        Ok(())
    }

    /// Separates the walls along the tip that the sweep continues.
    fn open_tips(&mut self, edit: &mut Edit<'_>, trace: &Trace, facets: &Facets) {
        for part in &facets.tip().parts {
            // A curve has the nodes of a part one after the other.
            let is_first = |node: &Node| node.on == On::Tip(part.vertices[0]);
            let Some(first) = trace.nodes.iter().position(is_first) else {
                continue;
            };
            for (i, &above) in (first..).zip(&part.half_edges) {
                // The walls below and above the sweep are on the sides of the same number.
                let below = edit.surface().topology().twin(above);
                edit.open_edge(above);
                self.rim[i] = [below, above];
            }
        }
        for (i, node) in trace.nodes.iter().enumerate() {
            let [below, above] = self.vertices[i];
            if !matches!(node.on, On::Tip(_)) || below == above {
                continue;
            }
            let mut at = self.rim[i][1];
            while !at.is_null() {
                edit.set_corner(at, above);
                at = edit.surface().topology().twin(at.prev());
            }
            if !self.rim[i][1].is_null() {
                continue;
            }
            // A curve ends at the tip of a sheet: its last half-edge above runs to the vertex.
            let mut at = self.rim[i - 1][1];
            while !at.is_null() {
                edit.set_corner(at.next(), above);
                at = edit.surface().topology().twin(at.next());
            }
        }
    }

    /// Replaces a hit triangle by its parts.
    fn replace(
        &mut self,
        edit: &mut Edit<'_>,
        nodes: &[Node],
        seam: &mut Seam,
        parts: &[Part],
    ) -> Result<(), CutError> {
        edit.remove_triangle(seam.old.triangle);
        let outer = |edge: usize| {
            let roles = parts.iter().flat_map(|part| part.edges);
            let is_own =
                |role: &EdgeRole| matches!(role, EdgeRole::Outer { edge: e, .. } if *e == edge);
            roles.filter(is_own).count()
        };
        seam.along[0] = self.along.len();
        for edge in 0..3 {
            seam.along[edge + 1] = seam.along[edge] + outer(edge);
        }
        self.along.resize(seam.along[3], HalfEdge::NULL);
        self.added.clear();
        for part in parts {
            let corners = part.corners.map(|corner| match corner {
                Corner::Old(k) => seam.old.vertices[k],
                Corner::Node { node, side } => self.vertices[node as usize][side],
            });
            check_corners(corners)?;
            let t = edit.add_triangle(corners, seam.piece, seam.material);
            self.added.push(t);
            if seam.old.is_plain() {
                continue;
            }
            for (h, corner) in t.half_edges().into_iter().zip(part.corners) {
                let weights = match corner {
                    Corner::Old(k) => [0, 1, 2].map(|i| if i == k { 1.0 } else { 0.0 }),
                    Corner::Node { node, .. } => nodes[node as usize].weights_in(seam.old.vertices),
                };
                seam.old.interpolate(edit, h, weights);
            }
        }
        for (t, part) in self.added.iter().zip(parts) {
            for (h, role) in t.half_edges().into_iter().zip(part.edges) {
                match role {
                    EdgeRole::Outer { edge, part } => self.along[seam.along[edge] + part] = h,
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
        Ok(())
    }

    /// Joins the parts to each other and to the triangles around.
    fn join(&self, edit: &mut Edit<'_>) {
        for seam in &self.seams {
            for (k, beyond) in seam.beyond.into_iter().enumerate() {
                if beyond.is_null() {
                    continue;
                }
                let along = &self.along[seam.along[k]..seam.along[k + 1]];
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
                let across = &self.seams[other].along;
                let across = &self.along[across[edge]..across[edge + 1]];
                for (&h, &twin) in along.iter().zip(across.iter().rev()) {
                    edit.set_twins(h, twin);
                }
            }
        }
    }
}

/// Checks that a new triangle has three vertices.
pub(super) fn check_corners([a, b, c]: [VertexId; 3]) -> Result<(), CutError> {
    if a == b || b == c || c == a {
        let vertex = if b == c { b } else { a };
        return Err(CutError::NotManifold { vertex });
    }
    Ok(())
}

impl Seam {
    fn of(surface: &Surface, triangle: TriangleId) -> Self {
        Self {
            old: TriangleCorners::new(surface, triangle),
            beyond: triangle.half_edges().map(|h| surface.topology().twin(h)),
            piece: surface.piece(triangle),
            material: surface.material(triangle),
            along: [0; 4],
        }
    }
}
