//! Moves the pieces of a body apart for a picture.

use incise_mesh::geometry::{to_f32, to_f64};
use incise_mesh::{Surface, Vec3};

/// Returns the mean of the triangle corners of every piece \[m\].
pub(crate) fn centers(surface: &Surface) -> Vec<Vec3> {
    let mut sums = vec![(Vec3::zeros(), 0.0); surface.piece_bound() as usize];
    for t in surface.topology().triangles() {
        let (sum, count) = &mut sums[surface.piece(t) as usize];
        *sum += surface.triangle_positions(t).iter().sum::<Vec3>();
        *count += 3.0;
    }
    sums.iter()
        .map(|(sum, count)| sum / f64::max(*count, 1.0))
        .collect()
}

/// Moves every piece by its own displacement \[m\].
pub(crate) fn move_pieces(surface: &mut Surface, moves: &[Vec3]) {
    let mut piece_of = vec![None; surface.topology().vertex_slots()];
    for t in surface.topology().triangles() {
        for v in surface.topology().triangle(t) {
            piece_of[v.index()] = Some(surface.piece(t));
        }
    }
    for (position, piece) in surface.positions_mut().iter_mut().zip(piece_of) {
        let Some(piece) = piece else { continue };
        let [x, y, z, weight] = *position;
        let [x, y, z] = to_f32(to_f64([x, y, z]) + moves[piece as usize]);
        *position = [x, y, z, weight];
    }
}
