//! [`PieceShapes`]: the rest shape of a body's pieces, as far as contact detection needs it.
//!
//! `body.rs` keeps them and measures them again after a change of topology.

use incise_mesh::geometry::area_vector;
use incise_mesh::{Surface, TriangleId, Vec3};

/// The rest shape of a piece.
#[derive(Debug, Clone, Copy, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct PieceShape {
    /// Whether it has a boundary, so that it has no inside.
    pub(crate) is_sheet: bool,
    /// Whether its normals point inward: it is the wall of a hollow.
    pub(crate) is_cavity: bool,
    /// Twice its volume by its area \[m\]: the distance between the sides of a plate.
    pub(crate) thickness: f64,
    /// Volume, 0 for a sheet [m^3].
    pub(crate) volume: f64,
}

/// The shapes of a body's pieces, in memory reused between cuts.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct PieceShapes {
    /// [`Surface::fingerprint`] at the last measurement.
    version: Option<u64>,
    /// By piece number.
    shapes: Vec<PieceShape>,
    #[cfg_attr(feature = "serde", serde(skip))]
    sums: Vec<Sums>,
}

/// Sums over the triangles of a piece.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    /// A corner of its first triangle, from which volumes are measured \[m\].
    apex: Option<Vec3>,
    /// Six times the volume \[m^3\].
    volume: f64,
    /// Twice the area \[m^2\].
    area: f64,
}

impl PieceShapes {
    /// Measures the pieces of a surface, unless it has the topology of the last measurement. O(n).
    pub(crate) fn update(&mut self, surface: &Surface) {
        let version = surface.fingerprint();
        if self.version.replace(version) == Some(version) {
            return;
        }
        let pieces = surface.piece_bound() as usize;
        self.shapes.clear();
        self.shapes.resize(pieces, PieceShape::default());
        self.sums.clear();
        self.sums.resize(pieces, Sums::default());
        let topology = surface.topology();
        for t in topology.triangles() {
            let piece = surface.piece(t) as usize;
            let mut twins = t.half_edges().into_iter().map(|h| topology.twin(h));
            self.shapes[piece].is_sheet |= twins.any(|twin| twin.is_null());
            self.sums[piece].add(surface, t);
        }
        for (shape, sums) in self.shapes.iter_mut().zip(&self.sums) {
            shape.is_cavity = !shape.is_sheet && sums.volume < 0.0;
            if !shape.is_sheet {
                shape.volume = sums.volume.abs() / 6.0;
            }
            if sums.area > 0.0 {
                shape.thickness = 2.0 / 3.0 * sums.volume.abs() / sums.area;
            }
        }
    }

    /// Returns the shape of a piece by its number.
    pub(crate) fn get(&self, piece: u32) -> PieceShape {
        let shape = self.shapes.get(piece as usize);
        shape.copied().unwrap_or_default()
    }
}

impl Sums {
    /// Adds a triangle at rest.
    fn add(&mut self, surface: &Surface, t: TriangleId) {
        let corners = surface.topology().triangle(t);
        let [a, b, c] = corners.map(|v| surface.rest_position(v));
        let apex = *self.apex.get_or_insert(a);
        let area = area_vector([a, b, c]);
        self.volume += area.dot(&(a - apex));
        self.area += area.norm();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use incise_mesh::{cube_sphere, sheet};

    #[test]
    fn a_plate_is_as_thick_as_its_sides_are_apart() {
        let mut plate = cube_sphere(4, 1.0);
        let mut shapes = PieceShapes::default();
        shapes.update(&plate);
        // A ball of radius r has 2 V / A = 2 r / 3.
        let ball = shapes.get(0).thickness;
        assert!((ball / (2.0 / 3.0) - 1.0).abs() < 0.05, "{ball} m");
        for p in plate.rest_positions_mut() {
            let largest = p.iter().fold(0.0_f32, |a, c| a.max(c.abs()));
            *p = [p[0] / largest, 0.005 * p[1] / largest, p[2] / largest];
        }
        let mut shapes = PieceShapes::default();
        shapes.update(&plate);
        assert!((shapes.get(0).thickness / 0.01 - 1.0).abs() < 0.02);
        shapes.update(&sheet([1.0; 2], [3; 2]));
        assert!(shapes.get(0).is_sheet);
    }
}
