//! How the files that a description names are fetched.

use crate::diagnostic::{Diagnostic, Diagnostics};

/// Fetches files that a description names. Paths are relative to the folder of the first description, also if another one
/// names them. A function of a path is one that has texts alone.
pub trait Load {
    /// The name of a file for diagnostics, and its text.
    ///
    /// # Errors
    /// The file cannot be read, or is no description.
    fn text(&mut self, path: &str) -> Result<(String, String), Diagnostics>;

    /// The content of a file that is not a text, such as a mesh.
    ///
    /// # Errors
    /// The file cannot be read.
    fn bytes(&mut self, path: &str) -> Result<Vec<u8>, Diagnostics> {
        Err(Diagnostic::error("file-unreadable", format!("there is no file {path}")).into())
    }
}

impl<F: FnMut(&str) -> Result<(String, String), Diagnostics>> Load for F {
    fn text(&mut self, path: &str) -> Result<(String, String), Diagnostics> {
        self(path)
    }
}
