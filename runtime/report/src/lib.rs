//! Reports: values in, page out.
//!
//! A [`Report`] is data: sections of paragraphs, equations, tables, claims, figures and one view of a robot.
//! From it come an HTML page that needs no network and no other file, and the same numbers as JSON and CSV.
//! The page is for screens light and dark, narrow and wide, and for paper; what it shows rounded stands in
//! the data in full.
//!
//! ```
//! use gelenk_report::{Block, Claim, Criterion, Report, Section, text};
//!
//! let error = 0.004; // rad, measured
//! let tracks = Claim::new("tracking", "The feed-forward follows the trajectory.")
//!     .criterion(Criterion::at_most("largest error", error, 0.01, "rad"))
//!     .flipped_by("a friction model with the wrong sign");
//! let report = Report::new("Feed-forward on a simulated arm").section(
//!     Section::new("claims", "Claims")
//!         .block(text("The torque is $u = B^{-1}(M \\ddot y + k - q)$."))
//!         .block(Block::Claims(vec![tracks])),
//! );
//! let page = report.html()?;
//! assert!(page.contains("<math") && page.contains("holds"));
//! # Ok::<(), gelenk_report::ReportError>(())
//! ```

mod block;
mod claim;
mod data;
mod diagram;
mod equation;
mod files;
mod inline;
mod number;
mod page;
mod pattern;
mod plot;
mod scene;
mod table;

pub use block::{Block, Section, plain, text};
pub use claim::{Bound, Claim, Criterion, Verdict};
pub use equation::Equation;
pub use inline::{Inline, code};
pub use pattern::Pattern;
pub use plot::{Axis, Figure, Marks, Plot, Series};
pub use scene::{Scene, SceneBody, SceneFrame, SceneJoint, SceneKind, SceneMotion, SceneRod};
pub use table::{Cell, Column, Table};

use std::io;
use std::path::{Path, PathBuf};

/// A report: what its page, its JSON and its CSV are made of.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Report {
    /// Title of the page.
    pub title: String,
    /// A sentence or two below the title.
    pub lead: Vec<Inline>,
    /// Small facts beside the title: name and value.
    pub facts: Vec<(String, String)>,
    /// The body.
    pub sections: Vec<Section>,
    /// The command that made the report, shown at the foot.
    pub made_by: String,
}

impl Report {
    /// An empty report.
    #[must_use]
    pub fn new(title: impl Into<String>) -> Self {
        Self { title: title.into(), ..Self::default() }
    }

    /// Sets the sentence below the title; `$…$` is an equation in LaTeX.
    #[must_use]
    pub fn lead(mut self, lead: &str) -> Self {
        self.lead = inline::inlines(lead);
        self
    }

    /// Adds a fact beside the title.
    #[must_use]
    pub fn fact(mut self, name: impl Into<String>, value: impl Into<String>) -> Self {
        self.facts.push((name.into(), value.into()));
        self
    }

    /// Adds a section.
    #[must_use]
    pub fn section(mut self, section: Section) -> Self {
        self.sections.push(section);
        self
    }

    /// All claims, in order.
    pub fn claims(&self) -> impl Iterator<Item = &Claim> {
        let blocks = self.sections.iter().flat_map(Section::all_blocks);
        blocks
            .filter_map(|block| match block {
                Block::Claims(claims) => Some(claims),
                _ => None,
            })
            .flatten()
    }

    /// The page: one self-contained HTML file.
    ///
    /// # Errors
    /// [`ReportError::Equation`] where an equation is no LaTeX that can be set, [`ReportError::Plot`] where a
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

/// Why a report could not be made.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// An equation that is no LaTeX, or uses what cannot be set.
    #[error("the equation `{latex}` cannot be set: {message}")]
    Equation {
        /// The equation.
        latex: String,
        /// The fault.
        message: String,
    },
    /// A figure that cannot be drawn.
    #[error("the figure `{id}` cannot be drawn: {message}")]
    Plot {
        /// The figure.
        id: String,
        /// The fault.
        message: String,
    },
    /// Two parts with one identifier.
    #[error("two parts of the report have the identifier `{0}`: rename one")]
    SameId(String),
    /// A table that cannot be written.
    #[error("the table `{id}` cannot be written as CSV: {message}")]
    Data {
        /// The table.
        id: String,
        /// The fault.
        message: String,
    },
    /// A file that cannot be written.
    #[error("cannot write {}: {source}", path.display())]
    File {
        /// The file or folder.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
}
