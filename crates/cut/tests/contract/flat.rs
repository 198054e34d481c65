//! Parts without volume: two triangles back to back, whose section is an edge followed twice.

use crate::common::{check, params};
use incise_cut::{Cutter, Sweep};
use incise_mesh::geometry::area_vector;
use incise_mesh::{Surface, icosphere};

/// Returns two triangles on the same vertices, back to back.
fn pair() -> Surface {
    let points = [
        [-2.494_062, 1.064_186, 4.900_767],
        [-2.494_062, 1.056_373, 4.853_892],
        [-2.494_062, 1.111_061, 4.846_08],
    ];
    Surface::from_triangles(&points, &[[0, 1, 2], [0, 2, 1]]).unwrap()
}

fn area(surface: &Surface) -> f64 {
    let corners = surface.topology().triangles();
    let corners = corners.map(|t| surface.triangle_positions(t));
    corners.map(|t| area_vector(t).norm() / 2.0).sum()
}

/// Planes across the pair between each two of its vertices, at many angles and heights.
#[test]
fn a_pair_of_triangles_is_cut_and_closed() {
    let whole = pair();
    let bounds = whole.bounds();
    let center = bounds.center();
    let mut cuts = 0;
    for snap in [0.0, 0.1] {
        for k in 0..24u8 {
            let (sin, cos) = (f64::from(k) * 0.261_799).sin_cos();
            for height in [-0.02, -0.01, -0.003, 0.0, 0.004, 0.012, 0.019] {
                let normal = [0.05, cos, sin];
                let d = normal[0] * center.x + cos * center.y + sin * center.z + height;
                let sweep = Sweep::from_plane(normal, d, &bounds).unwrap();
                let mut surface = whole.clone();
                let mut cutter = Cutter::new(&surface);
                let outcome = cutter.cut(&mut surface, &sweep, &params(snap)).unwrap();
                assert_eq!(
                    check(&surface),
                    2 * i64::try_from(surface.piece_count()).unwrap()
                );
                // Snapping moves a vertex by up to a tenth of an edge within the plane of the pair.
                let change = area(&surface) / area(&whole) - 1.0;
                assert!(change.abs() <= snap + 1e-5, "{change}");
                cuts += usize::from(!outcome.is_miss());
                if let Some(undo) = outcome.undo {
                    assert_eq!(surface.piece_count(), 2);
                    let _ = undo.revert(&mut surface).unwrap();
                    assert_eq!(surface, whole, "the undo restores every bit");
                }
            }
        }
    }
    assert!(cuts > 200, "{cuts} of 336 planes cut");
}

/// Such a pair beside a body does not stop the cut of the body.
#[test]
fn a_pair_of_triangles_is_cut_with_a_body() {
    let ball = icosphere(3, 0.5);
    let mut points = ball.rest_positions().to_vec();
    let first = u32::try_from(points.len()).unwrap();
    let topology = ball.topology();
    let mut triangles: Vec<[u32; 3]> = topology
        .triangles()
        .map(|t| topology.triangle(t).map(|v| v.0))
        .collect();
    points.extend([[0.8, -0.2, 0.0], [1.0, 0.3, 0.0], [0.9, 0.3, 0.2]]);
    triangles.extend([[0, 1, 2], [0, 2, 1]].map(|t| t.map(|v: u32| v + first)));
    let mut surface = Surface::from_triangles(&points, &triangles).unwrap();
    let sweep = Sweep::from_plane([0.1, 1.0, 0.0], 0.1, &surface.bounds()).unwrap();
    let mut cutter = Cutter::new(&surface);
    let outcome = cutter.cut(&mut surface, &sweep, &params(0.1)).unwrap();
    assert_eq!(outcome.report.loops, 2);
    assert_eq!((surface.piece_count(), check(&surface)), (4, 8));
    let (above, below) = outcome.cap.split_at(outcome.cap.len() / 2);
    let section = |own: &[incise_mesh::TriangleId]| -> f64 {
        let own = own.iter().map(|&t| surface.triangle_positions(t));
        own.map(|t| area_vector(t).norm() / 2.0).sum()
    };
    // A disc at distance d from the center, less the part between the circle and its chords.
    let d = 0.1 / 1.01_f64.sqrt();
    let disc = std::f64::consts::PI * (0.25 - d * d);
    for own in [above, below] {
        let ratio = section(own) / disc;
        assert!(0.98 < ratio && ratio < 1.0, "{ratio}");
    }
}
