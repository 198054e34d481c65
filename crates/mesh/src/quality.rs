//! Triangle quality: statistics of angles and edge lengths.

use crate::geometry::{Vec3, corner_angles};

/// Statistics of the angles of triangles \[degrees\].
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct AngleStats {
    /// Minimum.
    pub min: f64,
    /// 5th percentile.
    pub percentile_5: f64,
    /// Median.
    pub median: f64,
    /// Maximum.
    pub max: f64,
}

impl AngleStats {
    /// Computes the statistics of `triangles`; zeros without triangles.
    ///
    /// A corner beside an edge of zero length has the angle 0.
    #[must_use]
    pub fn from_triangles(triangles: impl IntoIterator<Item = [Vec3; 3]>) -> Self {
        let mut angles: Vec<f64> = triangles
            .into_iter()
            .flat_map(corner_angles)
            .map(f64::to_degrees)
            .collect();
        if angles.is_empty() {
            return Self::default();
        }
        angles.sort_unstable_by(f64::total_cmp);
        // Nearest-rank percentile.
        let rank = |part: usize, of: usize| angles[(angles.len() * part).div_ceil(of) - 1];
        Self {
            min: angles[0],
            percentile_5: rank(1, 20),
            median: rank(1, 2),
            max: angles[angles.len() - 1],
        }
    }
}

/// Statistics of the side lengths of triangles \[m\].
///
/// An edge between two triangles counts twice, a boundary edge once.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct EdgeStats {
    /// Minimum.
    pub min: f64,
    /// Mean.
    pub mean: f64,
    /// Maximum.
    pub max: f64,
}

impl EdgeStats {
    /// Computes the statistics of `triangles`; zeros without triangles.
    #[must_use]
    pub fn from_triangles(triangles: impl IntoIterator<Item = [Vec3; 3]>) -> Self {
        let (mut min, mut max) = (f64::INFINITY, 0.0f64);
        let (mut sum, mut count) = (0.0, 0.0);
        for [a, b, c] in triangles {
            for length in [(b - a).norm(), (c - b).norm(), (a - c).norm()] {
                min = min.min(length);
                max = max.max(length);
                sum += length;
                count += 1.0;
            }
        }
        if count > 0.0 {
            Self {
                min,
                mean: sum / count,
                max,
            }
        } else {
            Self::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_right_triangle_has_its_angles_and_sides() {
        let t = [
            Vec3::zeros(),
            Vec3::new(3.0, 0.0, 0.0),
            Vec3::new(0.0, 4.0, 0.0),
        ];
        let angles = AngleStats::from_triangles([t]);
        assert!((angles.max - 90.0).abs() < 1e-12);
        assert!((angles.min - (3.0f64 / 4.0).atan().to_degrees()).abs() < 1e-12);
        assert_eq!(angles.percentile_5, angles.min);
        let edges = EdgeStats::from_triangles([t, t]);
        assert_eq!((edges.min, edges.mean, edges.max), (3.0, 4.0, 5.0));
    }

    #[test]
    fn nothing_has_zeros() {
        assert_eq!(AngleStats::from_triangles([]), AngleStats::default());
        assert_eq!(EdgeStats::from_triangles([]), EdgeStats::default());
    }
}
