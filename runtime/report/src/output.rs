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
    /// values that cannot be drawn, and [`ReportError::SameId`] if two parts have the same identifier.
    pub fn html(&self) -> Result<String, ReportError> {
        self.check_ids()?;
        page::html(self)
    }

    /// All numbers as JSON without rounding. NaN and infinities are texts.
    #[must_use]
    pub fn json(&self) -> String {
        format!("{:#}\n", data::json(self))
    }

    /// Name and text of one CSV file for each table, list of claims, figure and pattern.
    ///
    /// # Errors
    /// [`ReportError::Data`] if the CSV writer fails.
    pub fn csv(&self) -> Result<Vec<(String, String)>, ReportError> {
        data::csv(self)
    }

    /// Name and text of one SVG file for each plot, with a legend.
    ///
    /// # Errors
    /// [`ReportError::Plot`] if a figure has values that cannot be drawn.
    pub fn svg(&self) -> Result<Vec<(String, String)>, ReportError> {
        data::svg(self)
    }

    /// Writes `index.html`, `report.json`, and the CSV and SVG files to `folder`, which is created if it does
    /// not exist. Returns the paths of the files, with the page first. A previous report in the folder is
    /// replaced as a whole. If the disk is full, the previous report is kept.
    ///
    /// # Errors
    /// The errors of [`Report::html`], [`Report::csv`] and [`Report::svg`], before a file is written.
    /// [`ReportError::File`] if a file cannot be written, or if it exists and was not written by a report.
    pub fn write(&self, folder: &Path) -> Result<Vec<PathBuf>, ReportError> {
        let mut files =
            vec![("index.html".to_owned(), self.html()?), ("report.json".to_owned(), self.json())];
        files.extend(self.csv()?);
        files.extend(self.svg()?);
        files::write(folder, &files)
    }

    /// Checks that identifiers, which name anchors of the page and files, are unique.
    fn check_ids(&self) -> Result<(), ReportError> {
        let mut ids: Vec<&str> = self.sections.iter().flat_map(Section::ids).collect();
        ids.sort_unstable();
        match ids.windows(2).find(|pair| pair[0] == pair[1]) {
            Some(pair) => Err(ReportError::SameId(pair[0].to_owned())),
            None => Ok(()),
        }
    }
}
