//! Notes on the settings with which a friction law was found.

use gelenk_findings::digits::plain;
use gelenk_findings::{Finding, Rule};

/// Sees: the filter of the samples, the method, and the terms from which the law was chosen.
/// Matters: with other settings the law may differ. These notes are written as comments of the law.
/// Example: best subset, 10 folds.
/// Fixture: `friction/tests.rs`.
pub(crate) const SETTINGS: Rule = Rule::note("law-settings");

/// The note on the filter of positions and efforts.
///
/// - `bandwidth`, `sample_rate`: bandwidth of the filter and rate of the filtered samples [Hz]
pub(crate) fn note_on_filter(bandwidth: f64, sample_rate: f64) -> Finding {
    SETTINGS.found(format!(
        "positions and efforts passed the same zero-phase filter of {} Hz. Their sample rate is {} Hz",
        plain(bandwidth, 4),
        plain(sample_rate, 6)
    ))
}

/// The note on terms that motion in one direction does not determine; `None` if there are no such terms.
pub(crate) fn note_on_direction(terms: &[String]) -> Option<Finding> {
    let terms = (!terms.is_empty()).then(|| terms.join(", "))?;
    Some(SETTINGS.found(format!(
        "these terms are left out, because nine tenths of the motion are in one direction: {terms}"
    )))
}
