//! Formatting of numbers and lists of names in messages.

/// Largest number of entries that a list in a message shows.
const LISTED: usize = 4;

/// Names as a list, for example `` `a`, `b`, `c`, `d` and 20 more``.
pub(crate) fn list<'a>(names: impl ExactSizeIterator<Item = &'a str>) -> String {
    listed(names.map(|name| format!("`{name}`")))
}

/// The first entries as a list. The number of the other entries follows.
pub(crate) fn listed(entries: impl ExactSizeIterator<Item = String>) -> String {
    let count = entries.len();
    let shown: Vec<String> = entries.take(LISTED).collect();
    match count.saturating_sub(LISTED) {
        0 => shown.join(", "),
        more => format!("{} and {more} more", shown.join(", ")),
    }
}

/// A word for the command line of a shell, quoted if necessary.
pub(crate) fn quoted(word: &str) -> String {
    let is_plain = |letter: char| letter.is_alphanumeric() || "_-./,".contains(letter);
    if !word.is_empty() && word.chars().all(is_plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', r"'\''"))
}

#[cfg(feature = "cli")]
pub(crate) use gelenk_formula::toml_text;

/// The number with three significant digits: `0.0123`, `63.8`, `2.41e-35`.
pub(crate) fn three_digits(x: f64) -> String {
    digits(x, 3)
}

/// Number with up to 17 digits, without long runs of zeros: `1e-300`, `1.5707963`.
pub(crate) fn as_written(x: f64) -> String {
    digits(x, MOST_DIGITS)
}

/// Numbers with as few digits as possible, but at least three, so that the statement `is_true` about the
/// rounded numbers is true: `2 > 1.9999` does not become `2 > 2`.
pub(crate) fn telling<const N: usize>(numbers: [f64; N], is_true: impl Fn([f64; N]) -> bool) -> [String; N] {
    let enough = |count: &usize| is_true(numbers.map(|x| rounded(x, *count)));
    let count = (3..MOST_DIGITS).find(enough).unwrap_or(MOST_DIGITS);
    numbers.map(|x| digits(x, count))
}

/// Number of significant digits that distinguish any two numbers of the type `f64`.
const MOST_DIGITS: usize = 17;

fn digits(x: f64, count: usize) -> String {
    let x = rounded(x, count);
    match x.abs() {
        size if size == 0.0 || (1e-4..1e7).contains(&size) || !size.is_finite() => x.to_string(),
        _ => format!("{x:e}"),
    }
}

fn rounded(x: f64, count: usize) -> f64 {
    let text = format!("{x:.*e}", count - 1);
    text.parse().unwrap_or(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let cases = [
            (0.0, "0"),
            (-1.234_567e-22, "-1.23e-22"),
            (0.012_345, "0.0123"),
            (63.812, "63.8"),
            (123_456.0, "123000"),
            (1e300, "1e300"),
            (f64::INFINITY, "inf"),
        ];
        for (x, expected) in cases {
            assert_eq!(three_digits(x), expected);
        }
    }

    #[test]
    fn written_numbers_are_recognized() {
        let cases = [(1e-300, "1e-300"), (1.618_034, "1.618034"), (-0.1, "-0.1")];
        for (x, expected) in cases {
            assert_eq!(as_written(x), expected);
        }
    }

    #[test]
    fn statements_stay_true() {
        let smaller = |[a, b]: [f64; 2]| a < b;
        assert_eq!(telling([1.999_96, 2.0], smaller), ["1.99996", "2"]);
        assert_eq!(telling([1.0, 2.0], smaller), ["1", "2"]);
        let next = f64::from_bits(1.0_f64.to_bits() + 1);
        assert_eq!(telling([1.0, next], smaller), ["1", "1.0000000000000002"]);
        assert_eq!(telling([2.0, 1.0], smaller), ["2", "1"]);
    }
}
