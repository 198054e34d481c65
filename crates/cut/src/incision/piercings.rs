//! Where a blade pierces a surface.

use super::line::point_at;
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
