//! Sheets, strips and bars for the scenes.

use incise_mesh::{Surface, TopologyError};

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
pub(super) fn bar(n: [u32; 3], size: f32) -> Result<Surface, TopologyError> {
    let mut points: Vec<[f32; 3]> = Vec::new();
    let side = n.map(|k| k as usize + 1);
    let mut numbers = vec![u32::MAX; side[0] * side[1] * side[2]];
    let mut next = 0..;
    let mut number = |at: [u32; 3]| {
        let [x, y, z] = at.map(|k| k as usize);
        let slot = &mut numbers[(x * side[1] + y) * side[2] + z];
        if *slot == u32::MAX {
            *slot = next.next().unwrap_or(u32::MAX);
            points.push(at.map(|k| k as f32 * size));
        }
        *slot
    };
    let mut faces = Vec::new();
    for axis in 0..3 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        for (level, turned) in [(0, true), (n[axis], false)] {
            for i in 0..n[u] {
                for j in 0..n[v] {
                    let [a, b, c, d] = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[di, dj]| {
                        let mut at = [0; 3];
                        (at[axis], at[u], at[v]) = (level, i + di, j + dj);
                        number(at)
                    });
                    let two = if (i + j) % 2 == 0 {
                        [[a, b, c], [a, c, d]]
                    } else {
                        [[a, b, d], [b, c, d]]
                    };
                    faces.extend(two.map(|[a, b, c]| if turned { [a, c, b] } else { [a, b, c] }));
                }
            }
        }
    }
    Surface::from_triangles(&points, &faces)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_are_what_they_are_called() {
        let sheet = sheet(3, 2, 0.5).unwrap();
        assert_eq!(sheet.topology().triangle_count(), 12);
        let zigzag = zigzag(20, 0.1).unwrap();
        assert_eq!(zigzag.topology().vertex_count(), 20);
        assert_eq!(zigzag.topology().triangle_count(), 18);
        let bar = bar([4, 2, 3], 0.5).unwrap();
        assert_eq!(bar.topology().triangle_count(), 4 * (4 * 2 + 2 * 3 + 3 * 4));
        let volume: f64 = (bar.topology().triangles())
            .map(|t| bar.triangle_positions(t))
            .map(|[a, b, c]| a.dot(&b.cross(&c)) / 6.0)
            .sum();
        assert!((volume - 3.0).abs() < 1e-6, "volume {volume}");
    }
}
