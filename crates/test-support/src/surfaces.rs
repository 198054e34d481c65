//! Small closed surfaces made of spheres, and surfaces at rest elsewhere.

use incise_mesh::{EdgeKey, Surface, Vec3, index_u32};
use std::collections::HashMap;

/// Returns a unit sphere around `center`: an octahedron subdivided `levels` times.
///
/// # Panics
/// Never with the few levels of tests.
#[must_use]
pub fn sphere(levels: u32, center: [f32; 3]) -> Surface {
    let (positions, faces) = sphere_parts(levels, center);
    Surface::from_triangles(&positions, &faces).expect("spheres are closed manifolds")
}

/// Returns a surface whose sides are scaled by three factors, at rest.
#[must_use]
pub fn scaled(surface: Surface, factors: [f32; 3]) -> Surface {
    let factors = Vec3::from(factors.map(f64::from));
    at_rest(surface, |p| p.component_mul(&factors))
}

/// Returns a surface whose vertices rest where `place` puts them.
#[must_use]
#[expect(clippy::cast_possible_truncation, reason = "rounded to storage")]
pub fn at_rest(mut surface: Surface, place: impl Fn(Vec3) -> Vec3) -> Surface {
    for v in 0..surface.positions().len() {
        let rest = Vec3::from(surface.rest_positions()[v].map(f64::from));
        let rest = <[f64; 3]>::from(place(rest)).map(|c| c as f32);
        surface.rest_positions_mut()[v] = rest;
        surface.positions_mut()[v][..3].copy_from_slice(&rest);
    }
    surface
}

/// Returns a surface of two separate spheres.
///
/// # Panics
/// Never with the few levels of tests.
#[must_use]
pub fn two_spheres(levels: u32) -> Surface {
    let (mut positions, mut faces) = sphere_parts(levels, [0.0, 2.0, 0.0]);
    let (more, other) = sphere_parts(levels, [3.0, 2.0, 0.0]);
    let offset = index_u32(positions.len());
    positions.extend(more);
    faces.extend(other.iter().map(|t| t.map(|v| v + offset)));
    Surface::from_triangles(&positions, &faces).expect("spheres are closed manifolds")
}

fn sphere_parts(levels: u32, center: [f32; 3]) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    let mut positions = vec![
        [1.0_f32, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [-1.0, 0.0, 0.0],
        [0.0, -1.0, 0.0],
        [0.0, 0.0, -1.0],
    ];
    let mut faces: Vec<[u32; 3]> = vec![
        [0, 1, 2],
        [1, 3, 2],
        [3, 4, 2],
        [4, 0, 2],
        [1, 0, 5],
        [3, 1, 5],
        [4, 3, 5],
        [0, 4, 5],
    ];
    for _ in 0..levels {
        let mut middles = HashMap::new();
        let mut finer = Vec::new();
        for [a, b, c] in faces {
            let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(p, q)| {
                *middles.entry((p.min(q), p.max(q))).or_insert_with(|| {
                    let (x, y) = (positions[p as usize], positions[q as usize]);
                    let sum = [0, 1, 2].map(|k: usize| x[k] + y[k]);
                    let norm = sum.iter().map(|c| c * c).sum::<f32>().sqrt();
                    positions.push(sum.map(|c| c / norm));
                    index_u32(positions.len() - 1)
                })
            });
            finer.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        faces = finer;
    }
    for p in &mut positions {
        *p = [p[0] + center[0], p[1] + center[1], p[2] + center[2]];
    }
    (positions, faces)
}

/// Returns the keys of all edges.
#[must_use]
pub fn edge_keys(surface: &Surface) -> Vec<EdgeKey> {
    let topology = surface.topology();
    topology
        .edges()
        .map(|h| EdgeKey::new(topology.origin(h), topology.target(h)))
        .collect()
}
