//! Surfaces of cases with contacts: boxes of any cells, and a rope along a curve.

use super::error::StressError;
use incise_mesh::geometry::to_f32;
use incise_mesh::{Surface, Vec3};
use std::collections::BTreeMap;

/// Returns a box around the origin with sides of those lengths \[m\], `cells` squares along each.
///
/// # Errors
/// None for at least one cell along each side.
pub(super) fn box_of(sides: [f64; 3], cells: [u32; 3]) -> Result<Surface, StressError> {
    let (mut corners, mut faces) = (Vec::new(), Vec::new());
    let mut numbers: BTreeMap<[u32; 3], u32> = BTreeMap::new();
    let mut vertex = |at: [u32; 3]| {
        *numbers.entry(at).or_insert_with(|| {
            let place = |k: usize| sides[k] * (f64::from(at[k]) / f64::from(cells[k]) - 0.5);
            corners.push(to_f32(Vec3::new(place(0), place(1), place(2))));
            u32::try_from(corners.len() - 1).unwrap_or(u32::MAX)
        })
    };
    for axis in 0..3 {
        let (one, other) = ((axis + 1) % 3, (axis + 2) % 3);
        for (level, is_top) in [(0, false), (cells[axis], true)] {
            for i in 0..cells[one] {
                for j in 0..cells[other] {
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
    }
    surface(&corners, &faces)
}

/// Returns a tube of a radius \[m\] around a curve of points \[m\], with `sides` vertices a ring.
///
/// The vertices of point i are `sides i` and the following ones; those of the two ends come last.
///
/// # Errors
/// None for a curve of at least two points without sharp bends.
pub(super) fn rope(curve: &[Vec3], radius: f64, sides: u32) -> Result<Surface, StressError> {
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
            corners.push(to_f32(
                p + (normal * angle.cos() + across * angle.sin()) * radius,
            ));
        }
    }
    let rings = u32::try_from(curve.len()).unwrap_or(u32::MAX);
    let at = |ring: u32, k: u32| ring * sides + k % sides;
    for ring in 0..rings - 1 {
        for k in 0..sides {
            let (a, b) = (at(ring, k), at(ring, k + 1));
            let (c, d) = (at(ring + 1, k + 1), at(ring + 1, k));
            faces.extend([[a, b, c], [a, c, d]]);
        }
    }
    for (ring, is_last) in [(0, false), (rings - 1, true)] {
        let center = u32::try_from(corners.len()).unwrap_or(u32::MAX);
        corners.push(to_f32(curve[ring as usize]));
        for k in 0..sides {
            let (a, b) = (at(ring, k), at(ring, k + 1));
            faces.push(if is_last {
                [center, a, b]
            } else {
                [center, b, a]
            });
        }
    }
    surface(&corners, &faces)
}

fn surface(corners: &[[f32; 3]], faces: &[[u32; 3]]) -> Result<Surface, StressError> {
    Surface::from_triangles(corners, faces)
        .map_err(|error| StressError::Invariant(error.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_and_ropes_are_closed_and_have_their_volumes() {
        let plate = box_of([1.0, 0.1, 2.0], [3, 1, 4]).unwrap();
        assert!((plate.volume() - 0.2).abs() < 1e-6);
        assert_eq!(
            box_of([1.0; 3], [1; 3])
                .unwrap()
                .topology()
                .triangle_count(),
            12
        );
        let line: Vec<Vec3> = (0..9).map(|i| Vec3::new(f64::from(i), 0.0, 0.0)).collect();
        let rope = rope(&line, 0.1, 6).unwrap();
        let hexagon = 1.5 * 3.0_f64.sqrt() * 0.01;
        assert!(
            (rope.volume() - 8.0 * hexagon).abs() < 1e-6,
            "{}",
            rope.volume()
        );
        assert!(rope.topology().is_closed() && plate.topology().is_closed());
    }
}
