//! Area, volume and moments of a surface, summed in f64.

use crate::geometry::{Vec3, area_vector};
use crate::ids::TriangleId;
use crate::surface::Surface;

impl Surface {
    /// The area of the whole surface \[m^2\].
    #[must_use]
    pub fn area(&self) -> f64 {
        self.topology()
            .triangles()
            .map(|t| area_vector(self.triangle_positions(t)).norm() / 2.0)
            .sum()
    }

    /// The volume that the whole surface encloses \[m^3\], positive when normals point outward.
    /// Cavities count negative. Meaningless for a surface with boundaries.
    #[must_use]
    pub fn volume(&self) -> f64 {
        self.volume_of(self.topology().triangles())
    }

    /// The volume of every piece \[m^3\], indexed by piece number; 0 for numbers not in use.
    #[must_use]
    pub fn piece_volumes(&self) -> Vec<f64> {
        let mut volumes = vec![0.0; self.piece_bound() as usize];
        let center = self.bounds().center();
        for t in self.topology().triangles() {
            volumes[self.piece(t) as usize] += cone_volume(self.triangle_positions(t), center);
        }
        volumes
    }

    /// The volume under `triangles` \[m^3\]: their cones from the middle of the surface's box, which
    /// keeps the sum's terms as small as the surface however far from the origin it is.
    #[must_use]
    pub fn volume_of(&self, triangles: impl Iterator<Item = TriangleId>) -> f64 {
        let center = self.bounds().center();
        triangles
            .map(|t| cone_volume(self.triangle_positions(t), center))
            .sum()
    }

    /// The volume under `triangles` at rest \[m^3\], see [`Surface::volume_of`]. Closed surfaces only.
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

    /// A third of the rest area of every triangle, at each of its corners \[m^2\], shape \[vertex slots\].
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

    /// The mean length of all edges \[m\]; 0 without edges.
    #[must_use]
    pub fn mean_edge_length(&self) -> f64 {
        let (mut sum, mut count) = (0.0, 0.0);
        for h in self.topology().edges() {
            sum += (self.position(self.topology().origin(h))
                - self.position(self.topology().target(h)))
            .norm();
            count += 1.0;
        }
        if count > 0.0 { sum / count } else { 0.0 }
    }
}

/// The signed volume of the cone from `apex` over a triangle \[m^3\].
pub(crate) fn cone_volume([a, b, c]: [Vec3; 3], apex: Vec3) -> f64 {
    (a - apex).dot(&(b - apex).cross(&(c - apex))) / 6.0
}
