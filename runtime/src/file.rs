//! Files of results.

use std::io;
use std::path::Path;

use crate::replace::Prepared;

/// Writes a file whole or not at all: beside its place first, so that a full disk or the end of the program leaves the old
/// one as it was. Missing folders are made; through a link, the file that it points to is replaced.
///
/// # Errors
/// Those of the system, and what cannot be replaced: folders, devices, links to nothing, files that are read-only.
pub fn write_whole(path: &Path, content: impl AsRef<[u8]>) -> io::Result<()> {
    Prepared::new(path, content.as_ref())?.put()
}
