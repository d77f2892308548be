//! Lock for Symbolica. Without a key, Symbolica allows only one instance per machine. The lock is an advisory
//! lock on a file that all users share.
//!
//! If a process starts a second instance, Symbolica ends this process, and no error handling can prevent this.
//! Programs that use this lock never start a second instance. Programs that use Symbolica without the lock, or that have
//! another folder for temporary files, are not affected.

use std::fs::{File, OpenOptions, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};
use std::thread;
use std::time::Duration;

use crate::diagnostic::{Diagnostic, Diagnostics};

/// Longest time that [`Instance::acquire`] waits for another process that uses Symbolica.
pub const PATIENCE: Duration = Duration::from_secs(120);

/// Pause between two attempts to lock the file.
const PAUSE: Duration = Duration::from_millis(100);

/// The file whose lock permits the use of Symbolica. It is kept until the process ends, because a process
/// that has used Symbolica remains an instance.
static LOCK: OnceLock<File> = OnceLock::new();

/// Lock between the threads of this process, which use Symbolica one after another.
static TURN: Mutex<()> = Mutex::new(());

/// Permission to use Symbolica on this thread until the value is dropped. Other processes wait until this
/// process ends, because only then the operating system unlocks the file.
#[derive(Debug)]
pub struct Instance {
    _turn: MutexGuard<'static, ()>,
}

impl Instance {
    /// Waits for the lock for at most [`PATIENCE`]. If the lock is not free at once, `on_wait` is called with
    /// the path of the locked file.
    ///
    /// # Errors
    /// - `symbolica-busy` if another process has the lock for longer than [`PATIENCE`]
    /// - `symbolica-lock` if the file cannot be locked
    pub fn acquire(on_wait: &mut dyn FnMut(&Path)) -> Result<Self, Diagnostics> {
        // The mutex has no data that a panic could have left inconsistent.
        let turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
        if LOCK.get().is_none() {
            let file = locked(&lock_file(), PATIENCE, on_wait)?;
            // This thread has the mutex, so no other thread sets the lock.
            let _ = LOCK.set(file);
        }
        Ok(Self { _turn: turn })
    }
}

/// Opens and locks the file at `path`. Waits for at most `patience`.
fn locked(path: &Path, patience: Duration, on_wait: &mut dyn FnMut(&Path)) -> Result<File, Diagnostics> {
    let file = open(path).map_err(|error| problem(unusable(path, &error)))?;
    let mut waited = Duration::ZERO;
    loop {
        match file.try_lock() {
            Ok(()) => return Ok(file),
            Err(TryLockError::Error(error)) => return Err(problem(unusable(path, &error))),
            Err(TryLockError::WouldBlock) if waited >= patience => {
                return Err(problem(busy(path, patience)));
            }
            Err(TryLockError::WouldBlock) => {
                if waited.is_zero() {
                    on_wait(path);
                }
                thread::sleep(PAUSE);
                waited += PAUSE;
            }
        }
    }
}

/// Path of the locked file. The file stays empty and is not removed.
pub fn lock_file() -> PathBuf {
    std::env::temp_dir().join("gelenk-symbolica.lock")
}

/// Opens the file for reading. This is enough for a lock, so even a file of another user can be locked.
fn open(path: &Path) -> io::Result<File> {
    match File::open(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            let made = OpenOptions::new().append(true).create(true).open(path);
            made.or_else(|_| File::open(path))
        }
        opened => opened,
    }
}

fn problem(diagnostic: Diagnostic) -> Diagnostics {
    Diagnostics::new(vec![diagnostic])
}

fn busy(path: &Path, patience: Duration) -> Diagnostic {
    Diagnostic::error(
        "symbolica-busy",
        format!(
            "another process has been using Symbolica for more than {} s; only one process may use Symbolica without a key",
            patience.as_secs()
        ),
    )
    .help(format!("wait until that process ends, or find and end the process that has `{}` open", path.display()))
}

fn unusable(path: &Path, error: &io::Error) -> Diagnostic {
    Diagnostic::error("symbolica-lock", format!("cannot lock `{}`: {error}", path.display()))
        .help("set TMPDIR to a folder on a local disk in which files can be created and locked")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_second_waits_says_so_once_and_fails() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("lock");
        let first = locked(&path, Duration::ZERO, &mut |_| panic!("free")).unwrap();
        let mut told = 0;
        let patience = Duration::from_millis(250);
        let refused = locked(&path, patience, &mut |_| told += 1).unwrap_err();
        assert_eq!((refused.entries()[0].code, told), ("symbolica-busy", 1));
        drop(first);
        assert!(locked(&path, Duration::ZERO, &mut |_| ()).is_ok());
    }

    #[test]
    fn a_folder_that_is_not_there_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("none").join("lock");
        let refused = locked(&path, Duration::ZERO, &mut |_| ()).unwrap_err();
        assert_eq!(refused.entries()[0].code, "symbolica-lock");
    }
}
