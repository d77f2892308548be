//! The ways in which a command ends without success.

use crate::diagnostic::Diagnostics;

/// Reason why a command ends without success.
#[derive(Debug)]
pub(super) enum Failure {
    /// Descriptions are at fault.
    Descriptions(Vec<Diagnostics>),
    /// A wrong command line.
    Usage(String),
    /// Anything else: a file that cannot be written.
    Problem(String),
}

impl<E: std::error::Error> From<E> for Failure {
    fn from(error: E) -> Self {
        Self::Problem(error.to_string())
    }
}
