//! Rest lengths and rest angles from rest positions.
//!
//! The order of the vertices is canonical, so an edge always gets the same bits.

use incise_mesh::geometry::Vec3;
use incise_mesh::{Surface, VertexId};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

/// Returns the rest length of an edge, the end with the smaller id first \[m\].
#[expect(
    clippy::cast_possible_truncation,
    reason = "a computed length is rounded once to storage"
)]
pub(crate) fn length(surface: &Surface, ends: [VertexId; 2]) -> f32 {
    let [a, b] = ends.map(|v| surface.rest_position(v));
    (b - a).norm() as f32
}

/// Returns the signed dihedral angle at rest \[rad\], 0 if flat, positive if convex.
///
/// The order of vertices is that of [`BendingSet`](crate::BendingSet).
#[expect(
    clippy::cast_possible_truncation,
    reason = "a computed angle is rounded once to storage"
)]
pub(crate) fn angle(surface: &Surface, vertices: [VertexId; 4]) -> f32 {
    let points = vertices.map(|v| surface.rest_position(v));
    dihedral(points, (points[1] - points[0]).norm()) as f32
}

/// Returns the bits of [`length`] and [`angle`] for about the cost of one of them.
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

/// Returns the signed dihedral angle at the edge of the first two points \[rad\].
///
/// `length` is their distance \[m\].
#[inline]
fn dihedral([p0, p1, p2, p3]: [Vec3; 4], length: f64) -> f64 {
    let (e, f) = (p1 - p0, p2 - p0);
    let first = e.cross(&f);
    let second = (p3 - p0).cross(&e);
    arctangent2(-length * f.dot(&second), first.dot(&second))
}

/// Coefficients of `atan(t) / t` in `t^2` for angles up to pi / 8.
///
/// The relative error is 8e-13, far below the rounding to storage.
const COEFFICIENTS: [f64; 8] = [
    0.999_999_999_999_244_7,
    -0.333_333_332_769_224_94,
    0.199_999_930_535_558_15,
    -0.142_853_865_537_521_4,
    0.111_034_569_089_474_65,
    -0.089_925_529_061_509_12,
    0.069_741_976_865_952_65,
    -0.037_655_106_012_914_02,
];

/// Tangent of pi / 8.
const TANGENT: f64 = 0.414_213_562_373_095_03;

/// Returns the angle of the point `(x, y)` \[rad\], and 0 at the origin.
///
/// It has no branches, so that loops over edges vectorize, and the same bits on every machine.
#[inline]
fn arctangent2(y: f64, x: f64) -> f64 {
    let (ax, ay) = (x.abs(), y.abs());
    let steep = ay > ax;
    let (small, large) = if steep { (ax, ay) } else { (ay, ax) };
    // Angles above pi / 8 are measured from pi / 4.
    let turned = small > TANGENT * large;
    let above = if turned { small - large } else { small };
    let below = if turned { small + large } else { large };
    let t = above / if below > 0.0 { below } else { 1.0 };
    let s = t * t;
    let [c0, c1, c2, c3, c4, c5, c6, c7] = COEFFICIENTS;
    let fourth = s * s;
    let late = (c4 + c5 * s) + fourth * (c6 + c7 * s);
    let series = (c0 + c1 * s) + fourth * ((c2 + c3 * s) + fourth * late);
    let mut angle = t * series;
    angle = if turned { FRAC_PI_4 + angle } else { angle };
    angle = if steep { FRAC_PI_2 - angle } else { angle };
    angle = if x < 0.0 { PI - angle } else { angle };
    angle.copysign(y)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn angles_equal_those_of_the_standard_library() {
        let close = |y: f64, x: f64| {
            let (found, expected) = (arctangent2(y, x), y.atan2(x));
            let error = (found - expected).abs();
            assert!(
                error <= 1e-12 * expected.abs(),
                "{y}, {x}: {found}, {expected}"
            );
        };
        for i in 0..100_000 {
            let (sin, cos) = (f64::from(i) * TAU / 100_000.0).sin_cos();
            close(3.7 * sin, 3.7 * cos);
        }
        for i in 0..40_000_i32 {
            let y = (f64::from(i) * 1e-3 - 40.0).exp2();
            for x in [1.0, -1.0, 1e-9, 0.0] {
                close(y, x);
                close(-y, x);
            }
        }
        for (y, x) in [
            (0.0, 1.0),
            (-0.0, 1.0),
            (0.0, -1.0),
            (-0.0, -1.0),
            (0.0, 0.0),
        ] {
            assert_eq!(
                arctangent2(y, x).to_bits(),
                y.atan2(x).to_bits(),
                "{y}, {x}"
            );
        }
    }
}
