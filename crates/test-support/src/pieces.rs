//! Pieces of a body: volumes, and how far they are from their rest shapes.

use incise_mesh::{Surface, Vec3, VertexId};
use nalgebra::Matrix3;

/// A piece of a body.
#[derive(Debug, Clone, Copy)]
pub struct Piece {
    /// Volume at rest \[m³\].
    pub rest_volume: f64,
    /// Volume now \[m³\].
    pub volume: f64,
    /// Root mean square distance of vertices from the rest shape, moved rigidly, by its diagonal.
    pub deviation: f64,
}

/// Returns the pieces of a surface.
#[must_use]
pub fn pieces(surface: &Surface) -> Vec<Piece> {
    let topology = surface.topology();
    let mut volumes = vec![[0.0; 2]; surface.piece_bound() as usize];
    for t in topology.triangles() {
        let sums = &mut volumes[surface.piece(t) as usize];
        let [a, b, c] = topology.triangle(t).map(|v| surface.rest_position(v));
        sums[0] += a.dot(&b.cross(&c)) / 6.0;
        let [a, b, c] = surface.triangle_positions(t);
        sums[1] += a.dot(&b.cross(&c)) / 6.0;
    }
    let mut vertices: Vec<(u32, VertexId)> = topology
        .vertices()
        .map(|v| (surface.piece(topology.outgoing(v).triangle()), v))
        .collect();
    vertices.sort_unstable();
    let of_piece = |vertices: &[(u32, VertexId)]| {
        let [rest_volume, volume] = volumes[vertices[0].0 as usize];
        let points: Vec<[Vec3; 2]> = vertices
            .iter()
            .map(|&(_, v)| [surface.rest_position(v), surface.position(v)])
            .collect();
        Piece {
            rest_volume,
            volume,
            deviation: deviation(&points),
        }
    };
    vertices.chunk_by(|a, b| a.0 == b.0).map(of_piece).collect()
}

/// Returns the root mean square distance of points from their rest places, moved by the best rigid
/// motion (Kabsch 1976), by the diagonal of these.
fn deviation(points: &[[Vec3; 2]]) -> f64 {
    let count = points.len() as f64;
    let mean = |k: usize| points.iter().map(|p| p[k]).sum::<Vec3>() / count;
    let [rest, now] = [mean(0), mean(1)];
    let covariance: Matrix3<f64> = points
        .iter()
        .map(|p| (p[1] - now) * (p[0] - rest).transpose())
        .sum();
    let svd = covariance.svd(true, true);
    let (Some(mut u), Some(v)) = (svd.u, svd.v_t) else {
        return f64::NAN;
    };
    if (u * v).determinant() < 0.0 {
        let reflected = -u.column(2);
        u.set_column(2, &reflected);
    }
    let rotation = u * v;
    let squares = points
        .iter()
        .map(|p| (rotation * (p[0] - rest) - (p[1] - now)).norm_squared());
    let low = points.iter().fold(points[0][0], |low, p| low.inf(&p[0]));
    let high = points.iter().fold(points[0][0], |high, p| high.sup(&p[0]));
    (squares.sum::<f64>() / count).sqrt() / (high - low).norm()
}
