//! Writing on change, and the check that nothing would change.

use std::fmt;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// What became of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// It was new or differed, and was written.
    Written,
    /// It held this text already and was not touched.
    Unchanged,
}

/// A file that could not be written or read.
#[derive(Debug)]
pub struct WriteError {
    /// The file.
    pub path: PathBuf,
    /// What the system said.
    pub source: io::Error,
}

impl fmt::Display for WriteError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "cannot write {}: {}", self.path.display(), self.source)
    }
}

impl std::error::Error for WriteError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        Some(&self.source)
    }
}

/// Writes `text` to `path` where that differs: into a new file of the same folder, which then takes the old one's
/// place at once. Missing folders are made.
///
/// # Errors
/// [`WriteError`] with the system's message; the old file is then as it was.
pub fn write(path: &Path, text: &str) -> Result<Outcome, WriteError> {
    if is_fresh(path, text) {
        return Ok(Outcome::Unchanged);
    }
    replace(path, text).map_err(|source| WriteError {
        path: path.to_owned(),
        source,
    })?;
    Ok(Outcome::Written)
}

/// Whether `path` holds exactly `text`. A file that cannot be read is not fresh.
#[must_use]
pub fn check(path: &Path, text: &str) -> bool {
    is_fresh(path, text)
}

fn is_fresh(path: &Path, text: &str) -> bool {
    fs::read(path).is_ok_and(|bytes| bytes == text.as_bytes())
}

fn replace(path: &Path, text: &str) -> io::Result<()> {
    let folder = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    fs::create_dir_all(folder)?;
    // Through a link the file it points to is replaced, not the link.
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let folder = target
        .parent()
        .filter(|parent| !parent.as_os_str().is_empty())
        .unwrap_or(folder);
    let mut file = temporary_file(folder)?;
    file.write_all(text.as_bytes())?;
    file.as_file().sync_data()?;
    file.persist(target).map_err(|error| error.error)?;
    Ok(())
}

/// A temporary file with the rights of an ordinary new one (by itself it would be for its owner alone).
#[cfg(unix)]
fn temporary_file(folder: &Path) -> io::Result<tempfile::NamedTempFile> {
    use std::os::unix::fs::PermissionsExt;
    let rights = fs::Permissions::from_mode(0o666);
    tempfile::Builder::new()
        .prefix(".gelenk-")
        .permissions(rights)
        .tempfile_in(folder)
}

#[cfg(not(unix))]
fn temporary_file(folder: &Path) -> io::Result<tempfile::NamedTempFile> {
    tempfile::Builder::new()
        .prefix(".gelenk-")
        .tempfile_in(folder)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn writes_once_and_leaves_no_other_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("deep/robot.rs");
        assert_eq!(write(&path, "a\n").unwrap(), Outcome::Written);
        let time = fs::metadata(&path).unwrap().modified().unwrap();
        assert_eq!(write(&path, "a\n").unwrap(), Outcome::Unchanged);
        assert_eq!(fs::metadata(&path).unwrap().modified().unwrap(), time);
        assert_eq!(write(&path, "b\n").unwrap(), Outcome::Written);
        assert!(check(&path, "b\n") && !check(&path, "a\n"));
        assert_eq!(fs::read_dir(folder.path().join("deep")).unwrap().count(), 1);
    }

    #[test]
    fn a_failure_keeps_the_old_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("robot.rs");
        fs::create_dir(&path).unwrap();
        let error = write(&path, "a\n").unwrap_err();
        assert!(error.to_string().starts_with("cannot write"));
        assert!(path.is_dir());
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[cfg(unix)]
    #[test]
    fn a_link_stays_a_link() {
        let folder = tempfile::tempdir().unwrap();
        let (file, link) = (folder.path().join("file.rs"), folder.path().join("link.rs"));
        fs::write(&file, "a").unwrap();
        std::os::unix::fs::symlink(&file, &link).unwrap();
        write(&link, "b").unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::read_to_string(&file).unwrap(), "b");
    }
}
