//! Errors of reports.

use std::io;
use std::path::PathBuf;

/// Errors of a report.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// An equation that is not LaTeX, or has an unsupported command.
    #[error("the equation `{latex}` cannot be typeset: {message}")]
    Equation {
        /// The equation.
        latex: String,
        /// The fault.
        message: String,
    },
    /// A figure that cannot be drawn.
    #[error("the figure `{id}` cannot be drawn: {message}")]
    Plot {
        /// The figure.
        id: String,
        /// The fault.
        message: String,
    },
    /// Two parts with the same identifier.
    #[error("two parts of the report have the identifier `{0}`: rename one")]
    SameId(String),
    /// A table that cannot be written.
    #[error("the table `{id}` cannot be written as CSV: {message}")]
    Data {
        /// The table.
        id: String,
        /// The fault.
        message: String,
    },
    /// A file that cannot be written.
    #[error("cannot write {}: {source}", path.display())]
    File {
        /// The file or folder.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
}
