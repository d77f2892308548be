//! The root of a crate of generated modules: `generated/src/lib.rs`.

use std::fs;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use crate::emit::FIRST_LINE;

/// Whether a file was written by this program.
#[must_use]
pub fn is_generated(path: &Path) -> bool {
    let mut start = Vec::new();
    let length = FIRST_LINE.len() as u64;
    let read = fs::File::open(path).and_then(|file| file.take(length).read_to_end(&mut start));
    read.is_ok() && start == FIRST_LINE.as_bytes()
}

/// Generated modules in `folder` whose names are not among `modules`, in alphabetical order.
///
/// # Errors
/// Those of reading the folder; one that does not exist is empty.
pub fn left_over(folder: &Path, modules: &[String]) -> io::Result<Vec<PathBuf>> {
    let entries = match fs::read_dir(folder) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(vec![]),
        entries => entries?,
    };
    let mut paths: Vec<PathBuf> = entries
        .map(|entry| entry.map(|entry| entry.path()))
        .collect::<Result<_, _>>()?;
    paths.retain(|path| {
        let name = path
            .file_stem()
            .and_then(|stem| stem.to_str())
            .unwrap_or_default();
        let is_rust = path.extension().is_some_and(|extension| extension == "rs");
        is_rust
            && name != "lib"
            && !modules.iter().any(|module| module == name)
            && is_generated(path)
    });
    paths.sort();
    Ok(paths)
}

/// Text of the crate's root: one public module for each name, in alphabetical order.
#[must_use]
pub fn root_text(modules: &[String]) -> String {
    let mut names: Vec<&String> = modules.iter().collect();
    names.sort();
    names.dedup();
    let mut text = String::from(
        "//! The robots of `models/` as generated Rust: plain functions on fixed-size arrays.\n\
         //!\n\
         //! `gelenk generate` writes this crate; `gelenk check` tells whether it is fresh.\n\
         #![no_std]\n",
    );
    for name in names {
        // Each file keeps the layout of the generator, which no rustfmt version changes.
        text.push_str(&format!(
            "\n/// The robot `{name}`.\n#[rustfmt::skip]\npub mod {name};\n"
        ));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_generated_files_are_left_over() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
        write("old.rs", &format!("{FIRST_LINE}\n//\n"));
        write("new.rs", &format!("{FIRST_LINE}\n//\n"));
        write("mine.rs", "// by hand\n");
        write("lib.rs", &format!("{FIRST_LINE}\n"));
        let paths = left_over(folder.path(), &["new".to_owned()]).unwrap();
        assert_eq!(paths, [folder.path().join("old.rs")]);
        assert!(
            left_over(&folder.path().join("none"), &[])
                .unwrap()
                .is_empty()
        );
    }

    #[test]
    fn modules_are_sorted() {
        let text = root_text(&["ur5".to_owned(), "panda".to_owned()]);
        assert!(text.find("pub mod panda;").unwrap() < text.find("pub mod ur5;").unwrap());
    }
}
