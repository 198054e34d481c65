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

/// Returns the parameters of the ends of a polyline and of the points at which it bends in either
/// of two poses.
///
/// Between two of them, both poses are linear in the parameter, up to `tolerance` \[m\].
pub(super) fn bends(poses: [&[[f32; 3]]; 2], tolerance: f64) -> Vec<f64> {
    #[expect(clippy::cast_precision_loss, reason = "few points")]
    let parameters: Vec<f64> = (0..poses[0].len()).map(|i| i as f64).collect();
    let is_straight = |from: usize, to: usize| {
        (from + 1..to).all(|i| {
            let part = (parameters[i] - parameters[from]) / (parameters[to] - parameters[from]);
            poses.iter().all(|line| {
                let [start, own, end] = [from, i, to].map(|i| to_f64(line[i]));
                (start.lerp(&end, part) - own).norm() <= tolerance
            })
        })
    };
    let mut bends = vec![0];
    for i in 1..parameters.len() {
        let last = bends[bends.len() - 1];
        if i + 1 == parameters.len() || !is_straight(last, i + 1) {
            bends.push(i);
        }
    }
    bends.into_iter().map(|i| parameters[i]).collect()
}

/// Returns the parameter of the point of a polyline that is level with `place` along the
/// polyline's chord, and the distance by which that is beyond an end \[m\].
///
/// Of several, the one nearest to the parameter `near`. The polyline has points with ascending
/// parameters.
pub(super) fn level_with(line: &[(f64, Vec3)], place: Vec3, near: f64) -> (f64, f64) {
    let [(first, start), (last, end)] = [line[0], line[line.len() - 1]];
    let chord = (end - start).try_normalize(0.0).unwrap_or_default();
    let level = |p: Vec3| chord.dot(&(p - place));
    let crossings = line.windows(2).filter_map(|ends| {
        let [from, to] = [ends[0], ends[1]].map(|point| level(point.1));
        let is_crossed = (from <= 0.0) != (to <= 0.0);
        is_crossed.then(|| ends[0].0 + (ends[1].0 - ends[0].0) * from / (from - to))
    });
    let nearest = crossings.min_by(|a, b| (a - near).abs().total_cmp(&(b - near).abs()));
    match nearest {
        Some(parameter) => (parameter, 0.0),
        None if level(start) > 0.0 => (first, level(start)),
        None => (last, -level(end)),
    }
}

/// Returns the part of the way `along` at which a point is, given the vector to it from the start;
/// none without a length.
pub(super) fn part_along(along: Vec3, to: Vec3) -> Option<f64> {
    let part = along.dot(&to) / along.norm_squared();
    (!part.is_nan()).then_some(part)
}

/// Returns the vector from a point to the nearest point of a blade whose ends go on straight.
pub(super) fn offset(blade: &[[f32; 3]], from: Vec3) -> Vec3 {
    let segments = blade.windows(2).enumerate().map(|(i, ends)| {
        let [a, b] = [ends[0], ends[1]].map(to_f64);
        let along = b - a;
        let low = if i == 0 { f64::NEG_INFINITY } else { 0.0 };
        let high = if i + 2 == blade.len() {
            f64::INFINITY
        } else {
            1.0
        };
        let part = part_along(along, from - a).map_or(0.0, |part| part.clamp(low, high));
        a + along * part - from
    });
    let nearest = segments.min_by(|a, b| a.norm_squared().total_cmp(&b.norm_squared()));
    nearest.unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_is_level_with_the_nearest_of_several_points() {
        let line = [
            (0.0, [0.0, 0.0, 0.0]),
            (1.0, [3.0, 1.0, 0.0]),
            (2.0, [1.0, 2.0, 0.0]),
            (3.0, [4.0, 0.0, 0.0]),
        ];
        let line = line.map(|(parameter, p)| (parameter, Vec3::from(p)));
        for (place, near, expected) in [
            ([0.3, 9.0, 0.0], 2.0, (0.1, 0.0)),
            ([2.0, 5.0, 1.0], 0.5, (2.0 / 3.0, 0.0)),
            ([2.0, 5.0, 1.0], 1.4, (1.5, 0.0)),
            ([2.0, 5.0, 1.0], 3.0, (2.0 + 1.0 / 3.0, 0.0)),
            ([-1.5, 1.0, 0.0], 2.0, (0.0, 1.5)),
            ([6.0, 1.0, 0.0], 1.0, (3.0, 2.0)),
        ] {
            let found = level_with(&line, Vec3::from(place), near);
            assert!((found.0 - expected.0).abs() < 1e-12, "{place:?}: {found:?}");
            assert!((found.1 - expected.1).abs() < 1e-12, "{place:?}: {found:?}");
        }
    }

    #[test]
    fn a_polyline_bends_where_it_is_not_linear_in_its_parameter() {
        let straight = [0.0, 1.0, 2.0, 3.0, 4.0].map(|x| [x, 0.0, 0.0]);
        let uneven = [0.0, 0.5, 2.0, 3.0, 4.0].map(|x| [x, 0.0, 0.0]);
        let bent = [0.0, 0.0, 0.0, 1.0, 2.0].map(|y| [y, y, 0.0]);
        for (other, expected) in [
            (straight, vec![0.0, 4.0]),
            (uneven, vec![0.0, 1.0, 2.0, 4.0]),
            (bent, vec![0.0, 2.0, 4.0]),
        ] {
            assert_eq!(bends([&straight, &other], 1e-9), expected);
            assert_eq!(bends([&other, &straight], 1e-9), expected);
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
