//! Closes both sides with the same meshes of the sections, one the mirror image of the other.

mod attributes;

use super::open::{Sides, check_corners};
use super::rest::{CapRest, add_vertex_between};
use super::section::{BoundaryEdge, CrossSection, FacetSection, Rims};
use crate::error::CutError;
use crate::params::CutParams;
use incise_mesh::geometry::round_to_f32;
use incise_mesh::{
    Edit, HalfEdge, Surface, Topology, TriangleId, VertexId, VertexOrigin, index_u32,
};
use incise_refine::{RefineError, RefineParams, SectionMesh};

/// Caps and walls of a cut: meshes of the sections, used for both sides.
#[derive(Debug, Clone, Default)]
pub(crate) struct Cap {
    pub(super) section: CrossSection,
    /// The meshes of the sections.
    meshes: Vec<SectionMesh>,
    /// By section and triangle, a node of the part of the section that it belongs to.
    parts: Vec<Vec<u32>>,
    rest: CapRest,
    /// By side, the vertex of each point of a mesh.
    vertices: [Vec<VertexId>; 2],
    /// Vertices, piece and twins of the triangles of a side.
    corners: Vec<[VertexId; 3]>,
    pieces: Vec<u32>,
    twins: Vec<u32>,
    /// First half-edge that leaves each point, and the next half-edge with its target.
    first: Vec<u32>,
    following: Vec<(u32, u32)>,
    /// Texture coordinates of each point of a mesh; empty without any on the surface.
    uvs: Vec<[f32; 2]>,
    /// By chain segment and side, a half-edge that waits for its twin.
    segments: Vec<[HalfEdge; 2]>,
    /// Union-find forests: over the points of a mesh, and over all nodes.
    point_parents: Vec<u32>,
    node_parents: Vec<u32>,
    /// First curve of each curve's group.
    groups: Vec<usize>,
    /// By curve, whether its two sides join at a tip or at an end.
    has_tip: Vec<bool>,
    /// New triangles by side.
    pub(super) triangles: [Vec<TriangleId>; 2],
    added: Vec<TriangleId>,
}

impl Cap {
    /// Triangulates all sections, see [`CrossSection::triangulate`], and groups the curves.
    ///
    /// Returns whether the sections reached their target lengths.
    ///
    /// # Errors
    /// As [`CrossSection::triangulate`].
    pub(super) fn triangulate(
        &mut self,
        rims: &Rims<'_>,
        topology: &Topology,
        refine: &RefineParams,
        is_refined: bool,
    ) -> Result<bool, RefineError> {
        self.meshes.clear();
        let mut has_converged = true;
        for i in 0..self.section.sections().len() {
            let mesh = (self.section).triangulate(i, rims, topology, refine, is_refined)?;
            // A disc has no inner points.
            has_converged &= mesh.report.self_intersecting_loops == 0;
            self.meshes.push(mesh);
        }
        self.group_curves(rims);
        Ok(has_converged)
    }

    /// Returns the first curve of each curve's group, whose caps are connected.
    pub(super) fn groups(&self) -> &[usize] {
        &self.groups
    }

    /// Groups the curves that the meshes of the sections connect.
    fn group_curves(&mut self, rims: &Rims<'_>) {
        let count = index_u32(rims.sides.vertices.len());
        self.node_parents.clear();
        self.node_parents.extend(0..count);
        self.parts.resize(self.meshes.len(), Vec::new());
        for (i, section) in self.section.sections().iter().enumerate() {
            self.parts[i].clear();
            for points in &section.loops {
                let first = section.nodes[points[0] as usize];
                for &point in points {
                    join(&mut self.node_parents, first, section.nodes[point as usize]);
                }
            }
            let triangles = &self.meshes[i].triangles;
            if section.loops.len() == 1 {
                let node = section.nodes[0];
                self.parts[i].resize(triangles.len(), node);
                continue;
            }
            let points = section.points.len() + self.meshes[i].steiner_points.len();
            self.point_parents.clear();
            self.point_parents.extend(0..index_u32(points));
            for &[a, b, c] in triangles {
                join(&mut self.point_parents, a, b);
                join(&mut self.point_parents, a, c);
            }
            for (point, &node) in (0..).zip(&section.nodes) {
                let root = find(&mut self.point_parents, point);
                let first = section.nodes[root as usize];
                join(&mut self.node_parents, first, node);
            }
            for &[a, ..] in triangles {
                let root = find(&mut self.point_parents, a);
                self.parts[i].push(section.nodes[root as usize]);
            }
        }
        // Curves whose nodes are all crossings of facets have no loop of their own.
        for curve in 0..rims.rim.sizes.len() {
            let first = rims.rim.first[curve];
            for node in rims.rim.ring(curve) {
                join(&mut self.node_parents, first, node);
            }
        }
        self.number_groups(rims);
    }

    /// Numbers the groups, and marks those with a tip.
    fn number_groups(&mut self, rims: &Rims<'_>) {
        let mut first_curve = vec![usize::MAX; self.node_parents.len()];
        self.groups.clear();
        for (i, &node) in rims.rim.first.iter().enumerate() {
            let root = find(&mut self.node_parents, node) as usize;
            if first_curve[root] == usize::MAX {
                first_curve[root] = i;
            }
            self.groups.push(first_curve[root]);
        }
        self.has_tip.clear();
        self.has_tip.resize(self.groups.len(), false);
        for chain in rims.chains.chains.iter().filter(|chain| chain.is_tip) {
            let node = rims.chains.nodes[chain.nodes.start];
            let curve = first_curve[find(&mut self.node_parents, node) as usize];
            if let Some(has_tip) = self.has_tip.get_mut(curve) {
                *has_tip = true;
            }
        }
        // Where a curve ends in a sheet, its sides meet.
        for (&i, curve) in self.groups.iter().zip(rims.curves) {
            let ends = [curve.nodes.start, curve.nodes.end - 1];
            self.has_tip[i] |= ends.iter().any(|&end| rims.nodes[end as usize].is_end);
        }
    }

    /// Returns pairs of numbers of sides that caps or tips connect: 2 i below curve i, 2 i + 1
    /// above it.
    pub(super) fn joined(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        let groups = || self.groups.iter().copied().enumerate();
        let caps = groups().filter(|&(i, first)| i != first);
        let caps = caps.flat_map(|(i, j)| [(2 * i, 2 * j), (2 * i + 1, 2 * j + 1)]);
        let tips = groups().filter(|&(i, first)| i == first && self.has_tip[i]);
        caps.chain(tips.map(|(i, _)| (2 * i, 2 * i + 1)))
    }

    /// Closes both sides with the meshes of the sections. Caps belong to the pieces of their sides.
    /// Where a curve has two edges, each is the twin of the other.
    ///
    /// # Errors
    /// [`CutError::NotManifold`] if a cap would have a vertex twice.
    pub(super) fn close(
        &mut self,
        edit: &mut Edit<'_>,
        rims: &Rims<'_>,
        params: &CutParams,
    ) -> Result<(), CutError> {
        self.triangles.iter_mut().for_each(Vec::clear);
        self.segments.clear();
        (self.segments).resize(rims.chains.nodes.len(), [HalfEdge::NULL; 2]);
        self.uvs.clear();
        let meshes = std::mem::take(&mut self.meshes);
        for (i, mesh) in meshes.iter().enumerate() {
            self.find_twins(self.section.sections()[i].points.len(), mesh);
            let section = &self.section.sections()[i];
            let vertices = section.nodes.iter();
            let vertices = vertices.map(|&n| rims.sides.vertices[n as usize][0]);
            (self.rest).find(edit.surface(), vertices, mesh, &section.section());
            if !edit.surface().corner_uvs().is_empty() {
                self.find_uvs(rims.frames, i, mesh, params.cap_uv_scale);
            }
            for side in 0..2 {
                self.add_vertices(edit, rims, i, mesh, side);
                self.find_pieces(edit.surface(), rims, i, side);
                let vertices = &self.vertices[side];
                self.corners.clear();
                self.corners.extend(mesh.triangles.iter().map(|triangle| {
                    let [a, b, c] = triangle.map(|p| vertices[p as usize]);
                    if side == 0 { [a, b, c] } else { [a, c, b] }
                }));
                self.corners.iter().copied().try_for_each(check_corners)?;
                if side == 1 {
                    self.mirror_twins();
                }
                self.added.clear();
                edit.add_patch(
                    &self.corners,
                    &self.twins,
                    &self.pieces,
                    params.cap_material,
                    &mut self.added,
                );
                self.join_boundary(edit, rims.sides, i, mesh, side);
                self.set_attributes(edit, rims.frames, i, mesh, side);
                self.triangles[side].extend_from_slice(&self.added);
            }
        }
        self.meshes = meshes;
        for &[a, b] in self.section.flat_curves() {
            for side in 0..2 {
                let [first, second] = [a, b].map(|node| rims.sides.rim[node as usize][side]);
                edit.set_twins(first, second);
            }
        }
        for triangles in &self.triangles {
            edit.inherit_corner_channels(triangles);
        }
        Ok(())
    }

    /// Finds the piece of each triangle of section `i` on a side.
    fn find_pieces(&mut self, surface: &Surface, rims: &Rims<'_>, i: usize, side: usize) {
        self.pieces.clear();
        let mut last = (u32::MAX, 0);
        for &node in &self.parts[i] {
            if last.0 != node {
                let root = find(&mut self.node_parents, node);
                let mut firsts = rims.rim.first.iter();
                let parents = &mut self.node_parents;
                let curve = firsts.find(|&&first| find(parents, first) == root);
                let along = *curve.expect("a section has a curve on its boundary");
                let triangle = rims.sides.rim[along as usize][side].triangle();
                last = (node, surface.piece(triangle));
            }
            self.pieces.push(last.1);
        }
    }

    fn add_vertices(
        &mut self,
        edit: &mut Edit<'_>,
        rims: &Rims<'_>,
        i: usize,
        mesh: &SectionMesh,
        side: usize,
    ) {
        let section = &self.section.sections()[i];
        let vertices = &mut self.vertices[side];
        vertices.clear();
        let own = section.nodes.iter();
        vertices.extend(own.map(|&n| rims.sides.vertices[n as usize][side]));
        for (k, inner) in mesh.steiner_points.iter().enumerate() {
            let parents = inner.parents.map(|p| vertices[p as usize]);
            let weights = inner.weights.map(round_to_f32);
            let origin = VertexOrigin::OnCap { parents, weights };
            let local = section.uncentered(inner.position);
            let position = rims.frames.lift(section.facet, local);
            let rest = |mean| self.rest.position(k, mean);
            vertices.push(add_vertex_between(edit, position, origin, rest));
        }
    }

    /// Joins the boundary of a side to the rim, to the sections beside it and, at tips, to the
    /// other side.
    fn join_boundary(
        &mut self,
        edit: &mut Edit<'_>,
        sides: &Sides,
        i: usize,
        mesh: &SectionMesh,
        side: usize,
    ) {
        for (t, triangle) in mesh.triangles.iter().enumerate() {
            for (k, &point) in triangle.iter().enumerate() {
                let own = if side == 0 { k } else { 2 - k };
                if self.twins[3 * t + own] == u32::MAX {
                    let h = self.added[t].half_edges()[own];
                    let along = self.section.sections()[i].boundary[point as usize];
                    self.join_half_edge(edit, sides, along, h, side);
                }
            }
        }
    }

    /// Joins a half-edge of a boundary to its twin, or lets it wait for that.
    fn join_half_edge(
        &mut self,
        edit: &mut Edit<'_>,
        sides: &Sides,
        along: BoundaryEdge,
        h: HalfEdge,
        side: usize,
    ) {
        let (segment, place) = match along {
            BoundaryEdge::Rim(node) => {
                edit.set_twins(h, sides.rim[node as usize][side]);
                return;
            }
            BoundaryEdge::Chain { segment, is_tip } => (segment, if is_tip { 0 } else { side }),
        };
        let waiting = &mut self.segments[segment][place];
        if waiting.is_null() {
            *waiting = h;
        } else {
            edit.set_twins(h, *waiting);
        }
    }

    /// Finds the twin of each half-edge 3 t + k of the mesh.
    fn find_twins(&mut self, points: usize, mesh: &SectionMesh) {
        self.twins.clear();
        self.twins.resize(3 * mesh.triangles.len(), u32::MAX);
        // The half-edges that leave each point, chained.
        self.first.clear();
        (self.first).resize(points + mesh.steiner_points.len(), u32::MAX);
        self.following.clear();
        let mut h = 0;
        for &[a, b, c] in &mesh.triangles {
            for [from, to] in [[a, b], [b, c], [c, a]] {
                let mut back = self.first[to as usize];
                while let Some(&(next, target)) = self.following.get(back as usize) {
                    if target == from {
                        break;
                    }
                    back = next;
                }
                if back != u32::MAX {
                    self.twins[h as usize] = back;
                    self.twins[back as usize] = h;
                }
                let first = &mut self.first[from as usize];
                self.following.push((std::mem::replace(first, h), to));
                h += 1;
            }
        }
    }

    /// Turns the twins into those of the mirror image.
    ///
    /// There corners stand in the order 0, 2, 1: the edge from 0 to 1 is the last, the one from 1
    /// to 2 the middle one.
    fn mirror_twins(&mut self) {
        for twins in self.twins.chunks_exact_mut(3) {
            twins.swap(0, 2);
            for twin in twins.iter_mut().filter(|twin| **twin != u32::MAX) {
                *twin = *twin / 3 * 3 + (2 - *twin % 3);
            }
        }
    }
}

impl FacetSection {
    /// Returns the coordinates in the facet's plane of a point of the section \[m\].
    fn uncentered(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [x + self.center[0], y + self.center[1]]
    }
}

/// Joins two sets of a union-find forest. The smaller root remains.
fn join(parents: &mut [u32], a: u32, b: u32) {
    let (a, b) = (find(parents, a), find(parents, b));
    parents[a.max(b) as usize] = a.min(b);
}

/// Returns the root of `i` in a union-find forest.
fn find(parents: &mut [u32], mut i: u32) -> u32 {
    while parents[i as usize] != i {
        let next = parents[parents[i as usize] as usize];
        parents[i as usize] = next;
        i = next;
    }
    i
}
