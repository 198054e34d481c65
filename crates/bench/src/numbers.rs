//! Numbers as text, for printed tables and the report.

/// Formats a number with fixed digits; a dash for none and NaN.
pub(crate) fn fixed(x: impl Into<Option<f64>>, digits: usize) -> String {
    match x.into() {
        Some(x) if x.is_finite() => format!("{x:.digits$}"),
        _ => "-".to_owned(),
    }
}

/// Formats a ratio with two significant digits; a dash for none and negative ratios.
pub(crate) fn ratio(x: impl Into<Option<f64>>) -> String {
    match x.into() {
        Some(x) if x.is_finite() && x >= 0.0 => fixed(x, usize::from(x < 10.0)),
        _ => "-".to_owned(),
    }
}

/// Formats a number of any size in few digits; a dash for none.
pub(crate) fn short(x: impl Into<Option<f64>>) -> String {
    match x.into() {
        None => "-".to_owned(),
        Some(x) if x == 0.0 || (1e-3..1e5).contains(&x.abs()) => {
            let text = format!("{x:.4}");
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        }
        Some(x) => format!("{x:.2e}"),
    }
}

/// Formats a number with an exponent; a dash for none.
#[cfg(feature = "reference")]
pub(crate) fn exponent(x: Option<f64>) -> String {
    x.map_or_else(|| "-".to_owned(), |x| format!("{x:.1e}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_none_is_a_dash() {
        let texts = [0.0, 1.0, 1.25, -0.5, 1e-9, 1.5e6].map(short);
        assert_eq!(texts, ["0", "1", "1.25", "-0.5", "1.00e-9", "1.50e6"]);
        assert_eq!(short(None), "-");
        let texts = [Some(2.345), Some(23.45), Some(-1.0), None].map(ratio);
        assert_eq!(texts, ["2.3", "23", "-", "-"]);
        assert_eq!(
            [fixed(None, 1), fixed(f64::NAN, 1), fixed(2.0, 1)],
            ["-", "-", "2.0"]
        );
    }
}
