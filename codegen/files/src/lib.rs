//! Writes files atomically: if the disk is full or the program is killed, the old file stays unchanged.

use std::fs::{self, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

/// Writes a file atomically: a temporary file in the same folder replaces the old file. Missing folders are
/// created. If the path is a link, its target is replaced.
///
/// ```
/// # let folder = tempfile::tempdir()?;
/// let path = folder.path().join("results/errors.csv");
/// gelenk_files::write_whole(&path, "time,error\n0,0.001\n")?;
/// assert!(std::fs::read_to_string(path)?.starts_with("time"));
/// # Ok::<(), std::io::Error>(())
/// ```
///
/// Returns errors of the file system. Folders, devices, dangling links and read-only files cannot be replaced.
pub fn write_whole(path: &Path, content: impl AsRef<[u8]>) -> io::Result<()> {
    Prepared::new(path, content.as_ref())?.put()
}

/// A temporary file next to its target, ready to replace the target. The old file stays unchanged until then.
#[derive(Debug)]
pub struct Prepared {
    file: NamedTempFile,
    target: PathBuf,
}

impl Prepared {
    /// Writes the content to a temporary file in the folder of `path`. The folder is created if it is
    /// missing. If the path is a link, [`Self::put`] keeps the link and replaces its target.
    ///
    /// Returns errors of the file system, and errors for paths that [`target`] rejects.
    pub fn new(path: &Path, content: &[u8]) -> io::Result<Self> {
        let target = target(path)?;
        let folder = match target.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent,
            _ => Path::new("."),
        };
        fs::create_dir_all(folder)?;
        let mut file = temporary_file(folder)?;
        if let Ok(old) = fs::metadata(&target) {
            file.as_file().set_permissions(old.permissions())?;
        }
        // `write_all` is called on the inner file, because errors of the wrapper would name the temporary file.
        file.as_file_mut().write_all(content)?;
        file.as_file().sync_data()?;
        Ok(Self { file, target })
    }

    /// Renames the temporary file to its target.
    ///
    /// Returns errors of the file system. The old file then stays unchanged.
    pub fn put(self) -> io::Result<()> {
        self.file.persist(self.target).map_err(|error| error.error)?;
        Ok(())
    }
}

/// Returns the target of a path after following its links. The target need not exist.
///
/// # Errors
/// Folders, devices, pipes, dangling links and read-only files cannot be replaced.
pub fn target(path: &Path) -> io::Result<PathBuf> {
    let refused = |kind, why: &str| Err(io::Error::new(kind, why));
    match fs::metadata(path) {
        Ok(found) if found.is_dir() => refused(io::ErrorKind::IsADirectory, "it is a folder"),
        Ok(found) if !found.is_file() => {
            refused(io::ErrorKind::InvalidInput, "it is a device or a pipe, not a file")
        }
        // Read-only files are checked separately, because the superuser could write them.
        Ok(found) if found.permissions().readonly() => {
            refused(io::ErrorKind::PermissionDenied, "it is read-only")
        }
        Ok(_) => {
            // Renaming needs only write permission for the folder. Opening the file checks the permission for
            // the file.
            OpenOptions::new().append(true).open(path)?;
            fs::canonicalize(path)
        }
        Err(_) if fs::symlink_metadata(path).is_ok_and(|found| found.is_symlink()) => {
            refused(io::ErrorKind::NotFound, "the link points to a file that does not exist")
        }
        Err(_) => Ok(path.to_owned()),
    }
}

/// Whether both paths lead to the same file. Symbolic and hard links are followed.
pub fn is_same_file(one: &Path, other: &Path) -> bool {
    match (identity(one), identity(other)) {
        (Ok(one), Ok(other)) => one == other,
        _ => false,
    }
}

/// Identity of a file, which is the same for all its hard links: device and inode.
#[cfg(unix)]
fn identity(path: &Path) -> io::Result<(u64, u64)> {
    use std::os::unix::fs::MetadataExt;
    let found = fs::metadata(path)?;
    Ok((found.dev(), found.ino()))
}

#[cfg(not(unix))]
fn identity(path: &Path) -> io::Result<PathBuf> {
    fs::canonicalize(path)
}

/// Creates a temporary file with the permissions of an ordinary new file. Without this setting, only its owner
/// could read it.
fn temporary_file(folder: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let made = builder.prefix(".gelenk-").tempfile_in(folder);
    made.map_err(|error| error.kind().into())
}
