//! Self-intersection test for the triangles of a patch.

use incise_mesh::Vec3;
use robust::{Coord3D, orient3d};

/// Maximum number of triangles to test; the number of pairs can grow with its square.
const MAX_TRIANGLES: usize = 20_000;

/// Returns whether two triangles cross: an edge of one pierces the interior of the other.
///
/// Decides by exact signs. Triangles that share an edge are not tested, and contact does not count.
pub(super) fn is_self_intersecting(points: &[Vec3], triangles: &[[u32; 3]]) -> bool {
    if triangles.len() > MAX_TRIANGLES {
        return false;
    }
    let at = |v: u32| points[v as usize];
    let mut boxes: Vec<([Vec3; 2], [u32; 3])> = (triangles.iter())
        .map(|&t| {
            let [a, b, c] = t.map(at);
            ([a.inf(&b).inf(&c), a.sup(&b).sup(&c)], t)
        })
        .collect();
    boxes.sort_by(|x, y| x.0[0].x.total_cmp(&y.0[0].x));
    boxes.iter().enumerate().any(|(i, &([low, high], t))| {
        let near = boxes[i + 1..].iter().take_while(|(b, _)| b[0].x <= high.x);
        near.filter(|(b, _)| (1..3).all(|k| b[0][k] <= high[k] && low[k] <= b[1][k]))
            .any(|&(_, u)| cross(t, u, at))
    })
}

fn cross(t: [u32; 3], u: [u32; 3], at: impl Fn(u32) -> Vec3) -> bool {
    let shared = t.iter().filter(|v| u.contains(v)).count();
    shared < 2 && (is_pierced(t, u, &at) || is_pierced(u, t, &at))
}

/// Returns whether an edge of `u` pierces the interior of `t`.
fn is_pierced(t: [u32; 3], u: [u32; 3], at: &impl Fn(u32) -> Vec3) -> bool {
    let coord = |v: u32| {
        let p = at(v);
        Coord3D {
            x: p.x,
            y: p.y,
            z: p.z,
        }
    };
    let [a, b, c] = t.map(coord);
    (0..3).any(|k| {
        let ends = [u[k], u[(k + 1) % 3]];
        if ends.iter().any(|v| t.contains(v)) {
            return false;
        }
        let [p, q] = ends.map(coord);
        if orient3d(a, b, c, p) * orient3d(a, b, c, q) >= 0.0 {
            return false;
        }
        let sides = [(a, b), (b, c), (c, a)].map(|(x, y)| orient3d(p, q, x, y));
        sides.iter().all(|&s| s > 0.0) || sides.iter().all(|&s| s < 0.0)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crossing_differs_from_contact() {
        let base = [
            Vec3::new(0.0, 0.0, 0.0),
            Vec3::new(4.0, 0.0, 0.0),
            Vec3::new(0.0, 4.0, 0.0),
        ];
        let other = |low: f64| {
            [
                Vec3::new(1.0, 1.0, low),
                Vec3::new(1.5, 1.0, 2.0),
                Vec3::new(1.0, 1.5, 2.0),
            ]
        };
        for (low, crosses) in [(-1.0, true), (0.0, false), (0.5, false)] {
            let points = [base, other(low)].concat();
            let found = is_self_intersecting(&points, &[[0, 1, 2], [3, 4, 5]]);
            assert_eq!(found, crosses, "from {low}");
            let turned = is_self_intersecting(&points, &[[5, 3, 4], [0, 2, 1]]);
            assert_eq!(turned, crosses, "from {low}, the other way round");
        }
        // Triangles with a common corner may still cross.
        let points = [
            &base[..],
            &[Vec3::new(2.0, 1.0, -1.0), Vec3::new(2.0, 1.0, 1.0)],
        ]
        .concat();
        assert!(
            is_self_intersecting(&points, &[[0, 1, 2], [0, 3, 4]]),
            "a fin"
        );
        assert!(
            !is_self_intersecting(&points, &[[0, 1, 2], [0, 1, 4]]),
            "a fold"
        );
    }
}
