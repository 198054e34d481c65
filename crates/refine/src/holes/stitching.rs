//! Adds patches to a surface: vertices, triangles, connectivity and corner attributes.

use super::HolePatch;
use super::rim::{Rim, unit};
use incise_mesh::geometry::{area_vector, round_to_f32, to_f32};
use incise_mesh::{Edit, HalfEdge, TriangleId, Vec3, VertexId, VertexOrigin};

/// Adds a patch, connects it to its rim and returns the new triangles.
///
/// Inverse masses and texture coordinates of new vertices are means of their parents'.
pub(super) fn stitch(
    edit: &mut Edit<'_>,
    rim: &Rim,
    patch: &HolePatch,
    material: u32,
    smooth: bool,
) -> Vec<TriangleId> {
    let mut vertices = rim.vertices.clone();
    for (i, inner) in patch.inner.iter().enumerate() {
        let origin = VertexOrigin::OnCap {
            parents: inner.parents.map(|p| vertices[p as usize]),
            weights: inner.weights.map(round_to_f32),
        };
        let surface = edit.surface();
        let [w] = origin.interpolate(|v| [surface.positions()[v.index()][3]]);
        let [x, y, z] = to_f32(patch.points[patch.rim + i]);
        let rest = to_f32(patch.rest[patch.rim + i]);
        vertices.push(edit.add_vertex([x, y, z, round_to_f32(w)], rest, origin));
    }
    let piece = edit.surface().piece(rim.across[0].triangle());
    let corners: Vec<[VertexId; 3]> = (patch.triangles.iter())
        .map(|t| t.map(|v| vertices[v as usize]))
        .collect();
    let twins = twins(&patch.triangles);
    let mut triangles = Vec::with_capacity(corners.len());
    edit.add_patch(
        &corners,
        &twins,
        &vec![piece; corners.len()],
        material,
        &mut triangles,
    );
    for (h, _) in (0..).zip(&twins).filter(|(_, twin)| **twin == u32::MAX) {
        let start = patch.triangles[h / 3][h % 3] as usize;
        edit.set_twins(triangles[h / 3].half_edges()[h % 3], rim.across[start]);
    }
    set_corner_attributes(edit, rim, patch, &triangles, smooth);
    edit.inherit_corner_channels(&triangles);
    triangles
}

/// Returns the twin of each half-edge 3 t + k of the triangles; `u32::MAX` on their boundary.
pub(super) fn twins(triangles: &[[u32; 3]]) -> Vec<u32> {
    let mut sides: Vec<([u32; 2], u32)> = (0u32..)
        .zip(
            triangles
                .iter()
                .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]),
        )
        .map(|(h, [a, b])| ([a.min(b), a.max(b)], h))
        .collect();
    sides.sort_unstable();
    let mut twins = vec![u32::MAX; sides.len()];
    for pair in sides.chunk_by(|x, y| x.0 == y.0) {
        if let [(_, g), (_, h)] = *pair {
            twins[g as usize] = h;
            twins[h as usize] = g;
        }
    }
    twins
}

/// Sets texture coordinates and normals of the patch's corners.
///
/// On the rim, a smooth patch takes the surface's normals. Any other patch has its own normals, so
/// that the rim is a crease.
fn set_corner_attributes(
    edit: &mut Edit<'_>,
    rim: &Rim,
    patch: &HolePatch,
    triangles: &[TriangleId],
    smooth: bool,
) {
    let surface = edit.surface();
    let of_rim: Vec<HalfEdge> = rim.across.iter().map(|h| h.next()).collect();
    if !surface.corner_uvs().is_empty() {
        let mut uv: Vec<[f64; 2]> = (of_rim.iter())
            .map(|h| surface.corner_uvs()[h.index()].map(f64::from))
            .collect();
        for inner in &patch.inner {
            let mean = |k: usize| {
                let terms = (0..3).map(|i| inner.weights[i] * uv[inner.parents[i] as usize][k]);
                terms.sum::<f64>()
            };
            uv.push([0, 1].map(mean));
        }
        for (t, triangle) in triangles.iter().zip(&patch.triangles) {
            for (h, &v) in t.half_edges().into_iter().zip(triangle) {
                edit.set_uv(h, uv[v as usize].map(round_to_f32));
            }
        }
    }
    let surface = edit.surface();
    if !surface.corner_normals().is_empty() {
        let mut normals = vec![Vec3::zeros(); patch.points.len()];
        for t in &patch.triangles {
            let area = area_vector(t.map(|v| patch.points[v as usize]));
            t.iter().for_each(|&v| normals[v as usize] += area);
        }
        if smooth {
            for (normal, h) in normals.iter_mut().zip(&of_rim) {
                let [x, y, z] = surface.corner_normals()[h.index()].map(f64::from);
                *normal = Vec3::new(x, y, z);
            }
        }
        for (t, triangle) in triangles.iter().zip(&patch.triangles) {
            for (h, &v) in t.half_edges().into_iter().zip(triangle) {
                edit.set_normal(h, to_f32(unit(normals[v as usize])));
            }
        }
    }
}
