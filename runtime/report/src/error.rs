//! Errors of reports.

use std::io;
use std::path::PathBuf;

/// Reason why a report cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// An equation is not valid LaTeX, or has an unsupported command.
    #[error("the equation `{latex}` cannot be typeset: {message}")]
    Equation {
        /// The equation in LaTeX.
        latex: String,
        /// Message of the parser.
        message: String,
    },
    /// A figure cannot be drawn.
    #[error("the figure `{id}` cannot be drawn: {message}")]
    Plot {
        /// Identifier of the figure.
        id: String,
        /// Reason why the figure cannot be drawn.
        message: String,
    },
    /// Two parts have the same identifier.
    #[error("two parts of the report have the identifier `{0}`: rename one of them")]
    SameId(String),
    /// A table cannot be written as CSV.
    #[error("the table `{id}` cannot be written as CSV: {message}")]
    Data {
        /// Identifier of the table.
        id: String,
        /// Message of the writer.
        message: String,
    },
    /// A file cannot be written.
    #[error("cannot write {}: {source}", path.display())]
    File {
        /// Path of the file or folder.
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
}
