//! Numbers and formulas as text for a description.

use crate::model::FrictionTerm;
use crate::wording::toml_text;
use gelenk_formula::Formula;

/// A number with nine digits. They are a thousand times finer than any estimate, and coarse enough that the
/// last bits of two processors give the same text.
pub(super) fn number(value: f64) -> String {
    let text = format!("{value:.8e}");
    let rounded: f64 = text.parse().unwrap_or(value);
    format!("{rounded:?}")
}

/// A formula as TOML: a number without quotes, or a text in quotes.
pub(super) fn text(formula: &Formula, parameters: &[&str]) -> String {
    let text = formula.text(parameters);
    match text.parse::<f64>() {
        Ok(value) => format!("{value:?}"),
        Err(_) => toml_text(&text),
    }
}

/// Pairs of a basis and its coefficient, as TOML.
pub(super) fn weighted(terms: &[FrictionTerm], parameters: &[&str]) -> String {
    let pair = |term: &FrictionTerm| {
        format!("[{}, {}]", toml_text(&term.basis.text(parameters)), text(&term.coefficient, parameters))
    };
    format!("[{}]", terms.iter().map(pair).collect::<Vec<_>>().join(", "))
}
