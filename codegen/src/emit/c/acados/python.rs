//! Prints literals of Python.

/// A number as a literal of Python. Numbers that are not finite are NumPy's constants.
pub(super) fn number(number: f64) -> String {
    match number {
        _ if number.is_nan() => "np.nan".to_owned(),
        f64::INFINITY => "np.inf".to_owned(),
        f64::NEG_INFINITY => "-np.inf".to_owned(),
        _ => format!("{number:?}"),
    }
}

/// A text as a string literal of Python. Characters outside printable ASCII are escaped.
pub(super) fn string(text: &str) -> String {
    let mut literal = String::from("\"");
    for letter in text.chars() {
        match letter {
            '"' | '\\' => literal.extend(['\\', letter]),
            ' '..='~' => literal.push(letter),
            _ => literal.push_str(&format!("\\U{:08x}", u32::from(letter))),
        }
    }
    literal.push('"');
    literal
}

/// Texts as a Python tuple of string literals.
pub(super) fn strings<'a>(texts: impl Iterator<Item = &'a str>) -> String {
    let texts: Vec<String> = texts.map(string).collect();
    // A tuple with one entry needs a comma.
    let comma = if texts.len() == 1 { "," } else { "" };
    format!("({}{comma})", texts.join(", "))
}

/// Numbers as a NumPy array, row-major.
///
/// - `columns`: number of columns of a matrix, which may have 0 rows; `None` for a vector
pub(super) fn array(numbers: &[f64], columns: Option<usize>) -> String {
    let list = |numbers: &[f64]| {
        let numbers: Vec<String> = numbers.iter().map(|&each| number(each)).collect();
        format!("[{}]", numbers.join(", "))
    };
    match columns {
        None => format!("np.array({}, float)", list(numbers)),
        Some(columns) if numbers.is_empty() => format!("np.zeros((0, {columns}))"),
        Some(columns) => {
            let rows: String = numbers.chunks(columns).map(|row| format!("    {},\n", list(row))).collect();
            format!("np.array([\n{rows}])")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_stays_text() {
        assert_eq!(string("a\"\\\n"), "\"a\\\"\\\\\\U0000000a\"");
        assert_eq!(strings(["one"].into_iter()), "(\"one\",)");
        assert_eq!(strings(["one", "two"].into_iter()), "(\"one\", \"two\")");
        assert_eq!(strings([].into_iter()), "()");
    }

    #[test]
    fn arrays_have_rows() {
        assert_eq!(array(&[1.0, f64::NEG_INFINITY], None), "np.array([1.0, -np.inf], float)");
        assert_eq!(array(&[1.0, 2.0], Some(1)), "np.array([\n    [1.0],\n    [2.0],\n])");
        assert_eq!(array(&[], Some(3)), "np.zeros((0, 3))");
    }
}
