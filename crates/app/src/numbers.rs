//! Numbers of a command line.

/// N numbers of a command line.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Numbers<const N: usize>(pub(crate) [f64; N]);

/// Finite numbers between commas. An error says which is none.
pub(crate) fn numbers<const N: usize>(text: &str) -> Result<Numbers<N>, String> {
    let mut values = Vec::with_capacity(N);
    for (i, part) in text.split(',').map(str::trim).enumerate() {
        let fault = match part.parse::<f64>() {
            Ok(value) if value.is_finite() => {
                values.push(value);
                continue;
            }
            Ok(_) => "is not finite",
            Err(_) => "is not a number",
        };
        return Err(format!(
            "number {}, '{part}', {fault}: expected {N} finite numbers, separated by commas",
            i + 1
        ));
    }
    let found = values.len();
    (values.try_into().map(Numbers)).map_err(|_| {
        format!("found {found} numbers: expected {N} finite numbers, separated by commas")
    })
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
        for (bad, said) in [
            ("1,2", "found 2 numbers"),
            ("1,2,3,4", "found 4 numbers"),
            ("1,2,inf", "number 3, 'inf', is not finite"),
            ("nan,2,inf", "number 1, 'nan', is not finite"),
            ("1,x,3", "number 2, 'x', is not a number"),
            ("", "number 1, '', is not a number"),
        ] {
            let error = numbers::<3>(bad).unwrap_err();
            assert!(error.starts_with(said), "{bad}: {error}");
            assert!(error.contains("expected 3 finite numbers"), "{error}");
        }
    }
}
