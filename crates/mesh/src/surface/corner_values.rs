//! All attributes of a corner and of a triangle's corners, to copy and interpolate them together.

use super::Surface;
use super::channels::{Blend, Row};
use crate::edit::Edit;
use crate::geometry::{Vec3, to_f32, to_f64};
use crate::ids::{HalfEdge, TriangleId, VertexId};

/// The texture coordinates, the normal and the rows of corner channels of one corner.
///
/// Attributes that the surface lacks are absent.
#[derive(Debug, Clone, PartialEq)]
pub struct CornerValues {
    pub(crate) uv: Option<[f32; 2]>,
    pub(crate) normal: Option<[f32; 3]>,
    /// Rows of the corner channels in their order, each with its width and rule.
    pub(crate) rows: Vec<(Row, usize, Blend)>,
}

impl CornerValues {
    /// Returns the interpolation of three corners of one surface by weights that sum to 1.
    ///
    /// A corner with the weight 1 is returned bit for bit. Other normals have the length 1, or are
    /// zero where the parents cancel.
    #[must_use]
    pub fn interpolate(corners: [&Self; 3], weights: [f32; 3]) -> Self {
        if let Some(k) = weights.iter().position(|&w| w == 1.0) {
            return corners[k].clone();
        }
        let [a, b, c] = corners;
        let rows = (a.rows.iter().zip(&b.rows)).zip(&c.rows);
        let shares = weights.map(f64::from);
        Self {
            uv: all([a.uv, b.uv, c.uv]).map(|values| sum(values, weights)),
            normal: all([a.normal, b.normal, c.normal]).map(|values| unit_sum(values, shares)),
            rows: rows
                .map(|((a, b), c)| {
                    let rows = [(a.0, shares[0]), (b.0, shares[1]), (c.0, shares[2])];
                    (a.2.rows(a.1, rows), a.1, a.2)
                })
                .collect(),
        }
    }

    /// Returns whether each attribute is the mean of two corners' with the weights `1 - t` and `t`.
    ///
    /// It may differ by `tolerance` times the distance between both, and by rounding.
    #[must_use]
    pub fn is_mean(&self, [a, b]: [&Self; 2], t: f32, tolerance: f64) -> bool {
        let mean = Self::interpolate([a, b, b], [1.0 - t, t, 0.0]);
        let is_near = |own: &[f32], mean: &[f32], a: &[f32], b: &[f32]| {
            let rounding = 4.0 * f64::from(f32::EPSILON) * distance(own, &[]);
            distance(own, mean) <= tolerance * distance(a, b) + rounding
        };
        let uv = [self.uv, mean.uv, a.uv, b.uv].map(Option::unwrap_or_default);
        let normal = [self.normal, mean.normal, a.normal, b.normal].map(Option::unwrap_or_default);
        let mut rows = (self.rows.iter().zip(&mean.rows)).zip(a.rows.iter().zip(&b.rows));
        is_near(&uv[0], &uv[1], &uv[2], &uv[3])
            && is_near(&normal[0], &normal[1], &normal[2], &normal[3])
            && rows.all(|((own, mean), (a, b))| is_near(&own.0, &mean.0, &a.0, &b.0))
    }

    /// Returns whether the normals differ by at most `tolerance` and other attributes by nothing.
    #[must_use]
    pub fn is_like(&self, other: &Self, tolerance: f64) -> bool {
        let normals = [self.normal, other.normal].map(Option::unwrap_or_default);
        self.uv == other.uv
            && self.rows == other.rows
            && distance(&normals[0], &normals[1]) <= tolerance
    }

    /// Returns whether the surface has no attributes of corners.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.uv.is_none() && self.normal.is_none() && self.rows.is_empty()
    }
}

/// Returns the distance between two rows; missing values are 0.
fn distance(a: &[f32], b: &[f32]) -> f64 {
    let others = b.iter().copied().chain(std::iter::repeat(0.0));
    let squares = (a.iter().zip(others)).map(|(&x, y)| (f64::from(x) - f64::from(y)).powi(2));
    squares.sum::<f64>().sqrt()
}

fn all<T>([a, b, c]: [Option<T>; 3]) -> Option<[T; 3]> {
    Some([a?, b?, c?])
}

fn sum<const N: usize>(values: [[f32; N]; 3], weights: [f32; 3]) -> [f32; N] {
    std::array::from_fn(|i| (0..3).map(|k| weights[k] * values[k][i]).sum())
}

/// Returns the direction of a weighted sum of normals; zero if they cancel.
fn unit_sum(normals: [[f32; 3]; 3], weights: [f64; 3]) -> [f32; 3] {
    let sum: Vec3 = (0..3).map(|k| to_f64(normals[k]) * weights[k]).sum();
    to_f32(sum.try_normalize(0.0).unwrap_or_default())
}

impl Surface {
    /// Returns all attributes of the corner at `h`.
    #[must_use]
    pub fn corner_values(&self, h: HalfEdge) -> CornerValues {
        CornerValues {
            uv: self.corners.uv.get(h.index()).copied(),
            normal: self.corners.normal.get(h.index()).copied(),
            rows: self
                .corner_channels()
                .map(|c| (c.copy_row(h.index()), c.width(), c.blend()))
                .collect(),
        }
    }

    /// Returns whether two corners of a vertex have equal attributes: no seam separates them.
    #[must_use]
    pub fn has_equal_corners(&self, a: HalfEdge, b: HalfEdge) -> bool {
        let [a, b] = [a, b].map(HalfEdge::index);
        let (uvs, normals) = (&self.corners.uv, &self.corners.normal);
        uvs.get(a) == uvs.get(b)
            && normals.get(a) == normals.get(b)
            && (self.corner_channels()).all(|channel| channel.row(a) == channel.row(b))
    }
}

/// The vertices and corner attributes of a triangle, kept for an edit that replaces it.
#[derive(Debug, Clone)]
pub struct TriangleCorners {
    /// The triangle.
    pub triangle: TriangleId,
    /// Its vertices.
    pub vertices: [VertexId; 3],
    values: [CornerValues; 3],
}

impl TriangleCorners {
    /// Reads a triangle of the surface.
    #[must_use]
    pub fn new(surface: &Surface, triangle: TriangleId) -> Self {
        Self {
            triangle,
            vertices: surface.topology().triangle(triangle),
            values: triangle.half_edges().map(|h| surface.corner_values(h)),
        }
    }

    /// Returns whether the surface has no attributes of corners.
    #[must_use]
    pub fn is_plain(&self) -> bool {
        self.values[0].is_empty()
    }

    /// Sets the attributes of a new corner to the weighted sum of the three old ones.
    ///
    /// See [`CornerValues::interpolate`].
    pub fn interpolate(&self, edit: &mut Edit<'_>, h: HalfEdge, weights: [f32; 3]) {
        let values = CornerValues::interpolate(self.values.each_ref(), weights);
        edit.set_corner_values(h, &values);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn interpolated_normals_have_the_length_one() {
        let corner = |normal| CornerValues {
            uv: None,
            normal: Some(normal),
            rows: Vec::new(),
        };
        let [x, y] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(corner);
        let normal = CornerValues::interpolate([&x, &y, &y], [0.5, 0.25, 0.25]).normal;
        let half = 0.5f32.sqrt();
        assert_eq!(normal, Some([half, half, 0.0]));
        let back = corner([-1.0, 0.0, 0.0]);
        let normal = CornerValues::interpolate([&x, &back, &y], [0.5, 0.5, 0.0]).normal;
        assert_eq!(normal, Some([0.0; 3]));
    }
}
