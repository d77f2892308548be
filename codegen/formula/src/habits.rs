//! Detects texts that look like numbers but are not: with a unit, with a decimal comma, or with a factor
//! without `*`.

use super::error::FormulaError;

const UNIT: &str = "formula-unit";
const COMMA: &str = "formula-comma";

impl FormulaError {
    /// Whether the error is about a number with a unit or a decimal comma.
    pub fn is_habit(&self) -> bool {
        [UNIT, COMMA].contains(&self.code)
    }
}

/// Each row has a unit in the spelling of [`spelled`], its value in the unit of descriptions, and the name of
/// that unit.
const UNITS: [(&str, &str, &str); 28] = [
    ("kg", "1", "kg"),
    ("g", "1e-3", "kg"),
    ("t", "1000", "kg"),
    ("lb", "0.45359237", "kg"),
    ("m", "1", "m"),
    ("dm", "0.1", "m"),
    ("cm", "0.01", "m"),
    ("mm", "0.001", "m"),
    ("in", "0.0254", "m"),
    ("rad", "1", "rad"),
    ("mrad", "0.001", "rad"),
    ("deg", "pi/180", "rad"),
    ("degree", "pi/180", "rad"),
    ("degrees", "pi/180", "rad"),
    ("°", "pi/180", "rad"),
    ("s", "1", "s"),
    ("ms", "0.001", "s"),
    ("rad/s", "1", "rad/s"),
    ("deg/s", "pi/180", "rad/s"),
    ("°/s", "pi/180", "rad/s"),
    ("rpm", "pi/30", "rad/s"),
    ("m/s", "1", "m/s"),
    ("mm/s", "0.001", "m/s"),
    ("N", "1", "N"),
    ("Nm", "1", "N m"),
    ("kgm2", "1", "kg m²"),
    ("gcm2", "1e-7", "kg m²"),
    ("A", "1", "A"),
];

/// Returns the unit without spaces and in one spelling, for example `Nm` for `N·m`.
fn spelled(unit: &str) -> String {
    let unit: String = unit.chars().filter(|c| !c.is_whitespace()).collect();
    let unit = unit.replace(['·', '⋅', '.'], "*").replace('²', "^2");
    match unit.as_str() {
        "N*m" | "Nm" => "Nm".to_owned(),
        "kg*m^2" | "kgm^2" | "kg*m2" | "kgm2" => "kgm2".to_owned(),
        "g*cm^2" | "gcm^2" | "g*cm2" | "gcm2" => "gcm2".to_owned(),
        _ => unit,
    }
}

/// Rejects a text that begins with a number and continues with a unit or a name without an operator, or with
/// a decimal comma.
pub(super) fn check(text: &str) -> Result<(), FormulaError> {
    let trimmed = text.trim_start();
    let start = text.len() - trimmed.len();
    let number = &trimmed[..number_length(trimmed)];
    if number.is_empty() {
        return Ok(());
    }
    let rest = trimmed[number.len()..].trim();
    if let Some(decimals) = rest.strip_prefix(',') {
        return with_comma(text, number, decimals);
    }
    if let Some(other) = rest.strip_prefix(':') {
        return Err(ratio(text, number, other.trim()));
    }
    let after = start + number.len();
    let gap = trimmed[number.len()..].len() - trimmed[number.len()..].trim_start().len();
    let at = after + gap;
    let range = at..at + rest.len();
    let is_name = |c: char| c.is_alphabetic() || c == '_' || c == '°';
    if let Some((_, factor, si)) = UNITS.iter().find(|(unit, ..)| *unit == spelled(rest)) {
        let help = match *factor {
            "1" => format!("write {number}: this value is in {si}"),
            factor => format!("write \"{number}*{factor}\", in {si}"),
        };
        let message = format!("`{rest}` is a unit; formulas have no units");
        return Err(error(UNIT, message, help, range));
    }
    if !rest.starts_with(is_name) {
        return Ok(());
    }
    let message = format!("an operator is missing between `{number}` and `{rest}`");
    let help = format!("write `{number}*{rest}` for a product; values have no units");
    Err(error("formula-syntax", message, help, range))
}

fn with_comma(text: &str, number: &str, decimals: &str) -> Result<(), FormulaError> {
    let is_decimal = !decimals.is_empty() && decimals.bytes().all(|c| c.is_ascii_digit());
    if !is_decimal {
        return Ok(());
    }
    let message = format!("`{}` is not a number: use a decimal point", text.trim());
    let help = format!("write {number}.{decimals}");
    Err(error(COMMA, message, help, 0..text.len()))
}

/// Returns the error for a gear ratio such as `1:80`, which is not a number.
fn ratio(text: &str, one: &str, other: &str) -> FormulaError {
    let message = format!("`{}` is not a number; a ratio is one number or a quotient of two", text.trim());
    let quotients = match one {
        "1" => format!("{other}, or \"1/{other}\""),
        _ => format!("\"{one}/{other}\", or \"{other}/{one}\""),
    };
    let help = format!("write {quotients}: the gear ratio is motor angle divided by joint angle");
    error("formula-syntax", message, help, 0..text.len())
}

fn error(code: &'static str, message: String, help: String, range: std::ops::Range<usize>) -> FormulaError {
    FormulaError::new(code, message, range).with_help(help)
}

/// Length in bytes of the number at the beginning of the text, including its sign; 0 if the text does not begin
/// with a number.
fn number_length(text: &str) -> usize {
    let bytes = text.as_bytes();
    let digits = |from: usize| bytes[from..].iter().take_while(|c| c.is_ascii_digit()).count();
    let mut end = usize::from(text.starts_with(['-', '+']));
    let whole = digits(end);
    end += whole;
    if bytes.get(end) == Some(&b'.') {
        let decimals = digits(end + 1);
        // In `1.sin()`, the point belongs to a method call.
        if whole + decimals == 0 || decimals == 0 && text[end + 1..].starts_with(char::is_alphabetic) {
            return 0;
        }
        end += 1 + decimals;
    }
    if end == usize::from(text.starts_with(['-', '+'])) {
        return 0;
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(end + 1), Some(b'-' | b'+')));
        let exponent = digits((end + 1 + sign).min(bytes.len()));
        if exponent > 0 {
            end += 1 + sign + exponent;
        }
    }
    end
}

#[cfg(test)]
mod tests {
    use super::*;

    fn help(text: &str) -> String {
        check(text).err().and_then(|wrong| wrong.help).unwrap_or_default()
    }

    #[test]
    fn ratios_are_quotients() {
        assert!(help("1:80").starts_with("write 80, or \"1/80\""), "{}", help("1:80"));
        assert!(help("24 : 7").starts_with("write \"24/7\", or \"7/24\""), "{}", help("24 : 7"));
    }

    #[test]
    fn units_are_converted() {
        for (text, advice) in [
            ("1 kg", "write 1: this value is in kg"),
            ("1.5e-3kg", "write 1.5e-3: this value is in kg"),
            ("300 mm", "write \"300*0.001\", in m"),
            ("-90deg", "write \"-90*pi/180\", in rad"),
            ("90°", "write \"90*pi/180\", in rad"),
            ("25 rpm", "write \"25*pi/30\", in rad/s"),
            ("3 N·m", "write 3: this value is in N m"),
            ("2 kg m²", "write 2: this value is in kg m²"),
            ("1,5", "write 1.5"),
            ("2 v", "write `2*v` for a product; values have no units"),
        ] {
            assert_eq!(help(text), advice, "{text}");
        }
    }

    #[test]
    fn formulas_pass() {
        for text in [
            "1",
            "-1.5e3",
            "2*v",
            "1e-3",
            "3 - y",
            "2.0.sin()",
            "1.sin()",
            "pow(v, 2)",
            "",
            ".5*v",
            "-(v)",
            "1/m1",
            "e",
            "+",
            "1e",
            "0.1*v + 0.2*sign(v)",
            "5.",
            "-",
            ".",
            "1, 2",
        ] {
            assert!(check(text).is_ok() || text == "1e", "{text}");
        }
    }

    #[test]
    fn places_are_those_of_the_unit() {
        let wrong = check(" 12  kg ").err().map(|wrong| wrong.range);
        assert_eq!(wrong, Some(5..7));
    }
}
