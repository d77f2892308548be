//! The error of a text that is not a formula.

use std::fmt;
use std::ops::Range;

/// The reason why a text is not a formula.
#[derive(Debug, Clone, PartialEq)]
pub struct FormulaError {
    /// The kind of the fault, for programs.
    pub code: &'static str,
    /// The fault.
    pub message: String,
    /// Suggested text.
    pub help: Option<String>,
    /// Its place, in bytes of the text.
    pub range: Range<usize>,
}

impl FormulaError {
    pub(crate) fn new(code: &'static str, message: impl Into<String>, range: Range<usize>) -> Self {
        Self { code, message: message.into(), help: None, range }
    }

    pub(crate) fn with_help(self, help: impl Into<Option<String>>) -> Self {
        Self { help: help.into(), ..self }
    }
}

impl fmt::Display for FormulaError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.help {
            Some(help) => write!(f, "{}; {help}", self.message),
            None => f.write_str(&self.message),
        }
    }
}

impl std::error::Error for FormulaError {}
