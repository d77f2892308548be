//! How the files that a description names are fetched.

use crate::diagnostic::Diagnostics;

/// Fetches a file that a description names: its name for diagnostics, and its text. The path is relative to
/// the folder of the first description, also where another one names it.
pub type Load<'l> = dyn FnMut(&str) -> Result<(String, String), Diagnostics> + 'l;
