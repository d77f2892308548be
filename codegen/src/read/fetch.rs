//! Loading of files that a description names.

use crate::diagnostic::{Diagnostic, Diagnostics};

/// Function that loads a text that a description names. It returns the name of the text in diagnostics, and
/// the text. The path is relative to the folder of the first description, even if another description names
/// it.
pub type Load<'l> = dyn FnMut(&str) -> Result<(String, String), Diagnostics> + 'l;

/// Loads texts as [`Load`] does, and other files.
pub(super) trait Fetch {
    /// Name of a text in diagnostics, and the text.
    fn text(&mut self, path: &str) -> Result<(String, String), Diagnostics>;

    /// Content of a file that is not text, for example a mesh.
    fn bytes(&mut self, path: &str) -> Result<Vec<u8>, Diagnostics>;
}

/// Loader for texts only.
pub(super) struct Texts<'l, 'f>(pub &'l mut Load<'f>);

impl Fetch for Texts<'_, '_> {
    fn text(&mut self, path: &str) -> Result<(String, String), Diagnostics> {
        (self.0)(path)
    }

    fn bytes(&mut self, path: &str) -> Result<Vec<u8>, Diagnostics> {
        Err(Diagnostic::error("file-unreadable", format!("there is no file {path}")).into())
    }
}
