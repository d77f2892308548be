//! Output of a report: page, data and files.

use std::path::{Path, PathBuf};

use super::block::Section;
use super::error::ReportError;
use super::report::Report;
use super::{data, files, page};

impl Report {
    /// The page as one self-contained HTML file.
    ///
    /// # Errors
    /// [`ReportError::Equation`] if an equation cannot be typeset, [`ReportError::Plot`] if a figure has
    /// values that cannot be drawn, [`ReportError::SameId`] if two parts share an identifier.
    pub fn html(&self) -> Result<String, ReportError> {
        self.check_ids()?;
        page::html(self)
    }

    /// All numbers as unrounded JSON; NaN and infinities are texts.
    #[must_use]
    pub fn json(&self) -> String {
        format!("{:#}\n", data::json(self))
    }

    /// Name and text of one CSV file per table, list of claims and figure.
    ///
    /// # Errors
    /// [`ReportError::Data`] if the writer fails.
    pub fn csv(&self) -> Result<Vec<(String, String)>, ReportError> {
        data::csv(self)
    }

    /// Name and text of one SVG file per plot, with legend.
    ///
    /// # Errors
    /// [`ReportError::Plot`] if a figure has values that cannot be drawn.
    pub fn svg(&self) -> Result<Vec<(String, String)>, ReportError> {
        data::svg(self)
    }

    /// Writes `index.html`, `report.json`, the CSV and SVG files to `folder`, which is created if missing;
    /// returns the files, the page first. A previous report in the folder is replaced as a whole; if the disk
    /// is full, it is kept.
    ///
    /// # Errors
    /// The errors of [`Report::html`] and [`Report::csv`], before anything is written; [`ReportError::File`]
    /// if a file cannot be written, or exists and was not written by a report.
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
