//! Means, medians and percentiles of measurements.

/// Returns the mean; NaN without values.
#[expect(
    clippy::cast_precision_loss,
    reason = "a run has far fewer than 2^53 values"
)]
pub(crate) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Returns the smallest value that `percent` of the sorted values do not exceed; NaN without
/// values.
pub(crate) fn percentile(sorted: &[f64], percent: usize) -> f64 {
    let rank = (sorted.len() * percent).div_ceil(100);
    let value = sorted.get(rank.saturating_sub(1));
    value.copied().unwrap_or(f64::NAN)
}

/// Sorts values.
pub(crate) fn sorted(mut values: Vec<f64>) -> Vec<f64> {
    values.sort_unstable_by(f64::total_cmp);
    values
}

/// Returns the median, the lower of two; NaN without values.
pub(crate) fn median(values: Vec<f64>) -> f64 {
    percentile(&sorted(values), 50)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_values() {
        assert_eq!(percentile(&[1.0, 2.0, 3.0], 99), 3.0);
        let hundred: Vec<f64> = (1..=100).map(f64::from).collect();
        assert_eq!(percentile(&hundred, 99), 99.0);
        assert_eq!(median(vec![9.0, 1.0, 5.0]), 5.0);
        assert_eq!(median(vec![9.0, 1.0, 5.0, 10.0]), 5.0);
        assert!(median(Vec::new()).is_nan());
    }
}
