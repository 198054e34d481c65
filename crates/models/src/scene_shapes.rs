//! Surfaces of solver scenes: a rectangular sheet and a double cone. Motions of a whole surface.

use incise_mesh::geometry::to_f32;
use incise_mesh::{Surface, Vec3, VertexId};

/// Returns a rectangular sheet of `counts` squares across and down, with a total `size` \[m\].
///
/// It lies in the plane of x and y with its upper left corner at the origin. Each square has two
/// triangles; diagonals alternate, so that no direction is stiffer. The vertex in `row` and
/// `column` is `row * (counts[0] + 1) + column`.
///
/// # Panics
/// If the ids exceed 32 bits.
#[must_use]
pub fn sheet(counts: [u32; 2], size: [f32; 2]) -> Surface {
    let [across, down] = counts;
    let (mut points, mut faces) = (Vec::new(), Vec::new());
    for row in 0..=down {
        for column in 0..=across {
            let [x, y] = [column as f32 / across as f32, row as f32 / down as f32];
            points.push([size[0] * x, -size[1] * y, 0.0]);
            if row < down && column < across {
                let a = row * (across + 1) + column;
                let (b, c, d) = (a + 1, a + across + 1, a + across + 2);
                if (row + column) % 2 == 0 {
                    faces.extend([[a, c, d], [a, d, b]]);
                } else {
                    faces.extend([[a, c, b], [b, c, d]]);
                }
            }
        }
    }
    Surface::from_triangles(&points, &faces).expect("a grid is an oriented manifold")
}

/// Returns a closed double cone: a ring of `n` vertices of radius 1 m and two apexes of valence
/// `n`.
///
/// The ring is at y = 1 m, the apexes 0.5 m above and below. Sines come from the platform, so the
/// last bits may differ between machines.
///
/// # Panics
/// If `n` is less than 3.
#[must_use]
pub fn double_cone(n: u32) -> Surface {
    let mut points = vec![[0.0, 1.5, 0.0], [0.0, 0.5, 0.0]];
    points.extend((0..n).map(|i| {
        let angle = std::f32::consts::TAU * i as f32 / n as f32;
        [angle.cos(), 1.0, angle.sin()]
    }));
    let sides = (0..n).map(|i| (2 + i, 2 + (i + 1) % n));
    let faces: Vec<[u32; 3]> = sides.flat_map(|(a, b)| [[0, b, a], [1, a, b]]).collect();
    Surface::from_triangles(&points, &faces).expect("a ring of three or more vertices")
}

/// Moves every vertex with its rest position \[m\].
pub fn place(surface: &mut Surface, to: impl Fn(Vec3) -> Vec3) {
    for i in 0..surface.positions().len() {
        let rest = to(surface.rest_position(VertexId::from_index(i)));
        surface.rest_positions_mut()[i] = to_f32(rest);
    }
    pose(surface, to);
}

/// Moves every vertex; rest positions stay \[m\].
pub fn pose(surface: &mut Surface, mut to: impl FnMut(Vec3) -> Vec3) {
    for i in 0..surface.positions().len() {
        let [x, y, z] = to_f32(to(surface.position(VertexId::from_index(i))));
        surface.positions_mut()[i] = [x, y, z, surface.positions()[i][3]];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sheet_has_two_triangles_for_each_square() {
        let surface = sheet([4, 3], [2.0, 1.5]);
        surface.validate().unwrap();
        assert_eq!(surface.topology().triangle_count(), 24);
        assert_eq!(surface.topology().vertex_count(), 20);
        assert_eq!(surface.topology().boundary_loops().len(), 1);
        assert!((surface.area() - 3.0).abs() < 1e-6, "{}", surface.area());
    }

    #[test]
    fn a_double_cone_is_closed() {
        let surface = double_cone(7);
        surface.validate_closed().unwrap();
        assert_eq!(surface.topology().triangle_count(), 14);
        assert!(surface.volume() > 0.0, "{}", surface.volume());
    }
}
