//! A torus, the simplest closed surface with a handle.

use crate::geometry::{Vec3, to_f32};
use crate::surface::Surface;
use std::f64::consts::TAU;

/// Returns a torus around the y axis, with two radii \[m\] and numbers of segments (at least 3).
///
/// Circles of `minor_radius` follow a circle of `major_radius`. Each pair of segments gives two
/// triangles. Sines come from the platform, so the last bits may differ between machines.
///
/// # Panics
/// If the ids exceed 32 bits.
#[must_use]
pub fn torus(
    major_radius: f64,
    minor_radius: f64,
    major_segments: u32,
    minor_segments: u32,
) -> Surface {
    let (m, n) = (major_segments.max(3), minor_segments.max(3));
    let mut positions = Vec::new();
    let mut faces = Vec::new();
    for i in 0..m {
        let (sin_u, cos_u) = (TAU * f64::from(i) / f64::from(m)).sin_cos();
        for j in 0..n {
            let (sin_v, cos_v) = (TAU * f64::from(j) / f64::from(n)).sin_cos();
            let ring = major_radius + minor_radius * cos_v;
            positions.push(to_f32(Vec3::new(
                ring * cos_u,
                minor_radius * sin_v,
                ring * sin_u,
            )));
            let at = |i: u32, j: u32| (i % m) * n + j % n;
            let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
            faces.extend([[a, b, c], [a, c, d]]);
        }
    }
    Surface::from_triangles(&positions, &faces).expect("a periodic grid is a closed manifold")
}
