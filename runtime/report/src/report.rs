//! Type for a report as data.

use super::block::{Block, Section};
use super::claim::Claim;
use super::inline::{Inline, inlines};

/// Content of a report, which can be written as HTML page, JSON and CSV.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Report {
    /// Title of the page.
    pub title: String,
    /// One or two sentences below the title; may be empty.
    pub lead: Vec<Inline>,
    /// Facts next to the title, as pairs of name and value.
    pub facts: Vec<(String, String)>,
    /// Sections of the page.
    pub sections: Vec<Section>,
    /// Command that generated the report. It is shown at the foot of the page, and may be empty.
    pub made_by: String,
}

impl Report {
    /// An empty report.
    #[must_use]
    pub fn new(title: impl Into<String>) -> Self {
        Self { title: title.into(), ..Self::default() }
    }

    /// Sets the text below the title; `$…$` is an equation in LaTeX.
    #[must_use]
    pub fn lead(mut self, lead: &str) -> Self {
        self.lead = inlines(lead);
        self
    }

    /// Adds a fact next to the title.
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

    /// All claims of the report in order.
    pub fn claims(&self) -> impl Iterator<Item = &Claim> {
        let blocks = self.sections.iter().flat_map(Section::all_blocks);
        blocks
            .filter_map(|block| match block {
                Block::Claims(claims) => Some(claims),
                _ => None,
            })
            .flatten()
    }
}
