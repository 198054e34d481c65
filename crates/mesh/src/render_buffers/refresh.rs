//! Positions, normals and tangents of a moving surface.

use super::RenderBuffers;
use crate::surface::Surface;
use nalgebra::{Vector2, Vector3};

type Vec3f = Vector3<f32>;

impl RenderBuffers {
    /// Copies positions, and computes normals and tangents. O(n), without allocation.
    ///
    /// A normal is the mean of the triangles at its vertex, weighted by their areas.
    pub fn refresh(&mut self, surface: &Surface) {
        for (position, &h) in self.positions.iter_mut().zip(&self.corners) {
            if h.is_null() {
                *position = [0.0; 3];
                continue;
            }
            let [x, y, z, _] = surface.positions()[surface.topology().origin(h).index()];
            *position = [x, y, z];
        }
        self.normals.fill([0.0; 3]);
        self.tangents.fill([0.0; 4]);
        for triangle in self
            .indices
            .iter()
            .flat_map(|indices| indices.as_chunks::<3>().0)
        {
            let corners = triangle.map(|i| i as usize);
            let [a, b, c] = corners.map(|i| Vec3f::from(self.positions[i]));
            let edges = [b - a, c - a];
            let area = edges[0].cross(&edges[1]);
            for i in corners {
                add(&mut self.normals[i], &area);
            }
            if self.tangents.is_empty() {
                continue;
            }
            let [a, b, c] = corners.map(|i| Vector2::from(self.uvs[i]));
            let (tangent, side) = tangent(edges, [b - a, c - a], area.norm());
            for i in corners {
                let [x, y, z, w] = &mut self.tangents[i];
                *x += tangent.x;
                *y += tangent.y;
                *z += tangent.z;
                *w += side;
            }
        }
        for normal in &mut self.normals {
            *normal = Vec3f::from(*normal)
                .try_normalize(0.0)
                .unwrap_or_default()
                .into();
        }
        for (tangent, &normal) in self.tangents.iter_mut().zip(&self.normals) {
            let [x, y, z, side] = *tangent;
            let [x, y, z] = perpendicular(Vec3f::new(x, y, z), Vec3f::from(normal)).into();
            *tangent = [x, y, z, if side < 0.0 { -1.0 } else { 1.0 }];
        }
    }
}

fn add(sum: &mut [f32; 3], by: &Vec3f) {
    *sum = (Vec3f::from(*sum) + by).into();
}

/// Returns the direction of u in a triangle, weighted by its area, and the side of its texture.
fn tangent([p, q]: [Vec3f; 2], [u, v]: [Vector2<f32>; 2], area: f32) -> (Vec3f, f32) {
    let side = (u.x * v.y - u.y * v.x).signum() * area;
    let along = (p * v.y - q * u.y) * side.signum();
    (along.try_normalize(0.0).unwrap_or_default() * area, side)
}

/// Returns the unit vector across `normal` that is closest to `along`, or any if there is none.
fn perpendicular(along: Vec3f, normal: Vec3f) -> Vec3f {
    let across = along - normal * normal.dot(&along);
    across.try_normalize(0.0).unwrap_or_else(|| {
        let axis = if normal.x.abs() < 0.5 {
            Vec3f::x()
        } else {
            Vec3f::y()
        };
        (axis - normal * normal.dot(&axis)).normalize()
    })
}
