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
    /// [`ReportError::Equation`] if an equation is not LaTeX that can be set, [`ReportError::Plot`] if a
    /// figure has values that cannot be drawn, [`ReportError::SameId`] if two parts share an identifier.
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
    /// [`ReportError::Data`] if the writer fails.
    pub fn csv(&self) -> Result<Vec<(String, String)>, ReportError> {
        data::csv(self)
    }

    /// Name and text of one SVG file for each plot, with its legend.
    ///
    /// # Errors
    /// [`ReportError::Plot`] if a figure has values that cannot be drawn.
    pub fn svg(&self) -> Result<Vec<(String, String)>, ReportError> {
        data::svg(self)
    }

    /// Writes `index.html`, `report.json`, the CSV and the SVG files into `folder`, which is created if it does not exist;
    /// returns the files, the page first. A report that was written there before is replaced as a whole: on
    /// a full disk the old one remains.
    ///
    /// # Errors
    /// As [`Report::html`] and [`Report::csv`], before anything is written; [`ReportError::File`] if a
    /// file cannot be written, or exists and was not written by a report.
    pub fn write(&self, folder: &Path) -> Result<Vec<PathBuf>, ReportError> {
        let mut files =
            vec![("index.html".to_owned(), self.html()?), ("report.json".to_owned(), self.json())];
        files.extend(self.csv()?);
        files.extend(self.svg()?);
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
