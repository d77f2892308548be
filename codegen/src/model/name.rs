//! Conversion of names to Rust identifiers.

/// Words that cannot be identifiers in any edition, strict and reserved.
const KEYWORDS: [&str; 54] = [
    "abstract", "as", "async", "await", "become", "box", "break", "const", "continue", "crate", "do", "dyn",
    "else", "enum", "extern", "false", "final", "fn", "for", "gen", "if", "impl", "in", "let", "loop",
    "macro", "match", "mod", "move", "mut", "override", "priv", "pub", "ref", "return", "self", "static",
    "struct", "super", "trait", "true", "try", "type", "typeof", "union", "unsafe", "unsized", "use",
    "virtual", "where", "while", "yield", "raw", "safe",
];

/// Names of arguments, constants and functions in formulas, which parameters must not have.
const IN_FORMULAS: [&str; 12] =
    ["y", "v", "pi", "sin", "cos", "tanh", "exp", "abs", "sign", "sqrt", "pow", "powi"];

/// Whether the name is a Rust keyword.
pub(crate) fn is_keyword(name: &str) -> bool {
    KEYWORDS.contains(&name)
}

/// Whether formulas use the name for an argument, a constant or a function.
pub(crate) fn has_meaning(name: &str) -> bool {
    IN_FORMULAS.contains(&name)
}

/// Largest number of characters of a name in a description.
const LONGEST: usize = 200;

/// Converts a name to snake case of ASCII letters, digits and underscores.
///
/// `ShoulderPan` becomes `shoulder_pan`, `β` becomes `beta`, `a-b` becomes `a_b`, `2nd` becomes `_2nd`, and
/// `type` becomes `type_`. If no letter or digit remains, the name consists of code points: `腕` becomes
/// `u8155`.
pub(crate) fn identifier(name: &str) -> String {
    let result = snake_case(name);
    if result.chars().any(|c| c.is_ascii_alphanumeric()) { finish(result) } else { code_points(name) }
}

fn snake_case(name: &str) -> String {
    let mut result = String::new();
    let mut previous = ' ';
    for c in name.chars().take(LONGEST) {
        match (c, greek(c)) {
            (_, Some(word)) => push_word(&mut result, word),
            ('A'..='Z', _) if previous.is_ascii_lowercase() => {
                push_word(&mut result, &c.to_lowercase().to_string())
            }
            (c, _) if c.is_ascii_alphanumeric() => result.push(c.to_ascii_lowercase()),
            _ if !result.ends_with('_') || c == '_' => result.push('_'),
            _ => {}
        }
        previous = c;
    }
    result
}

fn code_points(name: &str) -> String {
    let points = name.chars().take(LONGEST / 8);
    let points: Vec<String> = points.map(|c| format!("u{:x}", u32::from(c))).collect();
    match points.is_empty() {
        true => "unnamed".to_owned(),
        false => points.join("_"),
    }
}

fn push_word(result: &mut String, word: &str) {
    if !result.is_empty() && !result.ends_with('_') {
        result.push('_');
    }
    result.push_str(word);
}

fn finish(mut result: String) -> String {
    if result.starts_with(|c: char| c.is_ascii_digit()) {
        result.insert(0, '_');
    }
    if is_keyword(&result) {
        result.push('_');
    }
    result
}

fn greek(c: char) -> Option<&'static str> {
    const NAMES: [&str; 25] = [
        "alpha", "beta", "gamma", "delta", "epsilon", "zeta", "eta", "theta", "iota", "kappa", "lambda",
        "mu", "nu", "xi", "omicron", "pi", "rho", "sigma", "sigma", "tau", "upsilon", "phi", "chi", "psi",
        "omega",
    ];
    let lower = c.to_lowercase().next()?;
    let index = u32::from(lower).checked_sub(u32::from('α'))?;
    NAMES.get(usize::try_from(index).ok()?).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_become_snake_case() {
        let cases = [
            ("ShoulderPan", "shoulder_pan"),
            ("β", "beta"),
            ("wrist-1", "wrist_1"),
            ("2nd joint", "_2nd_joint"),
            ("type", "type_"),
            ("Self", "self_"),
            ("K_M", "k_m"),
            ("a*/b\"", "a_b_"),
            ("__x__", "__x__"),
            ("***", "u2a_u2a_u2a"),
            ("漢字", "u6f22_u5b57"),
            ("", "unnamed"),
        ];
        for (name, expected) in cases {
            assert_eq!(identifier(name), expected);
            assert!(syn::parse_str::<syn::Ident>(expected).is_ok());
        }
    }

    #[test]
    fn keywords_are_those_of_syn() {
        for word in KEYWORDS.iter().filter(|word| !["raw", "safe", "union", "gen"].contains(word)) {
            assert!(syn::parse_str::<syn::Ident>(word).is_err(), "{word}");
        }
    }
}
