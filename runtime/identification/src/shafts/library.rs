//! Terms of friction over the speed of a shaft.

use super::super::error::Result;
use super::super::estimation::two_digits;
use super::super::library::Library;

/// Factor k of a term tanh(k v) of a joint where v is `scale` times as fast, with two digits.
pub(crate) fn slope(factor: f64, scale: f64) -> f64 {
    if scale == 1.0 { factor } else { two_digits(factor / scale) }
}

/// A library of joints for speeds that are `scale` times as fast: terms tanh(k v) with a number k keep their shape. Other
/// terms stay as they are.
///
/// # Errors
/// Those of [`Library::new`]: slopes that become the same one.
pub(crate) fn scaled(library: &Library, scale: f64) -> Result<Library> {
    if scale == 1.0 {
        return Ok(library.clone());
    }
    let terms: Vec<String> = library.terms().iter().map(|term| term_over(term, scale)).collect();
    Library::new(&terms, library.channels())
}

fn term_over(term: &str, scale: f64) -> String {
    let parts = term.split_once("tanh(").and_then(|(before, rest)| {
        let (factor, after) = rest.split_once("*v)")?;
        Some(format!("{before}tanh({}*v){after}", slope(factor.parse().ok()?, scale)))
    });
    parts.unwrap_or_else(|| term.to_owned())
}
