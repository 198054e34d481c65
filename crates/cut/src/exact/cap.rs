//! Closes both sides with the same mesh of the cross-section, one the mirror image of the other.

use super::open::Sides;
use super::rest::CapRest;
use super::rim::Rim;
use super::section::CrossSection;
use super::unfold::Unfold;
use crate::intersection::node::Node;
use incise_mesh::geometry::{round_to_f32, to_f32};
use incise_mesh::{Edit, Surface, Topology, TriangleId, VertexId, VertexOrigin, index_u32};
use incise_refine::{RefineError, RefineParams, SectionMesh};

/// Caps of a cut: one mesh of the cross-section, used for both sides.
#[derive(Debug, Clone, Default)]
pub(crate) struct Cap {
    pub(super) section: CrossSection,
    rest: CapRest,
    /// By side, the vertex of each point of the mesh.
    vertices: [Vec<VertexId>; 2],
    /// Vertices, piece and twins of the triangles of a side.
    corners: Vec<[VertexId; 3]>,
    pieces: Vec<u32>,
    twins: Vec<u32>,
    /// First half-edge that leaves each point, and the next half-edge with its target.
    first: Vec<u32>,
    following: Vec<(u32, u32)>,
    /// Union-find forest over the points.
    parents: Vec<u32>,
    /// First loop of each loop's group.
    groups: Vec<usize>,
    /// New triangles by side.
    pub(super) triangles: [Vec<TriangleId>; 2],
}

/// Rims of the opened surface, and the plane of their cross-section.
pub(super) struct Rims<'a> {
    pub(super) nodes: &'a [Node],
    pub(super) sides: &'a Sides,
    pub(super) rim: &'a Rim,
    pub(super) unfold: &'a Unfold,
    pub(super) has_crease: bool,
}

impl Cap {
    /// Groups the loops whose caps would be joined; returns the first loop of each loop's group.
    ///
    /// # Errors
    /// As [`CrossSection::triangulate`].
    pub(super) fn groups(
        &mut self,
        rims: &Rims<'_>,
        topology: &Topology,
        refine: &RefineParams,
    ) -> Result<Vec<usize>, RefineError> {
        // Groups depend on the loops alone, so a mesh without new points is enough.
        let mesh = self.section.triangulate(rims, topology, refine, false)?;
        self.group_loops(&mesh);
        Ok(self.groups.clone())
    }

    /// Returns the groups of the last [`Self::group_loops`].
    pub(super) fn last_groups(&self) -> &[usize] {
        &self.groups
    }

    /// Groups the loops that a mesh of the section connects.
    pub(super) fn group_loops(&mut self, mesh: &SectionMesh) {
        self.groups.clear();
        self.groups.extend(0..self.section.loops.len());
        if self.section.loops.len() == 1 {
            return;
        }
        // Union-find over points; the smallest point is the root.
        self.parents.clear();
        let count = index_u32(self.section.points.len() + mesh.steiner_points.len());
        self.parents.extend(0..count);
        for &[a, b, c] in &mesh.triangles {
            let a = find(&mut self.parents, a);
            let b = find(&mut self.parents, b);
            let c = find(&mut self.parents, c);
            let least = a.min(b).min(c);
            for root in [a, b, c] {
                self.parents[root as usize] = least;
            }
        }
        let mut first_loop = vec![usize::MAX; self.section.points.len()];
        for (i, points) in self.section.loops.iter().enumerate() {
            let root = find(&mut self.parents, points[0]) as usize;
            if first_loop[root] == usize::MAX {
                first_loop[root] = i;
            }
            self.groups[i] = first_loop[root];
        }
    }

    /// Returns each loop that is in the group of an earlier loop, with that loop.
    pub(super) fn joined(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        (self.groups.iter().copied().enumerate()).filter(|&(i, first)| i != first)
    }

    /// Closes both sides with a mesh of the section. Caps belong to the pieces of their sides.
    pub(super) fn close(
        &mut self,
        edit: &mut Edit<'_>,
        rims: &Rims<'_>,
        mesh: &SectionMesh,
        material: u32,
    ) {
        self.find_twins(mesh);
        let vertices = self.section.nodes.iter();
        let vertices = vertices.map(|&n| rims.sides.vertices[n as usize][0]);
        let section = self.section.section();
        self.rest.find(edit.surface(), vertices, mesh, &section);
        for side in 0..2 {
            self.add_vertices(edit, rims, mesh, side);
            self.find_pieces(edit.surface(), rims, mesh, side);
            let vertices = &self.vertices[side];
            self.corners.clear();
            self.corners.extend(mesh.triangles.iter().map(|triangle| {
                let [a, b, c] = triangle.map(|p| vertices[p as usize]);
                if side == 0 { [a, b, c] } else { [a, c, b] }
            }));
            if side == 1 {
                self.mirror_twins();
            }
            self.triangles[side].clear();
            edit.add_patch(
                &self.corners,
                &self.twins,
                &self.pieces,
                material,
                &mut self.triangles[side],
            );
            self.join_rim(edit, rims, mesh, side);
            self.set_attributes(edit, rims, mesh, side);
        }
    }

    /// Finds the piece of each triangle of the mesh on a side.
    fn find_pieces(&mut self, surface: &Surface, rims: &Rims<'_>, mesh: &SectionMesh, side: usize) {
        let first = |i: usize| rims.rim.first[i] as usize;
        let piece = |i: usize| surface.piece(rims.sides.rim[first(i)][side].triangle());
        self.pieces.clear();
        if self.section.loops.len() == 1 {
            self.pieces.resize(mesh.triangles.len(), piece(0));
            return;
        }
        let mut of_root = vec![0; self.section.points.len()];
        for (i, points) in self.section.loops.iter().enumerate() {
            of_root[find(&mut self.parents, points[0]) as usize] = piece(i);
        }
        for &[a, ..] in &mesh.triangles {
            let root = find(&mut self.parents, a);
            self.pieces.push(of_root[root as usize]);
        }
    }

    fn add_vertices(
        &mut self,
        edit: &mut Edit<'_>,
        rims: &Rims<'_>,
        mesh: &SectionMesh,
        side: usize,
    ) {
        let vertices = &mut self.vertices[side];
        vertices.clear();
        let own = self
            .section
            .nodes
            .iter()
            .map(|&n| rims.sides.vertices[n as usize][side]);
        vertices.extend(own);
        for (i, inner) in mesh.steiner_points.iter().enumerate() {
            let parents = inner.parents.map(|p| vertices[p as usize]);
            let weights = inner.weights.map(round_to_f32);
            let origin = VertexOrigin::OnCap { parents, weights };
            let surface = edit.surface();
            let mean = origin.interpolate(|v| surface.rest_positions()[v.index()]);
            let rest = self.rest.position(i, to_f32(mean.into()));
            let [w] = origin.interpolate(|v| [surface.positions()[v.index()][3]]);
            let [x, y, z] = to_f32(rims.unfold.lift(inner.position).0);
            let position = [x, y, z, round_to_f32(w)];
            vertices.push(edit.add_vertex(position, rest, origin));
        }
    }

    fn join_rim(&self, edit: &mut Edit<'_>, rims: &Rims<'_>, mesh: &SectionMesh, side: usize) {
        for (t, triangle) in mesh.triangles.iter().enumerate() {
            for (k, &point) in triangle.iter().enumerate() {
                let own = if side == 0 { k } else { 2 - k };
                if self.twins[3 * t + own] == u32::MAX {
                    let node = self.section.nodes[point as usize];
                    let h = self.triangles[side][t].half_edges()[own];
                    edit.set_twins(h, rims.sides.rim[node as usize][side]);
                }
            }
        }
    }

    /// Finds the twin of each half-edge 3 t + k of the mesh.
    fn find_twins(&mut self, mesh: &SectionMesh) {
        self.twins.clear();
        self.twins.resize(3 * mesh.triangles.len(), u32::MAX);
        // The half-edges that leave each point, chained.
        self.first.clear();
        (self.first).resize(
            self.section.points.len() + mesh.steiner_points.len(),
            u32::MAX,
        );
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

    /// Sets texture coordinates to positions in the plane \[m\] and normals to the sweep's.
    fn set_attributes(
        &self,
        edit: &mut Edit<'_>,
        rims: &Rims<'_>,
        mesh: &SectionMesh,
        side: usize,
    ) {
        let surface = edit.surface();
        if surface.corner_uvs().is_empty() && surface.corner_normals().is_empty() {
            return;
        }
        for h in 0..3 * mesh.triangles.len() {
            let point = mesh.triangles[h / 3][h % 3] as usize;
            let at = match point.checked_sub(self.section.points.len()) {
                Some(inner) => mesh.steiner_points[inner].position,
                None => self.section.points[point],
            };
            let corner = self.triangles[side][h / 3].half_edges();
            let corner = corner[if side == 0 { h % 3 } else { (3 - h % 3) % 3 }];
            let [u, v] = at;
            let [u, v, _] = to_f32([u, v, 0.0].into());
            edit.set_uv(corner, [u, v]);
            let normal = rims.unfold.lift(at).1;
            edit.set_normal(corner, to_f32(if side == 0 { normal } else { -normal }));
        }
    }
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
