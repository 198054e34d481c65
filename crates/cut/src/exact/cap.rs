//! Both lips closed by the same triangles, one the mirror image of the other.

use super::node::Node;
use super::open::Lips;
use super::rim::Rim;
use super::unfold::Unfold;
use incise_mesh::geometry::round;
use incise_mesh::{Edit, HalfEdge, Origin, Surface, Topology, TriangleId, VertexId};
use incise_refine::{Cover, CoverParams, CoverScratch, RefineError, Section, cover};

/// The cross-section and its cover.
#[derive(Debug, Clone, Default)]
pub(crate) struct Cap {
    /// The node of each point of the section.
    nodes: Vec<u32>,
    points: Vec<[f64; 2]>,
    loops: Vec<Vec<u32>>,
    scratch: CoverScratch,
    /// By lip, the vertices of the cover's points and the triangles of its triangles.
    vertices: [Vec<VertexId>; 2],
    pub(super) triangles: [Vec<TriangleId>; 2],
}

/// What closing needs to know of the cut.
pub(super) struct Rims<'a> {
    pub(super) nodes: &'a [Node],
    pub(super) lips: &'a Lips,
    pub(super) rim: &'a Rim,
    pub(super) unfold: &'a Unfold,
    pub(super) has_crease: bool,
}

impl Cap {
    /// Lays the rim's loops flat.
    pub(super) fn flatten(&mut self, rims: &Rims<'_>) {
        self.nodes.clear();
        self.points.clear();
        self.loops.resize(rims.rim.sizes.len(), Vec::new());
        for (i, points) in self.loops.iter_mut().enumerate() {
            points.clear();
            for node in rims.rim.ring(i) {
                points.push(u32::try_from(self.nodes.len()).expect("nodes have 32-bit ids"));
                self.nodes.push(node);
                self.points
                    .push(rims.unfold.flatten(&rims.nodes[node as usize]));
            }
        }
    }

    /// Whether a loop runs around nothing of the section, as the rim of a cavity does in which a
    /// sweep without an end on the surface ends.
    pub(super) fn has_loose_hole(&self) -> bool {
        let outline = |i: usize| self.loops[i].iter().map(|&p| self.points[p as usize]);
        (0..self.loops.len()).any(|i| {
            if doubled_area(outline(i)) >= 0.0 {
                return false;
            }
            let inside = self.points[self.loops[i][0] as usize];
            let others = (0..self.loops.len()).filter(|&j| j != i);
            others.map(|j| winding(outline(j), inside)).sum::<i32>() <= 0
        })
    }

    /// Covers the section.
    ///
    /// # Errors
    /// As [`cover`].
    pub(super) fn cover(
        &mut self,
        rims: &Rims<'_>,
        topology: &Topology,
        params: &CoverParams,
    ) -> Result<Cover, RefineError> {
        let section = Section {
            points: &self.points,
            loops: &self.loops,
            crease: rims.has_crease,
        };
        let joined = |a: u32, b: u32| {
            let [a, b] = [a, b].map(|p| self.nodes[p as usize]);
            (0..2).any(|lip| {
                let vertex = rims.lips.vertices[b as usize][lip];
                let mut fan = rims.rim.fan(topology, rims.lips, a, lip);
                fan.any(|h| topology.target(h) == vertex || topology.origin(h.prev()) == vertex)
            })
        };
        cover(&section, params, joined, &mut self.scratch)
    }

    /// Closes both lips with the cover.
    pub(super) fn close(
        &mut self,
        edit: &mut Edit<'_>,
        rims: &Rims<'_>,
        cover: &Cover,
        material: u32,
    ) {
        let twins = twins_of(&cover.triangles, self.points.len() + cover.inner.len());
        let pieces = self.pieces(edit.surface(), rims, cover, &twins);
        for lip in 0..2 {
            self.add_vertices(edit, rims, cover, lip);
            self.triangles[lip].clear();
            for (triangle, &piece) in cover.triangles.iter().zip(&pieces) {
                let [a, b, c] = triangle.map(|p| self.vertices[lip][p as usize]);
                let corners = if lip == 0 { [a, b, c] } else { [a, c, b] };
                self.triangles[lip].push(edit.add_triangle(corners, piece, material));
            }
            self.join(edit, &twins, lip);
            self.join_rim(edit, rims, cover, &twins, lip);
            self.dress(edit, rims, cover, lip);
        }
    }

    /// The piece of each triangle of the cover: of the rim's, the first where several meet.
    fn pieces(
        &self,
        surface: &Surface,
        rims: &Rims<'_>,
        cover: &Cover,
        twins: &[usize],
    ) -> Vec<u32> {
        let mut pieces = vec![u32::MAX; cover.triangles.len()];
        let mut connected = Vec::new();
        for seed in 0..cover.triangles.len() {
            if pieces[seed] != u32::MAX {
                continue;
            }
            let mut least = u32::MAX;
            connected.clear();
            connected.push(seed);
            // Any number but none, so that it is not found again.
            pieces[seed] = 0;
            let mut at = 0;
            while at < connected.len() {
                for h in 3 * connected[at]..3 * connected[at] + 3 {
                    if twins[h] == usize::MAX {
                        let node = self.nodes[cover.triangles[h / 3][h % 3] as usize];
                        let wall = rims.lips.rim[node as usize][0].triangle();
                        least = least.min(surface.piece(wall));
                    } else if pieces[twins[h] / 3] == u32::MAX {
                        pieces[twins[h] / 3] = 0;
                        connected.push(twins[h] / 3);
                    }
                }
                at += 1;
            }
            for &t in &connected {
                pieces[t] = least;
            }
        }
        pieces
    }

    fn add_vertices(&mut self, edit: &mut Edit<'_>, rims: &Rims<'_>, cover: &Cover, lip: usize) {
        let vertices = &mut self.vertices[lip];
        vertices.clear();
        let own = self
            .nodes
            .iter()
            .map(|&n| rims.lips.vertices[n as usize][lip]);
        vertices.extend(own);
        for inner in &cover.inner {
            let parents = inner.parents.map(|p| vertices[p as usize]);
            let weights = inner.weights.map(|w| round([w, 0.0, 0.0].into())[0]);
            let origin = Origin::OnCap { parents, weights };
            let surface = edit.surface();
            let rest = origin.interpolate(|v| surface.rest[v.index()]);
            let [w] = origin.interpolate(|v| [surface.positions[v.index()][3]]);
            let [x, y, z] = round(rims.unfold.lift(inner.at).0);
            let [w, ..] = round([w, 0.0, 0.0].into());
            vertices.push(edit.add_vertex([x, y, z, w], round(rest.into()), origin));
        }
    }

    /// The half-edge of a lip that stands for half-edge `h` of the cover.
    fn half_edge(&self, h: usize, lip: usize) -> HalfEdge {
        let half_edges = self.triangles[lip][h / 3].half_edges();
        // Mirrored, corners stand in the order 0, 2, 1: its side from 0 to 1 is the last, from 1 to 2
        // the middle one.
        half_edges[if lip == 0 { h % 3 } else { 2 - h % 3 }]
    }

    fn join(&self, edit: &mut Edit<'_>, twins: &[usize], lip: usize) {
        for (h, &twin) in twins.iter().enumerate() {
            if twin != usize::MAX && h < twin {
                edit.join(self.half_edge(h, lip), self.half_edge(twin, lip));
            }
        }
    }

    fn join_rim(
        &self,
        edit: &mut Edit<'_>,
        rims: &Rims<'_>,
        cover: &Cover,
        twins: &[usize],
        lip: usize,
    ) {
        for h in (0..twins.len()).filter(|&h| twins[h] == usize::MAX) {
            let point = cover.triangles[h / 3][h % 3];
            let node = self.nodes[point as usize];
            edit.join(self.half_edge(h, lip), rims.lips.rim[node as usize][lip]);
        }
    }

    /// Texture coordinates are those of the sweep laid flat \[m\], normals the sweep's.
    fn dress(&self, edit: &mut Edit<'_>, rims: &Rims<'_>, cover: &Cover, lip: usize) {
        let attributes = &edit.surface().corners;
        if attributes.uv.is_empty() && attributes.normal.is_empty() {
            return;
        }
        for h in 0..3 * cover.triangles.len() {
            let point = cover.triangles[h / 3][h % 3] as usize;
            let at = match point.checked_sub(self.points.len()) {
                Some(inner) => cover.inner[inner].at,
                None => self.points[point],
            };
            let corner = self.triangles[lip][h / 3].half_edges();
            let corner = corner[if lip == 0 { h % 3 } else { (3 - h % 3) % 3 }];
            let [u, v] = at;
            let [u, v, _] = round([u, v, 0.0].into());
            edit.set_uv(corner, [u, v]);
            let normal = rims.unfold.lift(at).1;
            edit.set_normal(corner, round(if lip == 0 { normal } else { -normal }));
        }
    }
}

/// The half-edge across each half-edge 3t + i of triangles over `count` points; `usize::MAX` at the rim.
fn twins_of(triangles: &[[u32; 3]], count: usize) -> Vec<usize> {
    let ends = |h: usize| [h % 3, (h + 1) % 3].map(|i| triangles[h / 3][i]);
    let mut twins = vec![usize::MAX; 3 * triangles.len()];
    // The half-edges that leave each point, chained.
    let mut first = vec![usize::MAX; count];
    let mut following = vec![usize::MAX; 3 * triangles.len()];
    for h in 0..twins.len() {
        let [from, to] = ends(h);
        following[h] = std::mem::replace(&mut first[from as usize], h);
        let mut back = first[to as usize];
        while back != usize::MAX && ends(back)[1] != from {
            back = following[back];
        }
        if back != usize::MAX {
            twins[h] = back;
            twins[back] = h;
        }
    }
    twins
}

fn doubled_area(outline: impl Iterator<Item = [f64; 2]> + Clone) -> f64 {
    let following = outline.clone().cycle().skip(1);
    (outline.zip(following))
        .map(|([ax, ay], [bx, by])| ax * by - ay * bx)
        .sum()
}

/// How often a closed outline runs around a point, counterclockwise.
fn winding(outline: impl Iterator<Item = [f64; 2]> + Clone, [x, y]: [f64; 2]) -> i32 {
    let following = outline.clone().cycle().skip(1);
    (outline.zip(following))
        .map(|([ax, ay], [bx, by])| {
            let left = (bx - ax) * (y - ay) - (by - ay) * (x - ax);
            if ay <= y && by > y && left > 0.0 {
                1
            } else if ay > y && by <= y && left < 0.0 {
                -1
            } else {
                0
            }
        })
        .sum()
}
