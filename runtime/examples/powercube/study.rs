//! Types shared by all experiments.

use gelenk_report::{Claim, Section};

pub use crate::outcome::Outcome;

/// Extent of the computation.
pub struct Study {
    /// Whether the short form with fewer samples is computed.
    pub is_short: bool,
}

impl Study {
    /// Selects the short form if `GELENK_EXAMPLE_SHORT=1` is set.
    pub fn from_environment() -> Self {
        Self { is_short: std::env::var_os("GELENK_EXAMPLE_SHORT").is_some() }
    }

    /// Returns `full` for the full run and `short` for the short form.
    pub fn pick<T>(&self, full: T, short: T) -> T {
        if self.is_short { short } else { full }
    }
}

/// An experiment, as a title for the terminal and a function.
pub type Experiment = (&'static str, fn(&Study) -> Outcome<Part>);

/// Contribution of an experiment to the report.
pub struct Part {
    /// Figures, tables and text of the experiment.
    pub section: Section,
    /// Claims of the paper with verdicts. The claims of all parts are shown together at the top of the page.
    pub claims: Vec<Claim>,
}
