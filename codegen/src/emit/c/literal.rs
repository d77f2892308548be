//! Prints literals of C that have exactly the bits of the numbers and the bytes of the texts.

use crate::emit::options::Scalar;

impl Scalar {
    /// Name of the number type in C: `double` or `float`.
    pub(super) fn c_type(self) -> &'static str {
        match self {
            Self::F64 => "double",
            Self::F32 => "float",
        }
    }

    /// A number as a literal of this number type in C.
    pub(super) fn c_literal(self, number: f64) -> String {
        #[allow(clippy::cast_possible_truncation, reason = "f32 constants are the rounded f64 ones")]
        let single = number as f32;
        match self {
            _ if number.is_nan() => "NAN".to_owned(),
            Self::F64 if number.is_infinite() => infinity(number),
            Self::F32 if single.is_infinite() => infinity(number),
            Self::F64 => format!("{number:?}"),
            Self::F32 => format!("{single:?}f"),
        }
    }
}

fn infinity(number: f64) -> String {
    if number < 0.0 { "-INFINITY" } else { "INFINITY" }.to_owned()
}

/// A text as a string literal of C in UTF-8, without trigraphs.
pub(super) fn string(text: &str) -> String {
    let mut literal = String::from("\"");
    for byte in text.bytes() {
        match byte {
            b'"' | b'\\' | b'?' => literal.extend(['\\', char::from(byte)]),
            b' '..=b'~' => literal.push(char::from(byte)),
            // An octal escape has at most three digits, so a following digit is not part of the escape.
            _ => literal.push_str(&format!("\\{byte:03o}")),
        }
    }
    literal.push('"');
    literal
}

/// Converts a text for `double` to the number type `scalar`: types, literals and functions of the C library
/// are replaced.
pub(super) fn in_scalar(text: &str, scalar: Scalar) -> String {
    match scalar {
        Scalar::F64 => text.to_owned(),
        Scalar::F32 => {
            let functions = ["fabs", "fma", "sqrt"].into_iter();
            let text = functions.fold(text.replace("double", "float"), |text, name| {
                text.replace(&format!("{name}("), &format!("{name}f("))
            });
            with_suffixes(&text)
        }
    }
}

/// Appends `f` to each number with a decimal point, so that C reads the numbers as `float`.
fn with_suffixes(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut letters = text.chars().peekable();
    let mut is_number = false;
    let mut has_point = false;
    let mut last = ' ';
    while let Some(letter) = letters.next() {
        let begins = letter.is_ascii_digit() && !(last.is_ascii_alphanumeric() || last == '_');
        is_number = begins || is_number && (letter.is_ascii_digit() || letter == '.');
        has_point = is_number && (letter == '.' || has_point);
        out.push(letter);
        let goes_on = letters.peek().is_some_and(|next| next.is_ascii_digit() || *next == '.');
        if is_number && has_point && !goes_on && letter != '.' {
            out.push('f');
            (is_number, has_point) = (false, false);
        }
        last = letter;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn literals_read_back_to_the_same_bits() {
        for number in [0.0, 0.1, 1e-7, 1e300, f64::MIN_POSITIVE, 5e-324, f64::MAX, 161.0, 9.80665] {
            let text = Scalar::F64.c_literal(number);
            assert_eq!(text.parse::<f64>().unwrap().to_bits(), number.to_bits(), "{text}");
        }
        assert_eq!(Scalar::F64.c_literal(-0.0), "-0.0");
        assert_eq!(Scalar::F32.c_literal(0.1), "0.1f");
        assert_eq!(Scalar::F32.c_literal(-1e300), "-INFINITY");
    }

    #[test]
    fn text_becomes_no_code() {
        assert_eq!(string("a\"\\\n??/é0"), "\"a\\\"\\\\\\012\\?\\?/\\303\\2510\"");
    }

    #[test]
    fn numbers_of_loops_get_the_suffix_of_their_type() {
        let text = "double x[4] = {0.0}; a1 = 12.5 / sqrt(2.0); i < 4; // |x| <= 10.";
        let expected = "float x[4] = {0.0f}; a1 = 12.5f / sqrtf(2.0f); i < 4; // |x| <= 10.";
        assert_eq!(in_scalar(text, Scalar::F32), expected);
    }
}
