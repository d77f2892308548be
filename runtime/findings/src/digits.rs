//! Rounding of numbers to the second significant digit of their standard error.

/// Largest number of significant digits of an f64.
const MOST_DIGITS: i32 = 17;
/// Largest number of decimals without an exponent.
const MOST_DECIMALS: i32 = 12;

/// Returns `value` as text, rounded to the decimal place of the second significant digit of `error`. The
/// text has at most 17 significant digits.
///
/// - `error`: standard error. If it is `None`, zero or not finite, the result is the shortest text that reads
///   back as `value`.
///
/// Examples: 76.5561 with the error 0.0312 gives `76.556`, and 12345.0 with the error 120.0 gives `12350`.
pub fn rounded(value: f64, error: Option<f64>) -> String {
    let Some(decimals) = decimals(error).filter(|_| value.is_finite()) else {
        return format!("{value:?}");
    };
    if value != 0.0 && magnitude(value) + 1 + decimals > MOST_DIGITS {
        return format!("{value:?}");
    }
    if value.abs() < 0.5 * 10_f64.powi(-decimals) {
        "0.0".into()
    } else if decimals > MOST_DECIMALS {
        let digits = (magnitude(value) + decimals).max(0);
        format!("{value:.*e}", digits as usize)
    } else if decimals >= 0 {
        format!("{value:.*}", decimals as usize)
    } else {
        let unit = 10_f64.powi(-decimals);
        format!("{:.0}", (value / unit).round() * unit)
    }
}

/// Returns the text of [`rounded`] with a decimal point or an exponent, for formats that distinguish
/// integers from floating-point numbers.
pub fn literal(value: f64, error: Option<f64>) -> String {
    let text = rounded(value, error);
    if text.contains(['.', 'e', 'N', 'i']) { text } else { text + ".0" }
}

/// Returns the value with its error as text, for example `76.556 ± 0.031`. If the error is unknown, the
/// text has only the value.
pub fn with_error(value: f64, error: Option<f64>) -> String {
    match error.filter(|_| decimals(error).is_some()) {
        Some(e) => format!("{} ± {}", rounded(value, error), rounded(e, error)),
        None => rounded(value, None),
    }
}

/// Returns the number of significant digits of [`rounded`], at least 1; `None` if the error is unknown.
pub fn significant(value: f64, error: Option<f64>) -> Option<usize> {
    let decimals = decimals(error).filter(|_| value.is_finite())?;
    let digits = if value == 0.0 { 1 } else { magnitude(value) + 1 + decimals };
    Some(digits.clamp(1, MOST_DIGITS).unsigned_abs() as usize)
}

/// Returns whether [`rounded`] gives 0.
pub fn vanishes(value: f64, error: Option<f64>) -> bool {
    rounded(value, error).parse::<f64>() == Ok(0.0)
}

/// Returns `value` as text with at most `digits` significant digits, without trailing zeros, for example
/// `0` or `31.62`. Numbers with a magnitude below 1e-4 or of at least 1e6 have an exponent.
pub fn plain(value: f64, digits: usize) -> String {
    let digits = digits.clamp(1, MOST_DIGITS.unsigned_abs() as usize);
    let rounded: f64 = format!("{value:.*e}", digits - 1).parse().unwrap_or(value);
    match rounded.abs() {
        0.0 => "0".into(),
        size if (1e-4..1e6).contains(&size) || !size.is_finite() => rounded.to_string(),
        _ => format!("{rounded:e}"),
    }
}

/// Rounds a non-zero number to two significant digits.
pub fn two_digits(x: f64) -> f64 {
    let scale = 10_f64.powf(x.abs().log10().floor() - 1.0);
    let rounded = (x / scale).round();
    if scale >= 1.0 { rounded * scale } else { rounded / (1.0 / scale).round() }
}

/// Returns the decimal place of the second significant digit of the error; `None` if the error is unknown.
fn decimals(error: Option<f64>) -> Option<i32> {
    let error = error.filter(|e| e.is_finite() && *e > 0.0)?;
    Some(1 - magnitude(error))
}

/// Returns the exponent of ten of a number after rounding to two digits. For example, 0.0996 counts as
/// 0.10.
fn magnitude(x: f64) -> i32 {
    let text = format!("{:.1e}", x.abs());
    text.split_once('e').and_then(|(_, exponent)| exponent.parse().ok()).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_digits_of_the_error_decide() {
        assert_eq!(with_error(76.556_12, Some(0.0312)), "76.556 ± 0.031");
        assert_eq!(with_error(76.556_12, Some(0.0996)), "76.56 ± 0.10");
        assert_eq!(with_error(-3.924, Some(2.0)), "-3.9 ± 2.0");
        assert_eq!(with_error(12_345.0, Some(123.0)), "12350 ± 120");
        assert_eq!(rounded(3.212e-6, Some(4.1e-8)), "0.000003212");
        assert_eq!(rounded(3.212_49e-16, Some(4.1e-18)), "3.212e-16");
        assert_eq!(rounded(-0.001, Some(0.1)), "0.0");
        assert_eq!(rounded(1e-20, Some(4.1e-18)), "0.0");
    }

    #[test]
    fn numbers_are_as_people_write_them() {
        let cases = [
            (31.622_776, "31.62"),
            (0.0, "0"),
            (-0.0, "0"),
            (5.0, "5"),
            (0.000_123_456, "0.0001235"),
            (-1.25e-9, "-1.25e-9"),
            (123_456.0, "123500"),
            (9.999_96, "10"),
            (1e6, "1e6"),
            (-2.5e12, "-2.5e12"),
            (f64::INFINITY, "inf"),
            (f64::NAN, "NaN"),
        ];
        for (value, expected) in cases {
            assert_eq!(plain(value, 4), expected);
        }
    }

    #[test]
    fn without_an_error_nothing_is_lost() {
        for value in [76.5, 20.0 / 3.0, 8e-17, -1.0] {
            for error in [None, Some(0.0), Some(f64::NAN), Some(1e-30)] {
                assert_eq!(rounded(value, error).parse::<f64>(), Ok(value));
            }
        }
        assert_eq!(with_error(2.5, None), "2.5");
        assert_eq!(rounded(1.0 / 3.0, Some(1e-16)).parse::<f64>(), Ok(1.0 / 3.0));
    }

    #[test]
    fn significant_digits_are_those_that_are_written() {
        let of = |value: f64, error: f64| significant(value, Some(error));
        assert_eq!([of(76.556, 0.0312), of(12_345.0, 123.0), of(-3.9, 2.0)], [Some(5), Some(4), Some(2)]);
        assert_eq!([of(0.003, 0.1), of(0.0, 0.1), of(1.0, 1e-30)], [Some(1), Some(1), Some(17)]);
        assert_eq!([significant(2.5, None), of(2.5, 0.0), of(f64::NAN, 1.0)], [None; 3]);
    }

    #[test]
    fn literals_are_floating_point_numbers() {
        assert_eq!(literal(12_345.0, Some(123.0)), "12350.0");
        assert_eq!(literal(4.0, Some(0.5)), "4.00");
        for text in [literal(77.2, Some(15.0)), literal(1e300, Some(1e298)), literal(3.2e-16, Some(1e-17))] {
            assert!(text.parse::<i128>().is_err() && text.parse::<f64>().is_ok(), "{text}");
        }
    }

    #[test]
    fn what_rounds_to_nothing_vanishes() {
        assert!(vanishes(0.0, None) && vanishes(0.004, Some(0.1)) && vanishes(-0.004, Some(0.1)));
        assert!(!vanishes(0.006, Some(0.1)) && !vanishes(1e-9, None) && !vanishes(40.0, Some(100.0)));
    }
}
