//! Rest values, from rest positions. The order of the vertices is canonical, so the same edge always
//! gets the same bits.

use incise_mesh::geometry::Vec3;
use incise_mesh::{Surface, VertexId};

/// The rest length of an edge between two vertices, the smaller id first \[m\].
#[expect(
    clippy::cast_possible_truncation,
    reason = "a computed length is rounded once to storage"
)]
pub(crate) fn length(surface: &Surface, ends: [VertexId; 2]) -> f32 {
    let [a, b] = ends.map(|v| surface.rest_position(v));
    (b - a).norm() as f32
}

/// The signed angle between the normals at an edge \[rad\], vertices as in
/// [`BendingSet`](crate::BendingSet): 0 is flat, positive is convex.
#[expect(
    clippy::cast_possible_truncation,
    reason = "a computed angle is rounded once to storage"
)]
pub(crate) fn angle(surface: &Surface, vertices: [VertexId; 4]) -> f32 {
    let points = vertices.map(|v| surface.rest_position(v));
    dihedral(points, (points[1] - points[0]).norm()) as f32
}

/// The rest length of the edge from the first to the second of four vertices and the angle at it: to the
/// bit what [`length`] and [`angle`] say, at the price of little more than one of them.
#[expect(
    clippy::cast_possible_truncation,
    reason = "computed values are rounded once to storage"
)]
#[inline]
pub(crate) fn length_and_angle(surface: &Surface, vertices: [VertexId; 4]) -> (f32, f32) {
    let points = vertices.map(|v| surface.rest_position(v));
    let length = (points[1] - points[0]).norm();
    (length as f32, dihedral(points, length) as f32)
}

/// The signed angle at the edge from the first to the second point \[rad\], `length` apart \[m\].
#[inline]
fn dihedral([p0, p1, p2, p3]: [Vec3; 4], length: f64) -> f64 {
    let (e, toward) = (p1 - p0, p2 - p0);
    let first = e.cross(&toward);
    let second = (p3 - p0).cross(&e);
    arctangent2(-length * toward.dot(&second), first.dot(&second))
}

/// Up to which tangent an angle counts as flat.
const FLAT: f64 = 1.0 / 256.0;

/// The angle of the point `(x, y)` \[rad\]. Most edges are flat at rest to rounding, all within a cap among
/// them: for those the series is as exact and much faster.
#[inline]
fn arctangent2(y: f64, x: f64) -> f64 {
    if y.abs() < x * FLAT {
        let t = y / x;
        let s = t * t;
        t * (1.0 - s * (1.0 / 3.0 - s * (1.0 / 5.0 - s * (1.0 / 7.0))))
    } else {
        y.atan2(x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flat_angles_are_those_of_the_library() {
        for i in 0..40_000_i32 {
            let exponent = -40.0 + f64::from(i) * 1e-3;
            let y = exponent.exp2() * if i % 2 == 0 { 1.0 } else { -1.0 };
            for x in [1.0, 0.37, 1e-9, -0.8] {
                let (found, expected) = (arctangent2(y * x, x), (y * x).atan2(x));
                let off = (found - expected).abs();
                assert!(
                    off <= 4e-16 * expected.abs(),
                    "{y}, {x}: {found}, {expected}"
                );
            }
        }
        assert!(arctangent2(-0.0, 1.0).is_sign_negative(), "as the library");
    }
}
