//! Planes through saddles of a body, where the section touches itself in a point.

use crate::common::{check, params};
use incise_cut::{Cutter, Sweep};
use incise_mesh::geometry::area_vector;
use incise_mesh::{Surface, TriangleId};

/// Returns a ring with a square profile that stands on its edge, in four segments.
fn ring() -> Surface {
    let mut points = Vec::new();
    for [x, y] in [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]] {
        for [r, z] in [[2.5, 0.0], [2.0, 0.5], [1.5, 0.0], [2.0, -0.5]] {
            points.push([r * x, r * y, z]);
        }
    }
    let mut triangles = Vec::new();
    for i in 0..4u32 {
        for j in 0..4u32 {
            let (k, l) = ((i + 1) % 4, (j + 1) % 4);
            triangles.push([4 * i + j, 4 * k + j, 4 * k + l]);
            triangles.push([4 * i + j, 4 * k + l, 4 * i + l]);
        }
    }
    Surface::from_triangles(&points, &triangles).unwrap()
}

fn area(surface: &Surface, triangles: &[TriangleId]) -> f64 {
    let corners = triangles.iter().map(|&t| surface.triangle_positions(t));
    corners.map(|t| area_vector(t).norm() / 2.0).sum()
}

/// The section is two squares that touch in a corner; both triangles of a neck between were flat.
#[test]
fn a_section_of_two_squares_with_a_common_corner_has_no_neck() {
    let whole = ring();
    assert!((whole.volume() - 4.0).abs() < 1e-5);
    for normal in [
        [0.0, 1.0, 0.0],
        [0.0, -1.0, 0.0],
        [1.0, 0.0, 0.0],
        [-1.0, 0.0, 0.0],
    ] {
        let sweep = Sweep::from_plane(normal, 1.5, &whole.bounds()).unwrap();
        let mut surface = whole.clone();
        let outcome = Cutter::new(&surface)
            .cut(&mut surface, &sweep, &params(0.1))
            .unwrap();
        // Both parts are balls: the ring is open where its ends touch.
        assert_eq!((surface.piece_count(), check(&surface)), (2, 4));
        let mut volumes = surface.piece_volumes();
        volumes.sort_unstable_by(f64::total_cmp);
        assert!((volumes[0] - 0.5).abs() < 1e-5 && (volumes[1] - 3.5).abs() < 1e-5);
        let (below, above) = outcome.cap.split_at(outcome.cap.len() / 2);
        for own in [below, above] {
            assert!(
                (area(&surface, own) - 1.0).abs() < 1e-5,
                "two squares of 0.5"
            );
        }
        for t in surface.topology().triangles() {
            let [a, b, c] = surface.triangle_positions(t);
            for (p, q) in [(a, b), (b, c), (c, a)] {
                assert!((p - q).norm() > 1e-4, "an edge without length at {p:?}");
            }
            assert!(area_vector([a, b, c]).norm() > 1e-5, "{a:?} {b:?} {c:?}");
        }
        let undo = outcome.undo.unwrap();
        let _ = undo.revert(&mut surface).unwrap();
        assert_eq!(surface, whole, "the undo restores every bit");
    }
}
