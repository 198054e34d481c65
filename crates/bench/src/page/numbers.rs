//! Numbers as tables have them.

/// A number with so many digits behind the point, or a dash for what cannot be told.
pub(super) fn digits(x: f64, digits: usize) -> String {
    crate::columns::measured(x, digits)
}

/// The same of a number that there may be.
pub(super) fn measured(x: Option<f64>, digits: usize) -> String {
    crate::columns::measured(x.unwrap_or(f64::NAN), digits)
}

/// How many times something is.
pub(super) fn factor(x: Option<f64>) -> String {
    match x {
        Some(x) if x.is_finite() && x >= 0.0 => digits(x, usize::from(x < 10.0)),
        _ => "-".to_owned(),
    }
}

/// A number of any size in few digits.
pub(super) fn brief(x: Option<f64>) -> String {
    match x {
        None => "-".to_owned(),
        Some(x) if x == 0.0 || (1e-3..1e5).contains(&x.abs()) => {
            let text = format!("{x:.4}");
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        }
        Some(x) => format!("{x:.2e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_what_is_none_is_a_dash() {
        let texts = [0.0, 1.0, 1.25, -0.5, 1e-9, 1.5e6].map(|x| brief(Some(x)));
        assert_eq!(texts, ["0", "1", "1.25", "-0.5", "1.00e-9", "1.50e6"]);
        assert_eq!(brief(None), "-");
        let texts = [Some(2.345), Some(23.45), Some(-1.0), None].map(factor);
        assert_eq!(texts, ["2.3", "23", "-", "-"]);
        assert_eq!(measured(None, 1), "-");
    }
}
