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
    /// - [`ReportError::Equation`] if an equation cannot be typeset.
    /// - [`ReportError::Plot`] if a figure has values that cannot be drawn.
    /// - [`ReportError::SameId`] if two parts have the same identifier.
    pub fn html(&self) -> Result<String, ReportError> {
        self.check_ids()?;
        page::html(self)
    }

    /// All numbers as JSON without rounding. NaN and infinities are strings.
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

    /// Writes `index.html`, `report.json`, and the CSV and SVG files to `folder`. If the folder does not exist, it is created.
    /// Returns the paths of the files; the first path is that of the page. A previous report in the folder is replaced as a
    /// whole. If the disk is full, the previous report is kept.
    ///
    /// # Errors
    /// - The errors of [`Report::html`], [`Report::csv`] and [`Report::svg`]. In this case no file is written.
    /// - [`ReportError::File`] if a file cannot be written, or if the file exists and was not written by a report.
    pub fn write(&self, folder: &Path) -> Result<Vec<PathBuf>, ReportError> {
        let mut files =
            vec![("index.html".to_owned(), self.html()?), ("report.json".to_owned(), self.json())];
        files.extend(self.csv()?);
        files.extend(self.svg()?);
        files::write(folder, &files)
    }

    /// Checks that identifiers are unique, because they are names of anchors and files.
    fn check_ids(&self) -> Result<(), ReportError> {
        let mut ids: Vec<&str> = self.sections.iter().flat_map(Section::ids).collect();
        ids.sort_unstable();
        match ids.windows(2).find(|pair| pair[0] == pair[1]) {
            Some(pair) => Err(ReportError::SameId(pair[0].to_owned())),
            None => Ok(()),
        }
    }
}
