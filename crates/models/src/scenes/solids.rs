//! Surfaces of scenes: boxes of any cells, tubes along a curve, and models of one size.

use crate::{Model, build_model, place};
use incise_mesh::geometry::to_f32;
use incise_mesh::{Surface, TriangleId, Vec3, index_u32};
use std::collections::BTreeMap;

/// Returns a model whose largest side is 1 m, centered above the origin.
///
/// Its lowest point is at height 0, its vertices are in the order of their positions. None for a
/// model without an extent.
#[must_use]
pub fn unit_size(mut surface: Surface) -> Option<Surface> {
    surface.sort_by_position();
    let bounds = surface.bounds();
    let [low, high] = [bounds.min, bounds.max].map(|corner| Vec3::from(corner.map(f64::from)));
    let (side, center) = ((high - low).amax(), (low + high) / 2.0);
    let base = Vec3::new(center.x, low.y, center.z);
    place(&mut surface, |p| (p - base) / side);
    (side > 0.0).then_some(surface)
}

/// Returns the bunny at a size of 1 m.
pub(super) fn unit_bunny() -> Surface {
    unit_size(build_model(Model::Bunny)).expect("a model has an extent")
}

/// Returns one surface with others as its components, at rest.
///
/// # Panics
/// If the ids exceed 32 bits.
#[must_use]
pub fn joined(parts: &[Surface]) -> Surface {
    let (mut corners, mut faces) = (Vec::new(), Vec::new());
    for part in parts {
        let offset = index_u32(corners.len());
        corners.extend_from_slice(part.rest_positions());
        let topology = part.topology();
        let of = |t: TriangleId| topology.triangle(t).map(|v| v.0 + offset);
        faces.extend(topology.triangles().map(of));
    }
    Surface::from_triangles(&corners, &faces).expect("components of manifolds are a manifold")
}

/// Returns a box around the origin with sides of given lengths \[m\] and numbers of squares.
///
/// # Panics
/// Without a square along a side, or if the ids exceed 32 bits.
#[must_use]
pub fn cuboid(sides: [f64; 3], cells: [u32; 3]) -> Surface {
    let (mut corners, mut faces) = (Vec::new(), Vec::new());
    let mut numbers: BTreeMap<[u32; 3], u32> = BTreeMap::new();
    let mut vertex = |at: [u32; 3]| {
        *numbers.entry(at).or_insert_with(|| {
            let place = |k: usize| sides[k] * (f64::from(at[k]) / f64::from(cells[k]) - 0.5);
            corners.push(to_f32(Vec3::new(place(0), place(1), place(2))));
            index_u32(corners.len() - 1)
        })
    };
    for axis in 0..3 {
        let (one, other) = ((axis + 1) % 3, (axis + 2) % 3);
        for (level, is_top) in [(0, false), (cells[axis], true)] {
            for (i, j) in (0..cells[one]).flat_map(|i| (0..cells[other]).map(move |j| (i, j))) {
                let mut at = |di: u32, dj: u32| {
                    let mut place = [level; 3];
                    (place[one], place[other]) = (i + di, j + dj);
                    vertex(place)
                };
                let [a, b, c, d] = [at(0, 0), at(1, 0), at(1, 1), at(0, 1)];
                let both = match (i + j) % 2 {
                    0 => [[a, b, c], [a, c, d]],
                    _ => [[a, b, d], [b, c, d]],
                };
                faces.extend(both.map(|[a, b, c]| match is_top {
                    true => [a, b, c],
                    false => [a, c, b],
                }));
            }
        }
    }
    Surface::from_triangles(&corners, &faces).expect("a box is an oriented manifold")
}

/// Returns a tube of a radius \[m\] around a curve of points \[m\], with `sides` vertices a ring.
///
/// The vertices of point i are `sides i` and the following ones; those of the two ends come last.
pub(super) fn tube(curve: &[Vec3], radius: f64, sides: u32) -> Surface {
    let (mut corners, mut faces) = (Vec::new(), Vec::new());
    let tangent = |i: usize| {
        let (before, after) = (i.saturating_sub(1), (i + 1).min(curve.len() - 1));
        (curve[after] - curve[before]).normalize()
    };
    // The normal is carried along the curve without a twist.
    let mut normal = tangent(0).cross(&Vec3::new(0.31, 0.87, 0.38));
    for (i, &p) in curve.iter().enumerate() {
        let along = tangent(i);
        normal = (normal - along * along.dot(&normal)).normalize();
        let across = along.cross(&normal);
        for k in 0..sides {
            let angle = std::f64::consts::TAU * f64::from(k) / f64::from(sides);
            let offset = (normal * angle.cos() + across * angle.sin()) * radius;
            corners.push(to_f32(p + offset));
        }
    }
    let rings = index_u32(curve.len());
    let at = |ring: u32, k: u32| ring * sides + k % sides;
    for (ring, k) in (0..rings - 1).flat_map(|ring| (0..sides).map(move |k| (ring, k))) {
        let (a, b) = (at(ring, k), at(ring, k + 1));
        let (c, d) = (at(ring + 1, k + 1), at(ring + 1, k));
        faces.extend([[a, b, c], [a, c, d]]);
    }
    for (ring, is_last) in [(0, false), (rings - 1, true)] {
        let center = index_u32(corners.len());
        corners.push(to_f32(curve[ring as usize]));
        faces.extend((0..sides).map(|k| match (at(ring, k), at(ring, k + 1)) {
            (a, b) if is_last => [center, a, b],
            (a, b) => [center, b, a],
        }));
    }
    Surface::from_triangles(&corners, &faces).expect("a tube is an oriented manifold")
}
