//! Inline content: text, equations and code.

/// A part of a line: text, an equation or code.
#[derive(Debug, Clone, PartialEq)]
pub enum Inline {
    /// Text without markup.
    Text(String),
    /// An equation in LaTeX.
    Math(String),
    /// A name from source code.
    Code(String),
}

/// Returns a name from source code as part of a line.
#[must_use]
pub fn code(source: impl Into<String>) -> Inline {
    Inline::Code(source.into())
}

/// Splits text at `$` and backticks. A sign without a closing sign is literal.
pub(super) fn inlines(source: &str) -> Vec<Inline> {
    let mut parts = Vec::new();
    let mut plain = String::new();
    let mut rest = source;
    while let Some(sign) = rest.chars().next() {
        let after = &rest[sign.len_utf8()..];
        let end = if matches!(sign, '$' | '`') { after.find(sign) } else { None };
        let Some(end) = end else {
            plain.push(sign);
            rest = after;
            continue;
        };
        if !plain.is_empty() {
            parts.push(Inline::Text(std::mem::take(&mut plain)));
        }
        let inner = after[..end].to_owned();
        parts.push(match sign {
            '$' => Inline::Math(inner),
            _ => Inline::Code(inner),
        });
        rest = &after[end + sign.len_utf8()..];
    }
    if !plain.is_empty() {
        parts.push(Inline::Text(plain));
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_hold_equations_and_code() {
        let parts = inlines("M is `mass_matrix`, $M(y)$; costs 3 $ each");
        let expected = [
            Inline::Text("M is ".into()),
            Inline::Code("mass_matrix".into()),
            Inline::Text(", ".into()),
            Inline::Math("M(y)".into()),
            Inline::Text("; costs 3 $ each".into()),
        ];
        assert_eq!(parts, expected);
    }
}
