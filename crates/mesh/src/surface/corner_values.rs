//! All attributes of one corner, to copy and interpolate them together.

use super::Surface;
use super::channels::{Blend, Row};
use crate::ids::HalfEdge;

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
    /// A corner with the weight 1 is returned bit for bit.
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
            normal: all([a.normal, b.normal, c.normal]).map(|values| sum(values, weights)),
            rows: rows
                .map(|((a, b), c)| {
                    let rows = [(a.0, shares[0]), (b.0, shares[1]), (c.0, shares[2])];
                    (a.2.rows(a.1, rows), a.1, a.2)
                })
                .collect(),
        }
    }

    /// Returns whether the surface has no attributes of corners.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.uv.is_none() && self.normal.is_none() && self.rows.is_empty()
    }
}

fn all<T>([a, b, c]: [Option<T>; 3]) -> Option<[T; 3]> {
    Some([a?, b?, c?])
}

fn sum<const N: usize>(values: [[f32; N]; 3], weights: [f32; 3]) -> [f32; N] {
    std::array::from_fn(|i| (0..3).map(|k| weights[k] * values[k][i]).sum())
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
}
