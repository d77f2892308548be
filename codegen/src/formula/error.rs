//! Why a text is no formula.

use std::ops::Range;

/// Why a text is no formula; `range` counts bytes of the text.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct FormulaError {
    pub code: &'static str,
    pub message: String,
    pub help: Option<String>,
    pub range: Range<usize>,
}
