//! Patches into the surface.

use super::Filling;
use super::rim::{Rim, unit};
use incise_mesh::geometry::{area_vector, round};
use incise_mesh::{Edit, HalfEdge, Origin, TriangleId, Vec3, VertexId};

/// Adds a patch and joins it to its rim. Inverse masses and texture coordinates of new vertices are
/// means of their parents'. Returns the new triangles.
pub(super) fn sew(
    edit: &mut Edit<'_>,
    rim: &Rim,
    filling: &Filling,
    material: u32,
    smooth: bool,
) -> Vec<TriangleId> {
    let mut vertices = rim.vertices.clone();
    for (i, inner) in filling.inner.iter().enumerate() {
        let origin = Origin::OnCap {
            parents: inner.parents.map(|p| vertices[p as usize]),
            weights: inner.weights.map(narrow),
        };
        let surface = edit.surface();
        let [w] = origin.interpolate(|v| [surface.positions[v.index()][3]]);
        let [x, y, z] = round(filling.points[filling.rim + i]);
        let rest = round(filling.rest[filling.rim + i]);
        vertices.push(edit.add_vertex([x, y, z, narrow(w)], rest, origin));
    }
    let piece = edit.surface().piece(rim.across[0].triangle());
    let corners: Vec<[VertexId; 3]> = (filling.triangles.iter())
        .map(|t| t.map(|v| vertices[v as usize]))
        .collect();
    let twins = twins(&filling.triangles);
    let mut triangles = Vec::with_capacity(corners.len());
    edit.add_patch(
        &corners,
        &twins,
        &vec![piece; corners.len()],
        material,
        &mut triangles,
    );
    for (h, _) in (0..).zip(&twins).filter(|(_, twin)| **twin == u32::MAX) {
        let start = filling.triangles[h / 3][h % 3] as usize;
        edit.join(triangles[h / 3].half_edges()[h % 3], rim.across[start]);
    }
    dress(edit, rim, filling, &triangles, smooth);
    triangles
}

/// The half-edge across each half-edge 3 t + k of the triangles; `u32::MAX` at their boundary.
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

/// Corner attributes. Normals are those of the patch alone, so that the rim is a crease, or go over into
/// those of the surface where the patch is smooth.
fn dress(
    edit: &mut Edit<'_>,
    rim: &Rim,
    filling: &Filling,
    triangles: &[TriangleId],
    smooth: bool,
) {
    let surface = edit.surface();
    let of_rim: Vec<HalfEdge> = rim.across.iter().map(|h| h.next()).collect();
    if !surface.corners.uv.is_empty() {
        let mut uv: Vec<[f64; 2]> = (of_rim.iter())
            .map(|h| surface.corners.uv[h.index()].map(f64::from))
            .collect();
        for inner in &filling.inner {
            let mean = |k: usize| {
                let terms = (0..3).map(|i| inner.weights[i] * uv[inner.parents[i] as usize][k]);
                terms.sum::<f64>()
            };
            uv.push([0, 1].map(mean));
        }
        for (t, triangle) in triangles.iter().zip(&filling.triangles) {
            for (h, &v) in t.half_edges().into_iter().zip(triangle) {
                edit.set_uv(h, uv[v as usize].map(narrow));
            }
        }
    }
    let surface = edit.surface();
    if !surface.corners.normal.is_empty() {
        let mut normals = vec![Vec3::zeros(); filling.points.len()];
        for t in &filling.triangles {
            let area = area_vector(t.map(|v| filling.points[v as usize]));
            t.iter().for_each(|&v| normals[v as usize] += area);
        }
        if smooth {
            for (normal, h) in normals.iter_mut().zip(&of_rim) {
                let [x, y, z] = surface.corners.normal[h.index()].map(f64::from);
                *normal = Vec3::new(x, y, z);
            }
        }
        for (t, triangle) in triangles.iter().zip(&filling.triangles) {
            for (h, &v) in t.half_edges().into_iter().zip(triangle) {
                edit.set_normal(h, round(unit(normals[v as usize])));
            }
        }
    }
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "the one rounding to storage"
)]
fn narrow(x: f64) -> f32 {
    x as f32
}
