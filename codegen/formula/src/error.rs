//! Error type for texts that are not formulas.

use std::fmt;
use std::ops::Range;

/// Error for a text that is not a formula.
#[derive(Debug, Clone, PartialEq)]
pub struct FormulaError {
    /// Short name of the kind of error, for example `formula-syntax`, for programs.
    pub code: &'static str,
    /// Message of the error, for users.
    pub message: String,
    /// Suggested correction; `None` if there is no suggestion.
    pub help: Option<String>,
    /// Position of the error in the text, in bytes.
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
