//! Where a blade pierces a surface.

use super::line::point_at;
use super::map::gradient_at;
use crate::search::touches;
use incise_mesh::geometry::{area_vector, to_f32, to_f64};
use incise_mesh::{Aabb, Surface, TriangleId, Vec3};

/// Rounding error of the weights of a point in a triangle.
const ROUNDING: f64 = 1e-9;

/// A point at which a blade pierces a surface.
#[derive(Debug, Clone, Copy)]
pub(super) struct Piercing {
    /// Its parameter on the blade.
    pub(super) parameter: f64,
    pub(super) triangle: TriangleId,
    pub(super) point: Vec3,
    /// Its place in the rest shape \[m\].
    pub(super) rest: Vec3,
    /// Whether the blade goes into the body there.
    pub(super) enters: bool,
}

/// Returns where a blade pierces triangles, in order along the blade.
pub(super) fn piercings(
    blade: &[[f32; 3]],
    surface: &Surface,
    near: &[TriangleId],
) -> Vec<Piercing> {
    let mut found = Vec::new();
    for (i, ends) in blade.windows(2).enumerate() {
        let [p, q] = [to_f64(ends[0]), to_f64(ends[1])];
        for &triangle in near {
            let corners = surface.triangle_positions(triangle);
            let Some(part) = pierced_at(corners, p, q) else {
                continue;
            };
            #[expect(clippy::cast_precision_loss, reason = "few points")]
            let parameter = i as f64 + part;
            let point = point_at(blade, parameter);
            let [a, b, c] =
                (surface.topology().triangle(triangle)).map(|v| surface.rest_position(v));
            let [u, v, w] = weights(corners, point);
            found.push(Piercing {
                parameter,
                triangle,
                point,
                rest: a * u + b * v + c * w,
                enters: area_vector(corners).dot(&(q - p)) < 0.0,
            });
        }
    }
    found.sort_by(|a, b| a.parameter.total_cmp(&b.parameter));
    found
}

/// Returns the piercings at which a blade enters the body and leaves it in turns, in their order at
/// rest.
///
/// They are the outermost ones where the body overlaps itself, and none where it is inside out. In
/// folds of the skin, neighbors that are in the opposite order at rest cancel in pairs. Sheets,
/// which have no inside, keep all.
pub(super) fn ends_in_body(
    surface: &Surface,
    piercings: &[Piercing],
    sheets: &[bool],
    starts_inside: bool,
) -> Vec<Piercing> {
    let mut winding = i32::from(starts_inside);
    let mut kept: Vec<Piercing> = Vec::with_capacity(piercings.len());
    for piercing in piercings {
        if sheets.get(surface.piece(piercing.triangle) as usize) == Some(&true) {
            kept.push(*piercing);
            continue;
        }
        let was_inside = winding > 0;
        winding += if piercing.enters { 1 } else { -1 };
        if was_inside == (winding > 0) {
            continue;
        }
        match kept.last() {
            Some(last)
                if last.enters != piercing.enters && !is_ordered(surface, last, piercing) =>
            {
                kept.pop();
            }
            _ => kept.push(*piercing),
        }
    }
    kept
}

/// Returns whether two piercings have the same order along the blade at rest.
fn is_ordered(surface: &Surface, first: &Piercing, second: &Piercing) -> bool {
    let gradient = gradient_at(surface, [Some(first), Some(second)]);
    let along = gradient * (second.point - first.point);
    along.dot(&(second.rest - first.rest)) > 0.0
}

/// Returns the weights of the corners of a triangle at a point in its plane.
fn weights(corners: [Vec3; 3], point: Vec3) -> [f64; 3] {
    let [a, b, c] = corners;
    let normal = area_vector(corners);
    let square = normal.norm_squared();
    let [u, v] = [[b, c], [c, a]].map(|[p, q]| normal.dot(&area_vector([p, q, point])) / square);
    [u, v, 1.0 - u - v]
}

/// Returns the part of the way from `p` to `q` at which the line pierces a triangle.
///
/// A line through an edge pierces at least one of its triangles.
pub(super) fn pierced_at(corners: [Vec3; 3], p: Vec3, q: Vec3) -> Option<f64> {
    if !touches(&Aabb::around(corners.map(to_f32)), p, q) {
        return None;
    }
    let [a, b, c] = corners;
    let normal = area_vector(corners);
    let [start, end] = [p, q].map(|x| normal.dot(&(x - a)));
    if (start < 0.0) == (end < 0.0) {
        return None;
    }
    let part = start / (start - end);
    let at = p + (q - p) * part;
    let least = -ROUNDING * normal.norm_squared();
    let is_inside = |[u, v]: [Vec3; 2]| normal.dot(&area_vector([u, v, at])) >= least;
    [[a, b], [b, c], [c, a]]
        .into_iter()
        .all(is_inside)
        .then_some(part)
}

/// Returns whether a polyline pierces the surface.
///
/// `near` has all triangles that it may pierce.
pub(super) fn is_pierced(line: &[Vec3], surface: &Surface, near: &[TriangleId]) -> bool {
    line.windows(2).any(|ends| {
        let mut corners = near.iter().map(|&t| surface.triangle_positions(t));
        corners.any(|corners| pierced_at(corners, ends[0], ends[1]).is_some())
    })
}
