//! Loading of files that a description names.

use crate::diagnostic::{Diagnostic, Diagnostics};

/// Function that loads a text that a description names. Returns the name of the text in diagnostics, and the
/// text. The path is relative to the folder of the first description, even if another description names it.
pub type Load<'l> = dyn FnMut(&str) -> Result<(String, String), Diagnostics> + 'l;

/// Loads texts as [`Load`] does, and also binary files such as meshes.
pub(super) trait Fetch {
    /// Loads a text. Returns its name in diagnostics, and the text.
    fn text(&mut self, path: &str) -> Result<(String, String), Diagnostics>;

    /// Content of a file that is not text, for example a mesh.
    fn bytes(&mut self, path: &str) -> Result<Vec<u8>, Diagnostics>;
}

/// Loader for texts only. Meshes and other binary files are errors.
pub(super) struct Texts<'l, 'f>(pub &'l mut Load<'f>);

impl Fetch for Texts<'_, '_> {
    fn text(&mut self, path: &str) -> Result<(String, String), Diagnostics> {
        (self.0)(path)
    }

    fn bytes(&mut self, path: &str) -> Result<Vec<u8>, Diagnostics> {
        Err(Diagnostic::error("file-unreadable", format!("there is no file {path}")).into())
    }
}
