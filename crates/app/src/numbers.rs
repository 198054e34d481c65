//! Numbers of a command line.

/// N numbers of a command line.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Numbers<const N: usize>(pub(crate) [f64; N]);

/// Finite numbers between commas.
pub(crate) fn numbers<const N: usize>(text: &str) -> Result<Numbers<N>, String> {
    let values: Option<Vec<f64>> = text
        .split(',')
        .map(|s| s.trim().parse().ok().filter(|x: &f64| x.is_finite()))
        .collect();
    values
        .and_then(|v| v.try_into().ok())
        .map(Numbers)
        .ok_or_else(|| format!("expected {N} numbers, separated by commas"))
}

/// A positive number, or a fraction of two.
pub(crate) fn positive(text: &str) -> Result<f64, String> {
    let number = |s: &str| s.trim().parse::<f64>().ok();
    let value = match text.split_once('/') {
        Some((above, below)) => number(above).zip(number(below)).map(|(a, b)| a / b),
        None => number(text),
    };
    value
        .filter(|v| v.is_finite() && *v > 0.0)
        .ok_or_else(|| format!("'{text}' is not a positive number or fraction"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fractions_are_numbers() {
        assert_eq!(positive("1/60"), Ok(1.0 / 60.0));
        for bad in ["0", "-1", "1/0", "a", "1/2/3", "nan"] {
            assert!(positive(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn there_are_as_many_numbers_as_are_needed() {
        assert_eq!(numbers::<3>("1, -2,3e1").unwrap().0, [1.0, -2.0, 30.0]);
        for bad in ["1,2", "1,2,3,4", "1,2,inf", ""] {
            assert!(numbers::<3>(bad).is_err(), "{bad}");
        }
    }
}
