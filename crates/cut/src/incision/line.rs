//! Points of a blade's edge, which is a polyline with a parameter.

use incise_mesh::Vec3;
use incise_mesh::geometry::to_f64;

/// Returns the point of a polyline at a parameter \[m\].
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "parameters are between 0 and the number of points"
)]
pub(super) fn point_at(line: &[[f32; 3]], parameter: f64) -> Vec3 {
    let i = (parameter.floor().max(0.0) as usize).min(line.len() - 2);
    #[expect(clippy::cast_precision_loss, reason = "few points")]
    let part = parameter - i as f64;
    let [a, b] = [line[i], line[i + 1]].map(to_f64);
    a + (b - a) * part
}

/// The point of a polyline nearest to another.
#[derive(Debug, Clone, Copy)]
pub(super) struct Nearest {
    pub(super) parameter: f64,
    pub(super) point: Vec3,
    /// Distance by which the other point is beyond the nearer end of the polyline \[m\].
    pub(super) beyond: f64,
}

/// Returns the point nearest to `to` on a polyline of points with ascending parameters.
pub(super) fn nearest(line: &[(f64, Vec3)], to: Vec3) -> Option<Nearest> {
    let segments = line.windows(2).enumerate().map(|(i, ends)| {
        let [(from, a), (until, b)] = [ends[0], ends[1]];
        let along = b - a;
        let part = along.dot(&(to - a)) / along.norm_squared();
        let clamped = if part.is_nan() {
            0.0
        } else {
            part.clamp(0.0, 1.0)
        };
        let is_end = if clamped == 0.0 {
            i == 0
        } else {
            i + 2 == line.len()
        };
        Nearest {
            parameter: from + (until - from) * clamped,
            point: a + along * clamped,
            beyond: if is_end && part.is_finite() {
                (part - clamped).abs() * along.norm()
            } else {
                0.0
            },
        }
    });
    let distance = |nearest: &Nearest| (nearest.point - to).norm_squared();
    segments.min_by(|a, b| distance(a).total_cmp(&distance(b)))
}

/// Returns the vector from a point to the nearest point of a blade whose ends go on straight.
pub(super) fn offset(blade: &[[f32; 3]], from: Vec3) -> Vec3 {
    let line: Vec<(f64, Vec3)> = blade.iter().map(|&p| (0.0, to_f64(p))).collect();
    let Some(nearest) = nearest(&line, from) else {
        return Vec3::zeros();
    };
    let offset = nearest.point - from;
    if nearest.beyond == 0.0 {
        return offset;
    }
    let n = line.len();
    let is_first = nearest.point == line[0].1;
    let along = if is_first {
        line[0].1 - line[1].1
    } else {
        line[n - 1].1 - line[n - 2].1
    };
    let along = along.try_normalize(0.0).unwrap_or_default();
    offset - along * along.dot(&offset)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_point_is_on_a_segment_or_at_an_end() {
        let line = [
            (0.0, [0.0, 0.0, 0.0]),
            (1.0, [2.0, 0.0, 0.0]),
            (2.0, [2.0, 3.0, 0.0]),
        ];
        let line = line.map(|(parameter, p)| (parameter, Vec3::from(p)));
        for (to, parameter, beyond) in [
            ([1.0, 1.0, 0.0], 0.5, 0.0),
            ([-1.5, 0.5, 0.0], 0.0, 1.5),
            ([2.5, 1.5, 1.0], 1.5, 0.0),
            ([3.0, 7.0, 0.0], 2.0, 4.0),
            ([3.0, -1.0, 0.0], 1.0, 0.0),
        ] {
            let found = nearest(&line, Vec3::from(to)).unwrap();
            assert!(
                (found.parameter - parameter).abs() < 1e-12,
                "{to:?}: {found:?}"
            );
            assert!((found.beyond - beyond).abs() < 1e-12, "{to:?}: {found:?}");
        }
    }

    #[test]
    fn the_offset_from_beyond_an_end_is_across_the_blade() {
        let blade = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]];
        let found = offset(&blade, Vec3::new(3.0, 0.5, 0.0));
        assert!(
            (found - Vec3::new(0.0, -0.5, 0.0)).norm() < 1e-12,
            "{found}"
        );
    }
}
