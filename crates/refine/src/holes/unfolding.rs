//! Refinement of a bent patch in the plane into which it unfolds.
//!
//! The dual graph of triangles on a rim alone is a tree, so they unfold without distortion. The
//! unfolded rim is triangulated by [`crate::section_mesh`], and the result is folded back. If the
//! unfolded rim crosses itself, [`super::subdivision`] refines the patch in space instead.

use super::planar::triangulate_loop;
use super::stitching::twins;
use super::{HolePatch, NewVertex};
use crate::error::HoleError;
use crate::section_mesh::SectionMesh;
use incise_mesh::Vec3;

/// Mean number of Steiner points in a cell of the lookup grid.
const POINTS_PER_CELL: f64 = 2.0;

/// Refines the unfolded patch to the target sizes \[m\] at the rim's vertices.
///
/// Returns whether it succeeded. `has_edge` returns whether the surface already has an edge between
/// two rim vertices.
///
/// # Errors
/// [`HoleError::TooManyTriangles`] and [`HoleError::Planar`].
pub(super) fn refine(
    patch: &mut HolePatch,
    sizes: &[f64],
    limit: usize,
    has_edge: &impl Fn(u32, u32) -> bool,
) -> Result<bool, HoleError> {
    let Some(flat) = unfold(&patch.points, &patch.triangles) else {
        return Ok(false);
    };
    let Some(mesh) = triangulate_loop(&flat, sizes, limit, has_edge)? else {
        return Ok(false);
    };
    let triangles = std::mem::take(&mut patch.triangles);
    let unfolded = UnfoldedTriangles {
        flat: &flat,
        triangles: &triangles,
    };
    for (inner, t) in mesh.steiner_points.iter().zip(unfolded.find(&mesh)) {
        let parents = triangles[t as usize];
        let [a, b, c] = unfolded.areas(t, inner.position).map(|area| area.max(0.0));
        let sum = a + b + c;
        let weights = if sum > 0.0 {
            [a / sum, b / sum, c / sum]
        } else {
            [1.0 / 3.0; 3]
        };
        patch.push(NewVertex { parents, weights });
    }
    patch.triangles = mesh.triangles;
    Ok(true)
}

/// Unfolds the triangles of a rim and returns its positions in the plane.
///
/// `None` if they have a vertex that is not on the rim, or an edge without length.
fn unfold(points: &[Vec3], triangles: &[[u32; 3]]) -> Option<Vec<[f64; 2]>> {
    if triangles.len() + 2 != points.len() {
        return None;
    }
    let twins = twins(triangles);
    let at = |v: u32| points[v as usize];
    let mut flat = vec![[0.0; 2]; points.len()];
    let [a, b, _] = triangles[0];
    flat[b as usize] = [(at(b) - at(a)).norm(), 0.0];
    // Half-edges of triangles with two placed corners.
    let mut open = vec![0u32];
    let mut placed = 0;
    while let Some(h) = open.pop() {
        placed += 1;
        let (t, k) = (h as usize / 3, h as usize % 3);
        let [a, b, c] = [0, 1, 2].map(|i| triangles[t][(k + i) % 3]);
        let (side, up) = (at(b) - at(a), at(c) - at(a));
        let squared = side.norm_squared();
        let (along, off) = (side.dot(&up) / squared, side.cross(&up).norm() / squared);
        let (p, q) = (flat[a as usize], flat[b as usize]);
        let [x, y] = [q[0] - p[0], q[1] - p[1]];
        let apex = [p[0] + along * x - off * y, p[1] + along * y + off * x];
        if !(apex[0].is_finite() && apex[1].is_finite()) || placed > triangles.len() {
            return None;
        }
        flat[c as usize] = apex;
        let others = [1, 2].map(|i| 3 * t + (k + i) % 3);
        open.extend(others.map(|h| twins[h]).iter().filter(|&&h| h != u32::MAX));
        if placed == 1 && twins[0] != u32::MAX {
            open.push(twins[0]);
        }
    }
    (placed == triangles.len()).then_some(flat)
}

/// The unfolded triangles, for point location.
struct UnfoldedTriangles<'a> {
    flat: &'a [[f64; 2]],
    triangles: &'a [[u32; 3]],
}

impl UnfoldedTriangles<'_> {
    /// Returns twice the signed areas that a point forms with the side opposite to each corner.
    fn areas(&self, t: u32, [x, y]: [f64; 2]) -> [f64; 3] {
        let corners = self.triangles[t as usize].map(|v| self.flat[v as usize]);
        [1, 2, 0].map(|k| {
            let ([ax, ay], [bx, by]) = (corners[k], corners[(k + 1) % 3]);
            (ax - x) * (by - y) - (ay - y) * (bx - x)
        })
    }

    /// Returns the triangle that contains each Steiner point; on an edge, the deeper one.
    #[expect(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "cells of a grid, clamped to it"
    )]
    fn find(&self, mesh: &SectionMesh) -> Vec<u32> {
        let mut found = vec![(0u32, f64::NEG_INFINITY); mesh.steiner_points.len()];
        let bounds = |k: usize| {
            let own = self.flat.iter().map(|p| p[k]);
            own.fold((f64::INFINITY, f64::NEG_INFINITY), |b, x| {
                (b.0.min(x), b.1.max(x))
            })
        };
        let [(left, right), (low, high)] = [bounds(0), bounds(1)];
        let (width, height) = (right - left, high - low);
        let cells = (mesh.steiner_points.len() as f64 / POINTS_PER_CELL).max(1.0);
        let size = (width * height / cells)
            .sqrt()
            .max(width.max(height) / cells);
        let [columns, rows] = [width, height].map(|x| (x / size) as usize + 1);
        let column = |x: f64| (((x - left) / size) as usize).min(columns - 1);
        let row = |y: f64| (((y - low) / size) as usize).min(rows - 1);
        let mut order: Vec<(u32, u32)> = (0u32..)
            .zip(&mesh.steiner_points)
            .map(|(i, p)| {
                (
                    (row(p.position[1]) * columns + column(p.position[0])) as u32,
                    i,
                )
            })
            .collect();
        order.sort_unstable();
        let mut starts = vec![0; rows * columns + 1];
        for &(cell, _) in &order {
            starts[cell as usize + 1] += 1;
        }
        for i in 0..rows * columns {
            starts[i + 1] += starts[i];
        }
        for (t, corners) in (0u32..).zip(self.triangles) {
            let corners = corners.map(|v| self.flat[v as usize]);
            let [bottom, top] = [f64::min, f64::max]
                .map(|pick| corners.iter().map(|p| p[1]).fold(corners[0][1], pick));
            for r in row(bottom).saturating_sub(1)..=(row(top) + 1).min(rows - 1) {
                // The triangle's part in the row, with a margin for rounding.
                let strip = [r as f64 - 0.1, r as f64 + 1.1].map(|y| low + y * size);
                let Some([from, to]) = x_range(corners, strip) else {
                    continue;
                };
                let first = r * columns + column(from - 0.1 * size);
                let last = r * columns + column(to + 0.1 * size);
                for &(_, i) in &order[starts[first]..starts[last + 1]] {
                    let areas = self.areas(t, mesh.steiner_points[i as usize].position);
                    let depth = areas.into_iter().fold(f64::INFINITY, f64::min);
                    let best = &mut found[i as usize];
                    if depth > best.1 {
                        *best = (t, depth);
                    }
                }
            }
        }
        found.into_iter().map(|(t, _)| t).collect()
    }
}

/// Returns the x range of a triangle's part between two heights.
fn x_range(corners: [[f64; 2]; 3], [low, high]: [f64; 2]) -> Option<[f64; 2]> {
    let mut out = [f64::INFINITY, f64::NEG_INFINITY];
    for k in 0..3 {
        let (mut p, mut q) = (corners[k], corners[(k + 1) % 3]);
        if p[1] > q[1] {
            std::mem::swap(&mut p, &mut q);
        }
        if q[1] < low || p[1] > high {
            continue;
        }
        for y in [p[1].max(low), q[1].min(high)] {
            let rise = q[1] - p[1];
            let part = if rise > 0.0 { (y - p[1]) / rise } else { 0.0 };
            let x = p[0] + part * (q[0] - p[0]);
            out = [out[0].min(x), out[1].max(x)];
        }
        if q[1] == p[1] {
            out = [out[0].min(q[0]), out[1].max(q[0])];
        }
    }
    (out[0] <= out[1]).then_some(out)
}

#[cfg(test)]
mod tests {
    use super::super::minimal_triangulation::triangulate_minimal;
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Unfolding preserves lengths, and Steiner points lie in the triangles found for them.
        #[test]
        fn unfolding_is_isometric(
            radii in prop::collection::vec((0.5f64..1.0, -0.5f64..0.5), 4..40),
            z in 0.1f64..1.0,
        ) {
            let n = radii.len() as f64;
            let points: Vec<Vec3> = radii.iter().enumerate().map(|(i, &(r, height))| {
                let a = i as f64 * std::f64::consts::TAU / n;
                Vec3::new(r * a.cos(), r * a.sin(), height)
            }).collect();
            let free = |_, _| false;
            let across = vec![Vec3::zeros(); points.len()];
            let triangles = triangulate_minimal(&points, &across, &free).triangles;
            let flat = unfold(&points, &triangles).unwrap();
            for t in &triangles {
                let [x, y, z] = t.map(|v| v as usize);
                for [a, b] in [[x, y], [y, z], [z, x]] {
                    let length = (points[b] - points[a]).norm();
                    let [x, y] = [0, 1].map(|k| flat[b][k] - flat[a][k]);
                    prop_assert!((x.hypot(y) - length).abs() < 1e-9, "{a} to {b}");
                }
            }
            let sizes = vec![z; points.len()];
            if let Some(mesh) = triangulate_loop(&flat, &sizes, 100_000, &free).unwrap() {
                let unfolded = UnfoldedTriangles { flat: &flat, triangles: &triangles };
                for (inner, t) in mesh.steiner_points.iter().zip(unfolded.find(&mesh)) {
                    let areas = unfolded.areas(t, inner.position).into_iter();
                    let least = areas.fold(f64::INFINITY, f64::min);
                    prop_assert!(least > -1e-9, "{:?} lies {least} off {t}", inner.position);
                }
            }
        }
    }

    #[test]
    fn x_range_is_limited_to_the_strip() {
        let corners = [[0.0, 0.0], [4.0, 2.0], [0.0, 4.0]];
        assert_eq!(x_range(corners, [1.0, 3.0]), Some([0.0, 4.0]));
        assert_eq!(x_range(corners, [0.0, 1.0]), Some([0.0, 2.0]));
        assert_eq!(x_range(corners, [4.5, 5.0]), None);
        assert_eq!(
            x_range([[0.0, 1.0], [3.0, 1.0], [1.0, 1.0]], [0.0, 2.0]),
            Some([0.0, 3.0])
        );
    }
}
