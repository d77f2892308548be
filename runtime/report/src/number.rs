//! Formats numbers for the page: rounded, with a typographic minus sign and powers of ten.

/// Default number of significant digits.
pub(super) const DIGITS: usize = 4;

/// The number `value` with `digits` significant digits. Trailing zeros of a fraction are kept, because they
/// are measured digits.
pub(super) fn rounded(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return unusual(value);
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    let digits = digits.clamp(1, 17);
    let scientific = format!("{value:.*e}", digits - 1);
    let Some((mantissa, exponent)) = scientific.split_once('e') else {
        return scientific;
    };
    let exponent: i32 = exponent.parse().unwrap_or(0);
    let last = i32::try_from(digits).unwrap_or(i32::MAX);
    let text = if (-4..last.max(6)).contains(&exponent) {
        let decimals = usize::try_from(last - 1 - exponent).unwrap_or(0);
        format!("{value:.decimals$}")
    } else {
        format!("{mantissa}·10{}", superscript(exponent))
    };
    text.replace('-', "−")
}

/// Largest number of digits of a described number on the page. The JSON and CSV files contain all digits.
pub(super) const MOST_DIGITS: usize = 9;

/// The number `value` with all its digits, but at most [`MOST_DIGITS`].
pub(super) fn exact(value: f64) -> String {
    if !value.is_finite() {
        return unusual(value);
    }
    let shown: f64 = format!("{value:.*e}", MOST_DIGITS - 1).parse().unwrap_or(value);
    let shortest = format!("{shown:?}");
    let text = match shortest.split_once('e') {
        Some((digits, exponent)) => {
            let exponent = exponent.parse().map_or_else(|_| String::new(), superscript);
            format!("{digits}·10{exponent}")
        }
        None => shortest.strip_suffix(".0").unwrap_or(&shortest).to_owned(),
    };
    text.replace('-', "−")
}

/// The number `value` with at most `digits` significant digits, in a format that programs can read.
pub(super) fn plain(value: f64, digits: usize) -> String {
    let shown: f64 = format!("{value:.*e}", digits.clamp(1, 17) - 1).parse().unwrap_or(value);
    let is_usual = shown == 0.0 || (1e-4..1e6).contains(&shown.abs()) || !shown.is_finite();
    // Adding 0 replaces a negative zero by 0.
    if is_usual { (shown + 0.0).to_string() } else { format!("{shown:e}") }
}

fn unusual(value: f64) -> String {
    let text = match value {
        value if value.is_nan() => "not a number",
        value if value > 0.0 => "∞",
        _ => "−∞",
    };
    text.to_owned()
}

fn superscript(exponent: i32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let small = |c: char| match c.to_digit(10) {
        Some(digit) => DIGITS.get(digit as usize).copied().unwrap_or(c),
        None => '⁻',
    };
    exponent.to_string().chars().map(small).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_rounded_for_people() {
        for (value, digits, shown) in [
            (0.0, 4, "0"),
            (44.8, 4, "44.80"),
            (-0.000_123_45, 3, "−0.000123"),
            (1.0e-7, 2, "1.0·10⁻⁷"),
            (123_456.0, 3, "123456"),
            (1.5e9, 3, "1.50·10⁹"),
            (9.9996, 4, "10.00"),
            (f64::NAN, 4, "not a number"),
            (f64::NEG_INFINITY, 4, "−∞"),
        ] {
            assert_eq!(rounded(value, digits), shown);
        }
    }

    #[test]
    fn numbers_of_terminals_are_short() {
        for (value, digits, shown) in [
            (-0.0, 9, "0"),
            (0.1 + 0.2, 9, "0.3"),
            (-60_000.0, 9, "-60000"),
            (2.5e6, 9, "2.5e6"),
            (5.267e-5, 2, "5.3e-5"),
            (f64::INFINITY, 9, "inf"),
        ] {
            assert_eq!(plain(value, digits), shown);
        }
    }

    #[test]
    fn described_numbers_keep_their_digits() {
        for (value, shown) in [
            (161.0, "161"),
            (5.267e-5, "5.267·10⁻⁵"),
            (-9.80665, "−9.80665"),
            (2.617_993_877_991_494_4, "2.61799388"),
        ] {
            assert_eq!(exact(value), shown);
        }
    }
}
