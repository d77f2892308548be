//! Conversion of text to numbers, and to times without a loss of digits.

/// Decimal sign of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) enum Decimals {
    /// A point: `0.5`
    #[default]
    Point,
    /// A comma: `0,5`
    Comma,
}

/// Returns a number, or NaN for a word that marks a missing value; `None` for other text.
pub(super) fn number(field: &[u8], decimals: Decimals) -> Option<f64> {
    let text = std::str::from_utf8(field.trim_ascii()).ok()?;
    if is_missing(text) {
        return Some(f64::NAN);
    }
    match decimals {
        Decimals::Point => text.parse().ok(),
        // In a file with decimal commas, a point would separate thousands. A missing number is better than a wrong one.
        Decimals::Comma if text.contains('.') => None,
        Decimals::Comma => text.replace(',', ".").parse().ok(),
    }
}

/// Returns whether a text is a word that programs write for a missing number.
fn is_missing(text: &str) -> bool {
    const WORDS: [&str; 7] = ["na", "n/a", "null", "none", "-nan", "-nan(ind)", "nan(ind)"];
    WORDS.iter().any(|word| word.eq_ignore_ascii_case(text))
}

/// Returns a decimal number as a multiple of 10⁻¹², so that epoch times in nanoseconds keep every digit; `None` for other
/// text.
///
/// Digits after the twelfth decimal place are dropped. The result is `None` for numbers of at least 10²⁴.
pub(super) fn exact(field: &[u8], decimals: Decimals) -> Option<i128> {
    let text = std::str::from_utf8(field.trim_ascii()).ok()?;
    let (mantissa, exponent) = match text.find(['e', 'E']) {
        Some(at) => (&text[..at], text[at + 1..].parse::<i32>().ok()?),
        None => (text, 0),
    };
    let (negative, digits) = match mantissa.strip_prefix('-') {
        Some(rest) => (true, rest),
        None => (false, mantissa.strip_prefix('+').unwrap_or(mantissa)),
    };
    let point = if decimals == Decimals::Comma { ',' } else { '.' };
    let (whole, fraction) = digits.split_once(point).unwrap_or((digits, ""));
    if whole.len() + fraction.len() == 0 || !whole.chars().chain(fraction.chars()).all(|c| c.is_ascii_digit())
    {
        return None;
    }
    let count = scaled(whole, fraction, exponent.checked_add(12)?)?;
    Some(if negative { -count } else { count })
}

/// Returns `whole.fraction · 10^shift`, truncated to an integer; `None` if the result is 10³⁶ or more.
fn scaled(whole: &str, fraction: &str, shift: i32) -> Option<i128> {
    let length = i32::try_from(whole.len()).ok()?.checked_add(shift)?;
    let digits = whole.bytes().chain(fraction.bytes()).chain(std::iter::repeat(b'0'));
    let mut count: i128 = 0;
    for digit in digits.take(usize::try_from(length.min(10_000)).unwrap_or(0)) {
        count = count * 10 + i128::from(digit - b'0');
        if count >= 10_i128.pow(36) {
            return None;
        }
    }
    Some(count)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_keep_their_digits() {
        let exact = |text: &str| exact(text.as_bytes(), Decimals::Point);
        assert_eq!(exact("1700000000123456789"), Some(1_700_000_000_123_456_789_000_000_000_000));
        assert_eq!(exact("-0.004"), Some(-4_000_000_000));
        assert_eq!(exact("1.700000000123456716e+09"), Some(1_700_000_000_123_456_716_000));
        assert_eq!(exact("4e-3"), Some(4_000_000_000));
        assert_eq!(exact("1e-13"), Some(0));
        for text in ["", ".", "-", "1e", "nan", "1_0", "1e99", "1e2147483647", "0x1", "1.2.3"] {
            assert_eq!(exact(text), None, "{text}");
        }
        assert_eq!(exact("0e2000000000"), Some(0));
    }

    #[test]
    fn decimals_are_points_or_commas() {
        assert_eq!(number(b" 1.5 ", Decimals::Point), Some(1.5));
        assert_eq!(number(b"1,5", Decimals::Point), None);
        assert_eq!(number(b"-1,5e-3", Decimals::Comma), Some(-1.5e-3));
        assert_eq!(number(b"1.234,5", Decimals::Comma), None);
        assert!(number(b"NA", Decimals::Point).is_some_and(f64::is_nan));
    }
}
