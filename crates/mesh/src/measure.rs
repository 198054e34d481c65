//! Area, volume and mean edge of a surface, summed in 64 bits.

use crate::geometry::{Vec3, area_vector};
use crate::ids::{TriangleId, VertexId};
use crate::surface::Surface;

impl Surface {
    /// Returns the area of the whole surface \[m^2\].
    #[must_use]
    pub fn area(&self) -> f64 {
        self.topology()
            .triangles()
            .map(|t| area_vector(self.triangle_positions(t)).norm() / 2.0)
            .sum()
    }

    /// Returns the enclosed volume \[m^3\], positive for outward normals.
    ///
    /// Cavities count negative. Meaningless for a surface with boundaries.
    #[must_use]
    pub fn volume(&self) -> f64 {
        self.volume_of(self.topology().triangles())
    }

    /// Returns the volume of every piece \[m^3\] by piece number; 0 for unused numbers.
    #[must_use]
    pub fn piece_volumes(&self) -> Vec<f64> {
        let mut volumes = vec![0.0; self.piece_bound() as usize];
        let center = self.bounds().center();
        for t in self.topology().triangles() {
            volumes[self.piece(t) as usize] += cone_volume(self.triangle_positions(t), center);
        }
        volumes
    }

    /// Returns by piece number whether the piece has a boundary: whether it is a sheet. O(n).
    #[must_use]
    pub fn open_pieces(&self) -> Vec<bool> {
        let mut is_open = vec![false; self.piece_bound() as usize];
        for t in self.topology().triangles() {
            let twins = t.half_edges().map(|h| self.topology().twin(h));
            is_open[self.piece(t) as usize] |= twins.iter().any(|h| h.is_null());
        }
        is_open
    }

    /// Returns the volume between `triangles` and the center of the surface's bounding box \[m^3\].
    ///
    /// The center keeps the terms of the sum small for surfaces far from the origin.
    #[must_use]
    pub fn volume_of(&self, triangles: impl Iterator<Item = TriangleId>) -> f64 {
        let center = self.bounds().center();
        triangles
            .map(|t| cone_volume(self.triangle_positions(t), center))
            .sum()
    }

    /// Returns the volume of `triangles` in the rest shape \[m^3\], see [`Surface::volume_of`].
    #[must_use]
    pub fn rest_volume_of(&self, triangles: impl Iterator<Item = TriangleId>) -> f64 {
        let corner = |t: TriangleId| self.topology().triangle(t).map(|v| self.rest_position(v));
        let mut apex = None;
        triangles
            .map(|t| {
                let corners = corner(t);
                cone_volume(corners, *apex.get_or_insert(corners[0]))
            })
            .sum()
    }

    /// Returns a third of the rest area of the triangles at each vertex \[m^2\], shape \[vertex
    /// slots\].
    #[must_use]
    pub fn lumped_rest_areas(&self) -> Vec<f64> {
        let mut areas = vec![0.0; self.topology().vertex_slots()];
        for t in self.topology().triangles() {
            let corners = self.topology().triangle(t);
            let area = area_vector(corners.map(|v| self.rest_position(v))).norm() / 2.0;
            for v in corners {
                areas[v.index()] += area / 3.0;
            }
        }
        areas
    }

    /// Returns the mean edge length \[m\]; 0 without edges.
    #[must_use]
    pub fn mean_edge_length(&self) -> f64 {
        self.mean_length(|v| self.position(v))
    }

    /// Returns the mean rest length of edges \[m\]; 0 without edges.
    #[must_use]
    pub fn mean_rest_edge_length(&self) -> f64 {
        self.mean_length(|v| self.rest_position(v))
    }

    fn mean_length(&self, position: impl Fn(VertexId) -> Vec3) -> f64 {
        let (mut sum, mut count) = (0.0, 0.0);
        for h in self.topology().edges() {
            let ends = [self.topology().origin(h), self.topology().target(h)];
            sum += (position(ends[0]) - position(ends[1])).norm();
            count += 1.0;
        }
        if count > 0.0 { sum / count } else { 0.0 }
    }

    /// Returns the mean length of the sides of triangles \[m\]; 0 without triangles.
    #[must_use]
    pub fn mean_edge_length_of(&self, triangles: impl IntoIterator<Item = TriangleId>) -> f64 {
        let (mut sum, mut count) = (0.0, 0.0);
        for t in triangles {
            let [a, b, c] = self.triangle_positions(t);
            sum += (b - a).norm() + (c - b).norm() + (a - c).norm();
            count += 3.0;
        }
        if count > 0.0 { sum / count } else { 0.0 }
    }
}

/// Returns the signed volume of the tetrahedron of `apex` and a triangle \[m^3\].
pub(crate) fn cone_volume([a, b, c]: [Vec3; 3], apex: Vec3) -> f64 {
    (a - apex).dot(&(b - apex).cross(&(c - apex))) / 6.0
}
