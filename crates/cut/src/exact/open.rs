//! Hit triangles out, their parts in: the surface open along the curves, with two lips.

use super::node::Node;
use super::split::{Corner, Part, Side, Splitter};
use super::trace::Trace;
use incise_mesh::geometry::round;
use incise_mesh::{Edit, HalfEdge, Surface, TriangleId, VertexId};

/// The two lips. Lip 0 is below the sweep, lip 1 above it.
#[derive(Debug, Clone, Default)]
pub(crate) struct Lips {
    /// The vertices of each node, by lip.
    pub(super) vertices: Vec<[VertexId; 2]>,
    /// The boundary half-edges along the rim's edge that begins at each node, by lip. On lip 0 it
    /// runs to the node, on lip 1 from it.
    pub(super) rim: Vec<[HalfEdge; 2]>,
    /// Hit triangles and how their edges are to be joined, ascending.
    seams: Vec<Seam>,
    added: Vec<TriangleId>,
}

/// A hit triangle as it was, and what took its place.
#[derive(Debug, Clone, Copy)]
struct Seam {
    triangle: TriangleId,
    corners: [VertexId; 3],
    /// The neighbors' half-edges.
    beyond: [HalfEdge; 3],
    piece: u32,
    material: u32,
    uv: Option<[[f32; 2]; 3]>,
    normal: Option<[[f32; 3]; 3]>,
    /// New half-edges along each edge, in order; null where there are fewer.
    along: [[HalfEdge; 3]; 3],
}

impl Lips {
    /// Makes two vertices a node and replaces hit triangles by their parts.
    pub(super) fn open(
        &mut self,
        edit: &mut Edit<'_>,
        trace: &Trace,
        is_valley: bool,
        splitter: &mut Splitter,
    ) {
        self.vertices.clear();
        for node in &trace.nodes {
            let vertex = [0, 1].map(|_| add_vertex(edit, node));
            self.vertices.push(vertex);
        }
        self.rim.clear();
        self.rim.resize(trace.nodes.len(), [HalfEdge::NULL; 2]);
        self.seams.clear();
        // All of them before the first goes, which leaves its neighbors open.
        let hits = || trace.chords.chunk_by(|a, b| a.triangle == b.triangle);
        (self.seams).extend(hits().map(|chords| Seam::of(edit.surface(), chords[0].triangle)));
        for (i, chords) in hits().enumerate() {
            let mut seam = self.seams[i];
            let corners = edit.surface().triangle_positions(seam.triangle);
            splitter.split(corners, seam.beyond, &trace.nodes, is_valley, chords);
            self.replace(edit, &trace.nodes, &mut seam, &splitter.parts);
            self.seams[i] = seam;
        }
        self.join(edit);
    }

    /// Puts the parts in the place of a hit triangle.
    fn replace(&mut self, edit: &mut Edit<'_>, nodes: &[Node], seam: &mut Seam, parts: &[Part]) {
        edit.remove_triangle(seam.triangle);
        self.added.clear();
        for part in parts {
            let corners = part.corners.map(|corner| match corner {
                Corner::Old(k) => seam.corners[k],
                Corner::Node { node, lip } => self.vertices[node as usize][lip],
            });
            let t = edit.add_triangle(corners, seam.piece, seam.material);
            self.added.push(t);
            if seam.is_plain() {
                continue;
            }
            for (h, corner) in t.half_edges().into_iter().zip(part.corners) {
                let weights = match corner {
                    Corner::Old(k) => [0, 1, 2].map(|i| if i == k { 1.0 } else { 0.0 }),
                    Corner::Node { node, .. } => nodes[node as usize].weights_in(seam.corners),
                };
                seam.interpolate(edit, h, weights);
            }
        }
        for (t, part) in self.added.iter().zip(parts) {
            for (h, side) in t.half_edges().into_iter().zip(part.sides) {
                match side {
                    Side::Outer { edge, part } => seam.along[edge][part] = h,
                    Side::Rim { node, lip } => self.rim[node as usize][lip] = h,
                    Side::Inner { other, side } => {
                        let twin = self.added[other].half_edges()[side];
                        if h < twin {
                            edit.join(h, twin);
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
                    .binary_search_by_key(&beyond.triangle(), |s| s.triangle);
                let Ok(other) = other else {
                    edit.join(along[0], beyond);
                    continue;
                };
                if beyond.triangle() < seam.triangle {
                    continue;
                }
                let [first, ..] = beyond.triangle().half_edges();
                let edge = beyond.index() - first.index();
                let across = self.seams[other].along[edge];
                let parts = along.iter().filter(|h| !h.is_null()).count();
                for part in 0..parts {
                    edit.join(along[part], across[parts - 1 - part]);
                }
            }
        }
    }
}

impl Seam {
    fn of(surface: &Surface, triangle: TriangleId) -> Self {
        let half_edges = triangle.half_edges();
        let attributes = &surface.corners;
        Self {
            triangle,
            corners: surface.topology().triangle(triangle),
            beyond: half_edges.map(|h| surface.topology().twin(h)),
            piece: surface.piece(triangle),
            material: surface.material(triangle),
            uv: (!attributes.uv.is_empty()).then(|| half_edges.map(|h| attributes.uv[h.index()])),
            normal: (!attributes.normal.is_empty())
                .then(|| half_edges.map(|h| attributes.normal[h.index()])),
            along: [[HalfEdge::NULL; 3]; 3],
        }
    }

    /// Whether corners have nothing but their vertices.
    fn is_plain(&self) -> bool {
        self.uv.is_none() && self.normal.is_none()
    }

    /// Gives a corner of a part what the triangle's corners have, by `weights`.
    fn interpolate(&self, edit: &mut Edit<'_>, h: HalfEdge, weights: [f32; 3]) {
        if let Some(uv) = self.uv {
            edit.set_uv(h, blend(uv, weights));
        }
        if let Some(normal) = self.normal {
            edit.set_normal(h, blend(normal, weights));
        }
    }
}

/// The weighted sum; exactly one of the values where its weight is 1.
fn blend<const N: usize>(values: [[f32; N]; 3], weights: [f32; 3]) -> [f32; N] {
    if let Some(k) = weights.iter().position(|&w| w == 1.0) {
        return values[k];
    }
    std::array::from_fn(|i| (0..3).map(|k| weights[k] * values[k][i]).sum())
}

fn add_vertex(edit: &mut Edit<'_>, node: &Node) -> VertexId {
    let origin = node.origin();
    let surface = edit.surface();
    let rest = origin.interpolate(|v| surface.rest[v.index()]);
    let [w] = origin.interpolate(|v| [surface.positions[v.index()][3]]);
    let [x, y, z] = round(node.position);
    let [w, ..] = round([w, 0.0, 0.0].into());
    edit.add_vertex([x, y, z, w], round(rest.into()), origin)
}
