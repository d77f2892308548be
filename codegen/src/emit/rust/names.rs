//! Names of a description and of a program as Rust identifiers.
//!
//! The model has checked its names already; this is the last guard, so that no string becomes code.
//! Identifiers are ASCII: other letters would trip rustc's lints on confusable names, which only the
//! including crate could allow.

use std::collections::BTreeSet;

use proc_macro2::{Ident, Span};

use crate::program::letters;

/// Words that are no identifiers in edition 2024, reserved ones included.
const KEYWORDS: [&str; 53] = [
    "Self", "_", "abstract", "as", "async", "await", "become", "box", "break", "const", "continue", "crate",
    "do", "dyn", "else", "enum", "extern", "false", "final", "fn", "for", "gen", "if", "impl", "in", "let",
    "loop", "macro", "match", "mod", "move", "mut", "override", "priv", "pub", "ref", "return", "self",
    "static", "struct", "super", "trait", "true", "try", "type", "typeof", "unsafe", "unsized", "use",
    "virtual", "where", "while", "yield",
];

/// The nearest ASCII identifier to `name`; `name` itself where it is one.
pub(super) fn identifier(name: &str) -> Ident {
    Ident::new(&spelling(name), Span::call_site())
}

fn spelling(name: &str) -> String {
    let mut text = String::with_capacity(name.len());
    for letter in name.chars() {
        match letters::greek_name(letter) {
            Some(word) => text.push_str(word),
            None if letter.is_ascii_alphanumeric() => text.push(letter),
            None => text.push('_'),
        }
    }
    let starts_well = text.starts_with(|first: char| first.is_ascii_alphabetic() || first == '_');
    let says_something = text.contains(|letter: char| letter.is_ascii_alphabetic());
    if !starts_well || !says_something {
        text.insert(0, 'x');
    }
    if KEYWORDS.binary_search(&text.as_str()).is_ok() {
        text.push('_');
    }
    text
}

/// Identifiers for `names`, different from each other and from `taken`; a name already taken gets `_` and a
/// number.
pub(super) fn distinct<'a>(names: impl IntoIterator<Item = &'a str>, taken: &[String]) -> Vec<Ident> {
    let mut used: BTreeSet<String> = taken.iter().cloned().collect();
    names.into_iter().map(|name| unused(spelling(name), &mut used)).collect()
}

fn unused(spelling: String, used: &mut BTreeSet<String>) -> Ident {
    let mut candidate = spelling.clone();
    let mut number = 1;
    while !used.insert(candidate.clone()) {
        number += 1;
        candidate = format!("{}_{number}", spelling.trim_end_matches('_'));
    }
    Ident::new(&candidate, Span::call_site())
}

/// Tells whether rustc accepts the spelling of a variable, field or function.
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
