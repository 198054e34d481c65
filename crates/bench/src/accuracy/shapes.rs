//! Sheets, strips and bars for the scenes.

use incise_mesh::{Surface, TopologyError, Vec3};
use incise_models::place;
use incise_models::scenes::cuboid;

/// A sheet of `across` by `along` squares of side `size` \[m\] in the plane of x and z; diagonals
/// alternate. Vertex `i (along + 1) + j` is at x = `i size`, z =
/// `j size`.
pub(super) fn sheet(across: u32, along: u32, size: f32) -> Result<Surface, TopologyError> {
    let mut points = Vec::new();
    let mut faces = Vec::new();
    for i in 0..=across {
        for j in 0..=along {
            points.push([i as f32 * size, 0.0, j as f32 * size]);
            if i < across && j < along {
                let a = i * (along + 1) + j;
                let (b, c, d) = (a + 1, a + along + 2, a + along + 1);
                if (i + j) % 2 == 0 {
                    faces.extend([[a, b, c], [a, c, d]]);
                } else {
                    faces.extend([[a, b, d], [b, c, d]]);
                }
            }
        }
    }
    Surface::from_triangles(&points, &faces)
}

/// A zigzag strip of `points` particles, `size` \[m\] apart along x.
pub(super) fn zigzag(points: u32, size: f32) -> Result<Surface, TopologyError> {
    let at = |i: u32| [0.5 * i as f32 * size, 0.0, (i % 2) as f32 * 0.866 * size];
    let faces: Vec<[u32; 3]> = (2..points)
        .map(|i| {
            if i % 2 == 0 {
                [i - 2, i - 1, i]
            } else {
                [i - 1, i - 2, i]
            }
        })
        .collect();
    Surface::from_triangles(&(0..points).map(at).collect::<Vec<_>>(), &faces)
}

/// A closed box of `n` cubes a side of `size` \[m\], a corner at the origin.
pub(super) fn bar(n: [u32; 3], size: f64) -> Surface {
    let sides = n.map(|count| f64::from(count) * size);
    let mut surface = cuboid(sides, n);
    place(&mut surface, |p| p + Vec3::from(sides) / 2.0);
    surface
}
