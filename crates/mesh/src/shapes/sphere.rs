//! Spheres from a subdivided icosahedron and from a cube.

use super::cuboid::quads;
use crate::geometry::{Vec3, area_vector, to_f32};
use crate::ids::{EdgeKey, VertexId};
use crate::surface::Surface;
use rustc_hash::FxHashMap;

/// Returns a sphere of `radius` \[m\] around the origin: a subdivided icosahedron.
///
/// It has 20 x 4^n triangles. Shading is flat: each corner has its triangle's normal, so a renderer
/// needs three vertices for each triangle.
///
/// # Panics
/// If the ids exceed 32 bits: above 12 subdivisions.
#[must_use]
pub fn icosphere(subdivisions: u32, radius: f64) -> Surface {
    let (mut points, mut faces) = icosahedron();
    for _ in 0..subdivisions {
        faces = split_in_four(&mut points, &faces);
    }
    let mut surface = finish(&points, &faces, radius);
    let normals: Vec<[f32; 3]> = surface
        .topology()
        .triangles()
        .flat_map(|t| [to_f32(area_vector(surface.triangle_positions(t)).normalize()); 3])
        .collect();
    surface.corners.normal = normals;
    surface
}

/// Returns a sphere of `radius` \[m\] around the origin: a cube mapped to the sphere.
///
/// `quads_per_edge` (at least 1) squares along an edge give 12 n^2 triangles without corner
/// attributes.
///
/// # Panics
/// If the ids exceed 32 bits: above 10,000 squares along an edge.
#[must_use]
pub fn cube_sphere(quads_per_edge: u32, radius: f64) -> Surface {
    let n = quads_per_edge.max(1);
    let (points, quads) = quads([n; 3]);
    let on_cube = |point: [u32; 3]| point.map(|c| 2.0 * f64::from(c) / f64::from(n) - 1.0);
    let points: Vec<Vec3> = (points.into_iter())
        .map(|point| on_unit_sphere(on_cube(point)))
        .collect();
    let mut faces = Vec::with_capacity(2 * quads.len());
    for quad in quads {
        let [a, b, c, d] = quad;
        let [pa, pb, pc, pd] = quad.map(|v| points[v as usize]);
        if (pc - pa).norm_squared() <= (pd - pb).norm_squared() {
            faces.extend([[a, b, c], [a, c, d]]);
        } else {
            faces.extend([[a, b, d], [b, c, d]]);
        }
    }
    finish(&points, &faces, radius)
}

pub(super) fn finish(points: &[Vec3], faces: &[[u32; 3]], radius: f64) -> Surface {
    let positions: Vec<[f32; 3]> = points.iter().map(|p| to_f32(p * radius)).collect();
    Surface::from_triangles(&positions, faces).expect("a subdivided polyhedron is a manifold")
}

fn icosahedron() -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let golden = (1.0 + 5.0_f64.sqrt()) / 2.0;
    let mut points = Vec::with_capacity(12);
    for (s, t) in [(-1.0, 1.0), (1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)] {
        points.push(Vec3::new(s, t * golden, 0.0));
    }
    for (s, t) in [(-1.0, 1.0), (1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)] {
        points.push(Vec3::new(0.0, s, t * golden));
    }
    for (s, t) in [(1.0, -1.0), (1.0, 1.0), (-1.0, -1.0), (-1.0, 1.0)] {
        points.push(Vec3::new(s * golden, 0.0, t));
    }
    let faces = vec![
        [0, 11, 5],
        [0, 5, 1],
        [0, 1, 7],
        [0, 7, 10],
        [0, 10, 11],
        [1, 5, 9],
        [5, 11, 4],
        [11, 10, 2],
        [10, 7, 6],
        [7, 1, 8],
        [3, 9, 4],
        [3, 4, 2],
        [3, 2, 6],
        [3, 6, 8],
        [3, 8, 9],
        [4, 9, 5],
        [2, 4, 11],
        [6, 2, 10],
        [8, 6, 7],
        [9, 8, 1],
    ];
    (points.iter().map(Vec3::normalize).collect(), faces)
}

fn split_in_four(points: &mut Vec<Vec3>, faces: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut middles: FxHashMap<EdgeKey, u32> = FxHashMap::default();
    let mut middle = |a: u32, b: u32| {
        *middles
            .entry(EdgeKey::new(VertexId(a), VertexId(b)))
            .or_insert_with(|| {
                points.push((points[a as usize] + points[b as usize]).normalize());
                VertexId::from_index(points.len() - 1).0
            })
    };
    let mut out = Vec::with_capacity(4 * faces.len());
    for &[a, b, c] in faces {
        let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
        out.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
    }
    out
}

/// Maps a point of the cube's surface, with sides at -1 and 1, to the unit sphere.
///
/// Squares keep more of their area than under central projection: x sqrt(1 - y^2/2 - z^2/2 + y^2
/// z^2/3), and so on.
fn on_unit_sphere(cube: [f64; 3]) -> Vec3 {
    let [x2, y2, z2] = cube.map(|c| c * c);
    let spread = |a: f64, b: f64| (1.0 - a / 2.0 - b / 2.0 + a * b / 3.0).sqrt();
    Vec3::new(
        cube[0] * spread(y2, z2),
        cube[1] * spread(z2, x2),
        cube[2] * spread(x2, y2),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_of_the_cube_land_on_the_sphere() {
        for cube in [[1.0, 0.3, -0.7], [-1.0, 1.0, 1.0], [0.0, -1.0, 0.5]] {
            assert!((on_unit_sphere(cube).norm() - 1.0).abs() < 1e-15);
        }
    }

    #[test]
    fn one_square_a_side_gives_a_cube() {
        let cube = cube_sphere(0, 3.0_f64.sqrt());
        assert_eq!(cube.topology().triangle_count(), 12);
        assert_eq!(cube.topology().vertex_count(), 8);
        assert!((cube.volume() - 8.0).abs() < 1e-5);
    }
}
