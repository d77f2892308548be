//! Writing on change, never over files of others, and the check that nothing would change.

use std::fmt;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::crate_root::{begins_with, is_generated, is_root};
use gelenk_files::{Prepared, is_same_file, target};

/// The outcome of writing a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// It was new or differed, and was written.
    Written,
    /// It held this text already and was not touched.
    Unchanged,
}

/// The files that may be written over, by their content. Empty files always may be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Replaces {
    /// A generated module.
    Module,
    /// The root of a crate of generated modules.
    Root,
    /// A robot in another format, as `gelenk export` writes it.
    Export,
    /// Anything: the name of the file is one that only build scripts of ours write, in the folder of their
    /// output.
    Helper,
    /// Nothing: files that were written earlier cannot be distinguished from a user's file.
    Nothing,
}

/// A text and the file that may hold it. Several are planned before the first is written, so that a refusal
/// leaves all files as they were.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Planned<'t> {
    path: PathBuf,
    text: &'t str,
    outcome: Outcome,
}

/// A file that is not written.
#[derive(Debug)]
pub enum WriteError {
    /// The system refuses, or the file is none that can be replaced.
    System {
        /// The file.
        path: PathBuf,
        /// The error of the system.
        source: io::Error,
    },
    /// The file was read, by this name or another.
    Read {
        /// The file.
        path: PathBuf,
        /// The name by which it was read.
        read: PathBuf,
    },
    /// The file holds something that was not generated.
    Foreign {
        /// The file.
        path: PathBuf,
    },
}

impl fmt::Display for WriteError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (Self::System { path, .. } | Self::Read { path, .. } | Self::Foreign { path }) = self;
        write!(f, "cannot write {}: ", path.display())?;
        match self {
            Self::System { source, .. } => source.fmt(f)?,
            Self::Read { read, .. } if path == read => {
                f.write_str("the description was read from it")?;
            }
            Self::Read { read, .. } => {
                write!(f, "it is {}, which was read for the description", read.display())?;
            }
            Self::Foreign { .. } => f.write_str("gelenk has not generated it")?,
        }
        f.write_str(match self {
            Self::System { .. } => "\n  = help: name a file that may be written",
            Self::Read { .. } => "\n  = help: name another file",
            Self::Foreign { .. } => "\n  = help: name another file, or remove this one first",
        })
    }
}

impl std::error::Error for WriteError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::System { source, .. } => Some(source),
            Self::Read { .. } | Self::Foreign { .. } => None,
        }
    }
}

impl<'t> Planned<'t> {
    /// A file that may be written: one that is new, empty or unchanged, or that holds what `replaces` names,
    /// and that is none of the files that were `read`.
    ///
    /// # Errors
    /// [`WriteError`], also for folders, devices, links to nothing and what is read-only.
    pub fn new(path: &Path, text: &'t str, replaces: Replaces, read: &[PathBuf]) -> Result<Self, WriteError> {
        let path = path.to_owned();
        if let Some(read) = read.iter().find(|read| is_same_file(read, &path)) {
            let read = read.clone();
            return Err(WriteError::Read { path, read });
        }
        let is_unchanged = is_fresh(&path, text);
        if !is_unchanged {
            if let Err(source) = target(&path) {
                return Err(WriteError::System { path, source });
            }
            if !replaces.covers(&path) {
                return Err(WriteError::Foreign { path });
            }
        }
        let outcome = match is_unchanged {
            true => Outcome::Unchanged,
            false => Outcome::Written,
        };
        Ok(Self { path, text, outcome })
    }

    /// Where it goes.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes the text where the file differs: into a new file of the same folder, which then takes the old
    /// one's place at once. Missing folders are made.
    ///
    /// # Errors
    /// [`WriteError::System`]; the old file is then as it was.
    pub fn write(&self) -> Result<Outcome, WriteError> {
        if self.outcome == Outcome::Written {
            let prepared = Prepared::new(&self.path, self.text.as_bytes());
            prepared.and_then(Prepared::put).map_err(|source| {
                let path = self.path.clone();
                WriteError::System { path, source }
            })?;
        }
        Ok(self.outcome)
    }
}

impl Replaces {
    /// Whether the file at `path` may be removed.
    fn covers(self, path: &Path) -> bool {
        match fs::metadata(path) {
            Err(_) => true,
            Ok(found) if found.len() == 0 => true,
            Ok(_) => match self {
                Self::Module => is_generated(path),
                Self::Root => is_root(path),
                Self::Export => begins_with(path, crate::export::FIRST_LINE),
                Self::Helper => true,
                Self::Nothing => false,
            },
        }
    }
}

/// Whether the file at `path` holds exactly `text`. A file that cannot be read is not fresh.
#[must_use]
pub fn check(path: &Path, text: &str) -> bool {
    is_fresh(path, text)
}

fn is_fresh(path: &Path, text: &str) -> bool {
    fs::metadata(path).is_ok_and(|found| found.is_file() && found.len() == text.len() as u64)
        && fs::read(path).is_ok_and(|bytes| bytes == text.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::emit::FIRST_LINE;

    fn module(body: &str) -> String {
        format!("{FIRST_LINE}\n{body}\n")
    }

    fn write(path: &Path, text: &str) -> Result<Outcome, WriteError> {
        Planned::new(path, text, Replaces::Module, &[])?.write()
    }

    #[test]
    fn writes_once_and_leaves_no_other_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("deep/robot.rs");
        let (a, b) = (module("a"), module("b"));
        assert_eq!(write(&path, &a).unwrap(), Outcome::Written);
        let time = fs::metadata(&path).unwrap().modified().unwrap();
        assert_eq!(write(&path, &a).unwrap(), Outcome::Unchanged);
        assert_eq!(fs::metadata(&path).unwrap().modified().unwrap(), time);
        assert_eq!(write(&path, &b).unwrap(), Outcome::Written);
        assert!(check(&path, &b) && !check(&path, &a));
        assert_eq!(fs::read_dir(folder.path().join("deep")).unwrap().count(), 1);
    }

    #[test]
    fn a_folder_is_kept() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("robot.rs");
        fs::create_dir(&path).unwrap();
        let error = write(&path, "a\n").unwrap_err();
        assert!(error.to_string().contains("robot.rs: it is a folder"));
        assert!(path.is_dir());
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn what_is_not_generated_is_kept() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("main.rs");
        fs::write(&path, "fn main() {}\n").unwrap();
        for replaces in [Replaces::Module, Replaces::Root, Replaces::Export, Replaces::Nothing] {
            let error = Planned::new(&path, "new", replaces, &[]).unwrap_err();
            assert!(error.to_string().contains("has not generated"), "{error}");
        }
        // Nothing to write is nothing to refuse; an empty file waits to be filled.
        let same = Planned::new(&path, "fn main() {}\n", Replaces::Nothing, &[]).unwrap();
        assert_eq!(same.write().unwrap(), Outcome::Unchanged);
        fs::write(&path, "").unwrap();
        assert_eq!(write(&path, "a").unwrap(), Outcome::Written);
    }

    #[test]
    fn read_only_files_are_kept() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("robot.rs");
        let old = module("old");
        fs::write(&path, &old).unwrap();
        let mut rights = fs::metadata(&path).unwrap().permissions();
        rights.set_readonly(true);
        fs::set_permissions(&path, rights).unwrap();
        let error = write(&path, &module("new")).unwrap_err();
        assert!(error.to_string().contains("it is read-only"), "{error}");
        assert!(check(&path, &old));
        assert_eq!(write(&path, &old).unwrap(), Outcome::Unchanged);
    }

    #[cfg(unix)]
    #[test]
    fn rights_stay() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("robot.rs");
        fs::write(&path, module("old")).unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
        write(&path, &module("new")).unwrap();
        let mode = fs::metadata(&path).unwrap().permissions().mode();
        assert_eq!(mode & 0o777, 0o640);
    }

    #[cfg(unix)]
    #[test]
    fn devices_and_links_to_nothing_are_kept() {
        let folder = tempfile::tempdir().unwrap();
        let link = folder.path().join("robot.rs");
        for (to, why) in [
            (Path::new("/dev/null"), "a device"),
            (&folder.path().join("none"), "a file that does not exist"),
        ] {
            std::os::unix::fs::symlink(to, &link).unwrap();
            let error = write(&link, "a").unwrap_err();
            assert!(error.to_string().contains(why), "{error}");
            assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
            fs::remove_file(&link).unwrap();
        }
    }

    #[cfg(unix)]
    #[test]
    fn a_link_stays_a_link() {
        let folder = tempfile::tempdir().unwrap();
        let (file, link) = (folder.path().join("file.rs"), folder.path().join("link.rs"));
        let new = module("new");
        fs::write(&file, module("old")).unwrap();
        std::os::unix::fs::symlink(&file, &link).unwrap();
        write(&link, &new).unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::read_to_string(&file).unwrap(), new);
    }

    #[cfg(unix)]
    #[test]
    fn what_was_read_is_kept_under_all_of_its_names() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        // Even where it could pass for a module.
        let text = module("[[joints]]");
        fs::write(at("robot.toml"), &text).unwrap();
        std::os::unix::fs::symlink("robot.toml", at("symbolic.rs")).unwrap();
        fs::hard_link(at("robot.toml"), at("hard.rs")).unwrap();
        let read = [at("robot.toml")];
        for name in ["robot.toml", "symbolic.rs", "hard.rs", "../robot.toml"] {
            let path = match name.strip_prefix("../") {
                Some(name) => folder.path().join(".").join(name),
                None => at(name),
            };
            let error = Planned::new(&path, "new", Replaces::Module, &read).unwrap_err();
            assert!(error.to_string().contains("read"), "{error}");
        }
        assert_eq!(fs::read_to_string(at("robot.toml")).unwrap(), text);
    }
}
