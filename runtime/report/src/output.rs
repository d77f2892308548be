//! The results of a report: its page, its data, its files.

use std::path::{Path, PathBuf};

use super::block::Section;
use super::error::ReportError;
use super::report::Report;
use super::{data, files, page};

impl Report {
    /// The page: one self-contained HTML file.
    ///
    /// # Errors
    /// [`ReportError::Equation`] where an equation is not LaTeX that can be set, [`ReportError::Plot`] where a
    /// figure has values that cannot be drawn, [`ReportError::SameId`] where two parts share an identifier.
    pub fn html(&self) -> Result<String, ReportError> {
        self.check_ids()?;
        page::html(self)
    }

    /// All numbers as JSON, unrounded; not-a-number and infinities as text.
    #[must_use]
    pub fn json(&self) -> String {
        format!("{:#}\n", data::json(self))
    }

    /// Name and text of one CSV file for each table, list of claims and figure.
    ///
    /// # Errors
    /// [`ReportError::Data`] where the writer fails.
    pub fn csv(&self) -> Result<Vec<(String, String)>, ReportError> {
        data::csv(self)
    }

    /// Writes `index.html`, `report.json` and the CSV files into `folder`, which is made where it is missing;
    /// returns the files, the page first. A report that was written there before is replaced, as a whole: on
    /// a full disk the old one stays.
    ///
    /// # Errors
    /// As [`Report::html`] and [`Report::csv`], before anything is written; [`ReportError::File`] where a
    /// file cannot be written, or holds what no report has written.
    pub fn write(&self, folder: &Path) -> Result<Vec<PathBuf>, ReportError> {
        let mut files =
            vec![("index.html".to_owned(), self.html()?), ("report.json".to_owned(), self.json())];
        files.extend(self.csv()?);
        files::write(folder, &files)
    }

    /// Identifiers name anchors of the page and files: each stands once.
    fn check_ids(&self) -> Result<(), ReportError> {
        let mut ids: Vec<&str> = self.sections.iter().flat_map(Section::ids).collect();
        ids.sort_unstable();
        match ids.windows(2).find(|pair| pair[0] == pair[1]) {
            Some(pair) => Err(ReportError::SameId(pair[0].to_owned())),
            None => Ok(()),
        }
    }
}
