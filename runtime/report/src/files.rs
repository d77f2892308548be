//! Writes the files of a report. Either all files or no files are written. Files that were not written by a report are
//! never replaced.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use serde_json::Value;

use super::error::ReportError;
use super::{data, page};
use gelenk_files::Prepared;

const PAGE: &str = "index.html";
const DATA: &str = "report.json";

/// Writes files to a folder. Removes tables of the previous report that the new report does not have.
pub(super) fn write(folder: &Path, files: &[(String, String)]) -> Result<Vec<PathBuf>, ReportError> {
    let old = old_tables(folder);
    if folder.is_file() {
        let why = io::Error::new(io::ErrorKind::NotADirectory, "this path is a file, not a folder");
        return Err(fault(folder)(why));
    }
    fs::create_dir_all(folder).map_err(fault(folder))?;
    for (name, content) in files {
        check(folder, name, content, &old).map_err(fault(&folder.join(name)))?;
    }
    let mut prepared = Vec::new();
    for (name, content) in files {
        let path = folder.join(name);
        let file = Prepared::new(&path, content.as_bytes()).map_err(fault(&path))?;
        prepared.push((name.as_str(), path, file));
    }
    let paths = prepared.iter().map(|(_, path, _)| path.clone()).collect();
    // The file with the names of the tables is written first. If writing is interrupted, the next report can then
    // recognize the tables.
    prepared.sort_by_key(|(name, ..)| (*name != DATA, *name == PAGE));
    for (_, path, file) in prepared {
        file.put().map_err(fault(&path))?;
    }
    let is_gone = |name: &&String| !files.iter().any(|(new, _)| new == *name);
    for name in old.iter().filter(is_gone) {
        // An error is ignored, because an additional table in the folder does no harm.
        let _ = fs::remove_file(folder.join(name));
    }
    Ok(paths)
}

fn fault(path: &Path) -> impl FnOnce(io::Error) -> ReportError + use<> {
    let path = path.to_owned();
    move |source| ReportError::File { path, source }
}

/// Checks that a file may be written. This is the case if the file does not exist, is empty, has the same content, or was
/// written by a report.
fn check(folder: &Path, name: &str, content: &str, old: &[String]) -> io::Result<()> {
    if !is_plain(name) {
        let why = "an identifier can be a file name only if it consists of letters, digits, `-` and `_`";
        return Err(io::Error::new(io::ErrorKind::InvalidInput, why));
    }
    let path = folder.join(name);
    let Ok(found) = fs::metadata(&path) else {
        return Ok(());
    };
    // Folders and other objects are rejected later, when the file is moved to this path.
    if !found.is_file() || found.len() == 0 {
        return Ok(());
    }
    let text = fs::read(&path)?;
    let is_ours = match name {
        PAGE => page::is_page(&text),
        DATA => serde_json::from_slice(&text).is_ok_and(|value| data::is_report(&value)),
        table => old.iter().any(|known| known == table),
    };
    if is_ours || text == content.as_bytes() {
        return Ok(());
    }
    let why = "this file was not written by a report; choose another folder, or remove this file first";
    Err(io::Error::new(io::ErrorKind::AlreadyExists, why))
}

/// Names of the tables of the report in a folder.
fn old_tables(folder: &Path) -> Vec<String> {
    let value = fs::read(folder.join(DATA))
        .ok()
        .and_then(|text| serde_json::from_slice::<Value>(&text).ok())
        .filter(data::is_report);
    let mut names = value.as_ref().map(data::tables).unwrap_or_default();
    names.retain(|name| is_plain(name));
    names
}

/// Whether a name has no path to another folder.
fn is_plain(name: &str) -> bool {
    let is_usual = |letter: char| letter.is_alphanumeric() || "-_.".contains(letter);
    !name.starts_with('.') && name.chars().all(is_usual)
}

#[cfg(test)]
mod tests {
    use super::super::{Block, Cell, Report, Section, Table};
    use super::*;

    fn report(title: &str, table: &str) -> Report {
        let table = Table::new(table, "Numbers.").column("Name", "name", "").row([Cell::text("a")]);
        Report::new(title).section(Section::new("numbers", "Numbers").block(Block::Table(table)))
    }

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        let mut names: Vec<String> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn a_report_takes_the_place_of_another_and_of_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        report("First", "first").write(folder.path()).unwrap();
        fs::write(at("mine.csv"), "t,q\n").unwrap();
        report("Second", "second").write(folder.path()).unwrap();
        let expected = ["index.html", "mine.csv", "report.json", "second.csv"];
        assert_eq!(names(folder.path()), expected);

        let before = fs::read(at("index.html")).unwrap();
        let error = report("Third", "mine").write(folder.path()).unwrap_err();
        let message = error.to_string();
        assert!(message.contains("mine.csv: this file was not written by a report"), "{message}");
        assert_eq!(fs::read(at("index.html")).unwrap(), before);
        assert_eq!(fs::read_to_string(at("mine.csv")).unwrap(), "t,q\n");
        assert_eq!(names(folder.path()), expected);
    }

    #[test]
    fn pages_with_other_words_are_known() {
        let folder = tempfile::tempdir().unwrap();
        report("Arm", "numbers-1").write(folder.path()).unwrap();
        let page = folder.path().join("index.html");
        let text = fs::read_to_string(&page).unwrap();
        let older = text.replace("are next to this page in", "stand beside this page in");
        assert_ne!(text, older);
        fs::write(&page, older).unwrap();
        report("Arm", "numbers-1").write(folder.path()).unwrap();
        assert_eq!(fs::read_to_string(&page).unwrap(), text);
    }

    #[test]
    fn foreign_pages_and_data_are_kept() {
        for (name, text) in [("index.html", "<h1>My arm</h1>"), ("report.json", "{\"title\": 1}")] {
            let folder = tempfile::tempdir().unwrap();
            fs::write(folder.path().join(name), text).unwrap();
            let error = report("Arm", "numbers-1").write(folder.path()).unwrap_err();
            assert!(error.to_string().contains(name), "{error}");
            assert_eq!(names(folder.path()), [name]);
            fs::write(folder.path().join(name), "").unwrap();
            assert!(report("Arm", "numbers-1").write(folder.path()).is_ok());
        }
    }

    #[test]
    fn names_stay_in_the_folder() {
        let folder = tempfile::tempdir().unwrap();
        let error = report("Arm", "../outside").write(folder.path()).unwrap_err();
        assert!(error.to_string().contains("can be a file name only if"), "{error}");
        assert_eq!(names(folder.path()), [""; 0]);
    }
}
