//! Conversion of numbers and formulas to text of a description.

use crate::model::FrictionTerm;
use crate::wording::toml_text;
use gelenk_formula::Formula;

/// Returns a number with nine digits as text. They are a thousand times finer than any estimate, but coarse
/// enough that differences in the last bits between two processors do not change the text.
pub(super) fn number(value: f64) -> String {
    let text = format!("{value:.8e}");
    let rounded: f64 = text.parse().unwrap_or(value);
    format!("{rounded:?}")
}

/// Returns a formula as TOML: a number without quotes, or a text in quotes.
pub(super) fn text(formula: &Formula, parameters: &[&str]) -> String {
    let text = formula.text(parameters);
    match text.parse::<f64>() {
        Ok(value) => format!("{value:?}"),
        Err(_) => toml_text(&text),
    }
}

/// Returns a list of basis functions with their coefficients as TOML.
pub(super) fn weighted(terms: &[FrictionTerm], parameters: &[&str]) -> String {
    let pair = |term: &FrictionTerm| {
        format!("[{}, {}]", toml_text(&term.basis.text(parameters)), text(&term.coefficient, parameters))
    };
    format!("[{}]", terms.iter().map(pair).collect::<Vec<_>>().join(", "))
}
