//! A rectangular sheet, the simplest surface with a boundary.

use crate::geometry::{Vec3, to_f32};
use crate::surface::Surface;

/// Returns a rectangular sheet in the plane z = 0, centered at the origin, with normal +z.
///
/// `size` is the extent along x and y \[m\], `cells` the number of squares along each; 0 counts as
/// 1. Each square has two triangles, with alternating diagonals.
///
/// # Panics
/// If the ids exceed 32 bits.
#[must_use]
pub fn sheet(size: [f64; 2], cells: [u32; 2]) -> Surface {
    let [m, n] = cells.map(|count| count.max(1));
    let place = |i: u32, count: u32, k: usize| size[k] * (f64::from(i) / f64::from(count) - 0.5);
    let mut positions = Vec::new();
    let mut faces = Vec::new();
    for j in 0..=n {
        for i in 0..=m {
            positions.push(to_f32(Vec3::new(place(i, m, 0), place(j, n, 1), 0.0)));
        }
    }
    for j in 0..n {
        for i in 0..m {
            let at = |i: u32, j: u32| j * (m + 1) + i;
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            faces.extend(if (i + j) % 2 == 0 {
                [[a, b, c], [a, c, d]]
            } else {
                [[a, b, d], [b, c, d]]
            });
        }
    }
    Surface::from_triangles(&positions, &faces).expect("a grid is an oriented manifold")
}
