//! How the files that a description names are fetched.

use crate::diagnostic::{Diagnostic, Diagnostics};

/// Fetches a text that a description names: its name for diagnostics, and its text. The path is relative to
/// the folder of the first description, also where another one names it.
pub type Load<'l> = dyn FnMut(&str) -> Result<(String, String), Diagnostics> + 'l;

/// Fetches texts, as [`Load`], and other files.
pub(super) trait Fetch {
    /// The name of a text for diagnostics, and the text.
    fn text(&mut self, path: &str) -> Result<(String, String), Diagnostics>;

    /// The content of a file that is not a text, such as a mesh.
    fn bytes(&mut self, path: &str) -> Result<Vec<u8>, Diagnostics>;
}

/// Texts without other files.
pub(super) struct Texts<'l, 'f>(pub &'l mut Load<'f>);

impl Fetch for Texts<'_, '_> {
    fn text(&mut self, path: &str) -> Result<(String, String), Diagnostics> {
        (self.0)(path)
    }

    fn bytes(&mut self, path: &str) -> Result<Vec<u8>, Diagnostics> {
        Err(Diagnostic::error("file-unreadable", format!("there is no file {path}")).into())
    }
}
