//! The shared reference data, where they are at hand.

use std::path::PathBuf;

/// A file of `$GELENK_SHARED`, or of the folder `shared` next to the repository; none with a note where it is
/// missing.
pub fn shared(path: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("GELENK_SHARED").map(PathBuf::from);
    let beside = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../shared");
    let file = folder.unwrap_or(beside).join(path);
    if file.exists() {
        return Some(file);
    }
    println!("skipped: {} is not there; set GELENK_SHARED", file.display());
    None
}
