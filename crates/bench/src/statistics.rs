//! What many measurements come to.

/// The mean; not a number when there are none.
#[expect(
    clippy::cast_precision_loss,
    reason = "a run has far fewer than 2^53 cuts"
)]
pub(crate) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// The smallest value that 99% of the sorted values do not exceed.
pub(crate) fn percentile_99(sorted: &[f64]) -> f64 {
    let rank = (sorted.len() * 99).div_ceil(100);
    sorted
        .get(rank.wrapping_sub(1))
        .copied()
        .unwrap_or(f64::NAN)
}

/// The middle of the sorted values, the lower one of two; not a number when there are none.
pub(crate) fn median(sorted: &[f64]) -> f64 {
    let middle = sorted.len().wrapping_sub(1) / 2;
    sorted.get(middle).copied().unwrap_or(f64::NAN)
}

/// The slope of the straight line that fits points best (least squares); not a number when that is
/// any line.
pub(crate) fn slope(points: &[[f64; 2]]) -> f64 {
    let [x, y] = [0, 1].map(|k| mean(&points.iter().map(|p| p[k]).collect::<Vec<f64>>()));
    let along: f64 = points.iter().map(|p| (p[0] - x) * (p[0] - x)).sum();
    let up: f64 = points.iter().map(|p| (p[0] - x) * (p[1] - y)).sum();
    up / along
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_99th_percentile_of_few_values_is_the_largest() {
        assert_eq!(percentile_99(&[1.0, 2.0, 3.0]), 3.0);
        let hundred: Vec<f64> = (1..=100).map(f64::from).collect();
        assert_eq!(percentile_99(&hundred), 99.0);
        assert!(percentile_99(&[]).is_nan());
    }

    #[test]
    fn the_median_has_half_of_the_values_on_each_side() {
        assert_eq!(median(&[1.0, 5.0, 9.0]), 5.0);
        assert_eq!(median(&[1.0, 5.0, 9.0, 10.0]), 5.0);
        assert!(median(&[]).is_nan());
    }

    #[test]
    fn a_line_has_its_slope() {
        let noise = [0.1, -0.1, -0.1, 0.1];
        let points = [0.0, 1.0, 2.0, 3.0].map(|x: f64| [x, 2.0 - 0.5 * x]);
        assert!((slope(&points) + 0.5).abs() < 1e-15);
        let noisy = [0, 1, 2, 3].map(|i: usize| [points[i][0], points[i][1] + noise[i]]);
        assert!(
            (slope(&noisy) + 0.5).abs() < 1e-15,
            "this noise has no slope"
        );
        assert!(slope(&points[..1]).is_nan());
    }
}
