//! Converts names of descriptions and programs to identifiers of Rust.

use proc_macro2::{Ident, Span};

use crate::emit::names::Spelling;

/// Words that are not identifiers in edition 2024, including reserved words.
const KEYWORDS: [&str; 53] = [
    "Self", "_", "abstract", "as", "async", "await", "become", "box", "break", "const", "continue", "crate",
    "do", "dyn", "else", "enum", "extern", "false", "final", "fn", "for", "gen", "if", "impl", "in", "let",
    "loop", "macro", "match", "mod", "move", "mut", "override", "priv", "pub", "ref", "return", "self",
    "static", "struct", "super", "trait", "true", "try", "type", "typeof", "unsafe", "unsized", "use",
    "virtual", "where", "while", "yield",
];

/// Rules for identifiers of Rust.
pub(super) const SPELLING: Spelling =
    Spelling { keywords: &KEYWORDS, has_free_underscores: true, prefixes: vec![] };

/// Converts `name` to an ASCII identifier of Rust. A name that is already an identifier is returned
/// unchanged.
pub(super) fn identifier(name: &str) -> Ident {
    ident(&SPELLING.identifier(name))
}

/// Converts `names` to identifiers that differ from each other and from `taken`. If an identifier is already
/// in use, `_` and a number are appended.
pub(super) fn distinct<'a>(names: impl IntoIterator<Item = &'a str>, taken: &[String]) -> Vec<Ident> {
    idents(&SPELLING.distinct(names, taken))
}

/// Tokens of names that are already identifiers.
pub(super) fn idents(names: &[String]) -> Vec<Ident> {
    names.iter().map(|name| ident(name)).collect()
}

fn ident(spelled: &str) -> Ident {
    Ident::new(spelled, Span::call_site())
}

/// Whether rustc accepts the name of a variable, field or function without a warning about its case.
pub(super) fn is_snake_case(name: &str) -> bool {
    let name = name.trim_start_matches('_');
    !name.contains("__") && !name.contains(char::is_uppercase)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keywords_are_sorted_for_the_binary_search() {
        assert!(KEYWORDS.is_sorted());
    }

    #[test]
    fn strange_names_become_identifiers() {
        let cases = [
            ("y1", "y1"),
            ("ω_1", "omega_1"),
            ("fn", "fn_"),
            ("gen", "gen_"),
            ("2x", "x2x"),
            ("", "x"),
            ("_", "x_"),
            ("_1", "x_1"),
            ("a\"; panic!()", "a___panic___"),
            ("é", "x_"),
        ];
        for (name, expected) in cases {
            assert_eq!(identifier(name).to_string(), expected, "{name:?}");
        }
    }

    #[test]
    fn collisions_are_numbered() {
        let names = distinct(["a", "a", "p", "a_2"], &["p".to_owned()]);
        let names: Vec<String> = names.iter().map(ToString::to_string).collect();
        assert_eq!(names, ["a", "a_2", "p_2", "a_2_2"]);
    }
}
