//! The root file of a crate of generated modules: `generated/src/lib.rs`.

use std::fs;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use crate::emit::{FIRST_LINE, FIRST_LINE_IN_PYTHON, documentation};

/// Whether gelenk generated the file.
#[must_use]
pub fn is_generated(path: &Path) -> bool {
    [FIRST_LINE, FIRST_LINE_IN_PYTHON].iter().any(|line| begins_with(path, line))
}

/// Whether a file is the root of a crate of generated modules, written from [`root_text`].
#[must_use]
pub fn is_root(path: &Path) -> bool {
    begins_with(path, ROOT)
}

pub(super) fn begins_with(path: &Path, expected: &str) -> bool {
    // Opening a named pipe would block until another process opens its other end.
    if !path.is_file() {
        return false;
    }
    let mut start = Vec::new();
    let length = expected.len() as u64;
    let read = fs::File::open(path).and_then(|file| file.take(length).read_to_end(&mut start));
    read.is_ok() && start == expected.as_bytes()
}

/// Beginning of the crate's root file, by which [`is_root`] recognizes the file. If this text changes, files of
/// older versions are refused.
const ROOT: &str = "//! The robots of `models/` as generated Rust: plain functions on fixed-size arrays.\n\
    //!\n\
    //! `gelenk generate` writes this crate";

/// Generated modules in `folder` whose names are not in `modules`, sorted.
///
/// # Errors
/// Errors of reading the folder; a missing folder counts as empty.
pub fn left_over(folder: &Path, modules: &[String]) -> io::Result<Vec<PathBuf>> {
    let entries = match fs::read_dir(folder) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(vec![]),
        entries => entries?,
    };
    let mut paths: Vec<PathBuf> =
        entries.map(|entry| entry.map(|entry| entry.path())).collect::<Result<_, _>>()?;
    paths.retain(|path| {
        let name = path.file_stem().and_then(|stem| stem.to_str()).unwrap_or_default();
        let is_rust = path.extension().is_some_and(|extension| extension == "rs");
        is_rust && name != "lib" && !modules.iter().any(|module| module == name) && is_generated(path)
    });
    paths.sort();
    Ok(paths)
}

/// Name and documentation of each generated module in `folder`.
///
/// # Errors
/// Errors of reading the folder and its files.
pub fn documented(folder: &Path) -> io::Result<Vec<(String, String)>> {
    let paths = left_over(folder, &[])?;
    let entry = |path: &PathBuf| {
        let name = path.file_stem().and_then(|stem| stem.to_str());
        let text = fs::read_to_string(path)?;
        Ok((name.unwrap_or_default().to_owned(), documentation(&text)))
    };
    paths.iter().map(entry).collect()
}

/// Text of the crate's root: one public module for each name, with its documentation, sorted by name. If a
/// name occurs twice, its first entry is used.
#[must_use]
pub fn root_text(modules: &[(String, String)]) -> String {
    let mut modules: Vec<&(String, String)> = modules.iter().collect();
    modules.sort_by_key(|(name, _)| name);
    modules.dedup_by_key(|(name, _)| name);
    let mut text = format!("{ROOT}; `gelenk check` checks that it is up to date.\n#![no_std]\n");
    for (name, documentation) in modules {
        text.push('\n');
        for line in documentation.lines() {
            text.push_str(format!("/// {line}").trim_end());
            text.push('\n');
        }
        // rustfmt does not change these files, because its versions differ in layout.
        text.push_str(&format!("#[rustfmt::skip]\npub mod {name};\n"));
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
        assert!(left_over(&folder.path().join("none"), &[]).unwrap().is_empty());
    }

    #[test]
    fn modules_are_sorted() {
        let module = |name: &str, lines: &str| (name.to_owned(), lines.to_owned());
        let modules =
            [module("ur5", "Six axes.\n"), module("panda", "Seven.\n\nSlim.\n"), module("ur5", "Old.\n")];
        let text = root_text(&modules);
        let expected = "\n/// Seven.\n///\n/// Slim.\n#[rustfmt::skip]\npub mod panda;\n\
            \n/// Six axes.\n#[rustfmt::skip]\npub mod ur5;\n";
        assert!(text.ends_with(expected), "{text}");
    }
}
