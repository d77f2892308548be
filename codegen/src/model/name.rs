//! Names from a description become Rust identifiers.

/// Words that are no identifiers in any edition, strict and reserved.
const KEYWORDS: [&str; 54] = [
    "abstract", "as", "async", "await", "become", "box", "break", "const", "continue", "crate",
    "do", "dyn", "else", "enum", "extern", "false", "final", "fn", "for", "gen", "if", "impl",
    "in", "let", "loop", "macro", "match", "mod", "move", "mut", "override", "priv", "pub", "ref",
    "return", "self", "static", "struct", "super", "trait", "true", "try", "type", "typeof",
    "union", "unsafe", "unsized", "use", "virtual", "where", "while", "yield", "raw", "safe",
];

/// Arguments of generated functions; no joint or drive is named like them.
const ARGUMENTS: [&str; 6] = ["y", "v", "a", "u", "p", "out"];

/// Names with a meaning of their own in formulas.
const IN_FORMULAS: [&str; 11] = [
    "y", "v", "pi", "sin", "cos", "tanh", "exp", "abs", "sign", "pow", "powi",
];

/// Whether the name is a word of Rust.
pub(super) fn is_keyword(name: &str) -> bool {
    KEYWORDS.contains(&name)
}

/// Whether generated functions have an argument of this name.
pub(super) fn is_argument(name: &str) -> bool {
    ARGUMENTS.contains(&name)
}

/// Whether the name means something else in formulas.
pub(super) fn has_meaning(name: &str) -> bool {
    IN_FORMULAS.contains(&name)
}

/// The name in snake case of ASCII letters, digits and underscores; `None` where nothing usable remains.
///
/// `ShoulderPan` becomes `shoulder_pan`, `β` `beta`, `a-b` `a_b`, `2nd` `_2nd`, `type` `type_`.
pub(super) fn identifier(name: &str) -> Option<String> {
    let mut result = String::new();
    let mut previous = ' ';
    for c in name.chars().take(200) {
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
    finish(result)
}

fn push_word(result: &mut String, word: &str) {
    if !result.is_empty() && !result.ends_with('_') {
        result.push('_');
    }
    result.push_str(word);
}

fn finish(mut result: String) -> Option<String> {
    if !result.chars().any(|c| c.is_ascii_alphanumeric()) {
        return None;
    }
    if result.starts_with(|c: char| c.is_ascii_digit()) {
        result.insert(0, '_');
    }
    if is_keyword(&result) {
        result.push('_');
    }
    Some(result)
}

fn greek(c: char) -> Option<&'static str> {
    const NAMES: [&str; 25] = [
        "alpha", "beta", "gamma", "delta", "epsilon", "zeta", "eta", "theta", "iota", "kappa",
        "lambda", "mu", "nu", "xi", "omicron", "pi", "rho", "sigma", "sigma", "tau", "upsilon",
        "phi", "chi", "psi", "omega",
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
        ];
        for (name, expected) in cases {
            assert_eq!(identifier(name).as_deref(), Some(expected));
            assert!(syn::parse_str::<syn::Ident>(expected).is_ok());
        }
        assert_eq!(identifier("***"), None);
        assert_eq!(identifier("漢字"), None);
    }

    #[test]
    fn keywords_are_those_of_syn() {
        for word in KEYWORDS
            .iter()
            .filter(|word| !["raw", "safe", "union", "gen"].contains(word))
        {
            assert!(syn::parse_str::<syn::Ident>(word).is_err(), "{word}");
        }
    }
}
