//! How good triangles are: statistics of angles and edge lengths.

use crate::geometry::{Vec3, corner_angles};
use serde::Serialize;

/// Angles at the corners of triangles \[degrees\].
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct AngleStats {
    /// The smallest.
    pub min: f64,
    /// A twentieth of all angles is no larger.
    pub percentile_5: f64,
    /// Half of all angles are no larger.
    pub median: f64,
    /// The largest.
    pub max: f64,
}

impl AngleStats {
    /// The statistics of `triangles`; zeros when there are none. A corner beside an edge of no
    /// length has the angle 0.
    #[must_use]
    pub fn of(triangles: impl IntoIterator<Item = [Vec3; 3]>) -> Self {
        let mut angles: Vec<f64> = triangles
            .into_iter()
            .flat_map(corner_angles)
            .map(f64::to_degrees)
            .collect();
        if angles.is_empty() {
            return Self::default();
        }
        angles.sort_unstable_by(f64::total_cmp);
        // Nearest rank: the smallest angle that at least this part of all does not exceed.
        let rank = |part: usize, of: usize| angles[(angles.len() * part).div_ceil(of) - 1];
        Self {
            min: angles[0],
            percentile_5: rank(1, 20),
            median: rank(1, 2),
            max: angles[angles.len() - 1],
        }
    }
}

/// Lengths of the sides of triangles \[m\]. An edge between two triangles counts twice, a boundary
/// edge once.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct EdgeStats {
    /// The shortest.
    pub min: f64,
    /// The mean.
    pub mean: f64,
    /// The longest.
    pub max: f64,
}

impl EdgeStats {
    /// The statistics of `triangles`; zeros when there are none.
    #[must_use]
    pub fn of(triangles: impl IntoIterator<Item = [Vec3; 3]>) -> Self {
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
        let angles = AngleStats::of([t]);
        assert!((angles.max - 90.0).abs() < 1e-12);
        assert!((angles.min - (3.0f64 / 4.0).atan().to_degrees()).abs() < 1e-12);
        assert_eq!(angles.percentile_5, angles.min);
        let edges = EdgeStats::of([t, t]);
        assert_eq!((edges.min, edges.mean, edges.max), (3.0, 4.0, 5.0));
    }

    #[test]
    fn nothing_has_zeros() {
        assert_eq!(AngleStats::of([]), AngleStats::default());
        assert_eq!(EdgeStats::of([]), EdgeStats::default());
    }
}
