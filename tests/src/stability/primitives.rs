//! Builds closed primitives: fans, prisms, needles, rods, plates, tubes and tori.

use incise_mesh::geometry::to_f32;
use incise_mesh::{Surface, Vec3};
use std::f64::consts::TAU;

/// Returns the point of a regular polygon of `n` corners around the y axis, at a height \[m\].
fn corner(i: u32, n: u32, radius: f64, height: f64) -> Vec3 {
    let angle = TAU * f64::from(i) / f64::from(n);
    Vec3::new(radius * angle.cos(), height, radius * angle.sin())
}

/// Builds a surface with its normals outward.
fn outward(points: &[Vec3], mut faces: Vec<[u32; 3]>) -> Surface {
    let at = |v: u32| points[v as usize];
    let volume = |&[a, b, c]: &[u32; 3]| at(a).dot(&at(b).cross(&at(c)));
    if faces.iter().map(volume).sum::<f64>() < 0.0 {
        faces.iter_mut().for_each(|face| face.swap(1, 2));
    }
    let points: Vec<[f32; 3]> = points.iter().map(|&p| to_f32(p)).collect();
    Surface::from_triangles(&points, &faces).expect("a closed mesh")
}

/// Appends the two triangles of a square with corners in order.
fn square(faces: &mut Vec<[u32; 3]>, [a, b, c, d]: [u32; 4]) {
    faces.extend([[a, b, c], [a, c, d]]);
}

/// Returns two cones over a polygon, whose apexes have `n` edges.
pub(super) fn bipyramid(n: u32, radius: f64, height: f64) -> Surface {
    let mut points: Vec<Vec3> = (0..n).map(|i| corner(i, n, radius, 0.0)).collect();
    points.extend([0.5, -0.5].map(|y| Vec3::new(0.0, y * height, 0.0)));
    let sides = (0..n).map(|i| (i, (i + 1) % n));
    let faces = sides.flat_map(|(i, j)| [[i, j, n], [j, i, n + 1]]);
    outward(&points, faces.collect())
}

/// Returns a prism of `n` sides and `rows` rows of squares, with fans as caps.
///
/// The fans leave a vertex in the center, or a corner.
pub(super) fn prism([n, rows]: [u32; 2], radius: f64, height: f64, has_center: bool) -> Surface {
    let mut points = Vec::new();
    let mut faces = Vec::new();
    for row in 0..=rows {
        let y = height * (f64::from(row) / f64::from(rows) - 0.5);
        points.extend((0..n).map(|i| corner(i, n, radius, y)));
        for i in (0..n).filter(|_| row > 0) {
            let (a, b) = (n * row + i, n * row + (i + 1) % n);
            square(&mut faces, [a - n, a, b, b - n]);
        }
    }
    for (first, is_top) in [(0, false), (n * rows, true)] {
        let mut cap = |a: u32, b: u32, c: u32| {
            faces.push(if is_top { [a, c, b] } else { [a, b, c] });
        };
        if has_center {
            let center = incise_mesh::index_u32(points.len());
            points.push(Vec3::new(
                0.0,
                if is_top { 0.5 } else { -0.5 } * height,
                0.0,
            ));
            (0..n).for_each(|i| cap(center, first + i, first + (i + 1) % n));
        } else {
            (1..n - 1).for_each(|i| cap(first, first + i, first + i + 1));
        }
    }
    outward(&points, faces)
}

/// Returns a torus of `n` by `k` squares with radii of its ring and of its section.
pub(super) fn torus([n, k]: [u32; 2], ring: f64, section: f64) -> Surface {
    let mut points = Vec::new();
    let mut faces = Vec::new();
    for i in 0..n {
        for j in 0..k {
            let angle = TAU * f64::from(j) / f64::from(k);
            let (radius, height) = (ring + section * angle.cos(), section * angle.sin());
            points.push(corner(i, n, radius, height));
            let at = |i: u32, j: u32| i % n * k + j % k;
            square(
                &mut faces,
                [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)],
            );
        }
    }
    outward(&points, faces)
}

/// Returns a tube with outer and inner radius.
pub(super) fn tube(n: u32, [outer, inner]: [f64; 2], height: f64) -> Surface {
    let mut points = Vec::new();
    let mut faces = Vec::new();
    let rings = [(outer, -0.5), (outer, 0.5), (inner, 0.5), (inner, -0.5)];
    for (row, (radius, y)) in (0..).zip(rings) {
        points.extend((0..n).map(|i| corner(i, n, radius, y * height)));
        for i in 0..n {
            let at = |row: u32, i: u32| row % 4 * n + i % n;
            let next = row + 1;
            square(
                &mut faces,
                [at(row, i), at(next, i), at(next, i + 1), at(row, i + 1)],
            );
        }
    }
    outward(&points, faces)
}
