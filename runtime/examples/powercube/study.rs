//! Types shared by all experiments.

use gelenk_report::{Claim, Section};

pub use crate::outcome::Outcome;

/// How much is computed.
pub struct Study {
    /// Fewer samples through the same code.
    pub is_short: bool,
}

impl Study {
    /// `GELENK_EXAMPLE_SHORT=1` asks for the short form.
    pub fn from_environment() -> Self {
        Self { is_short: std::env::var_os("GELENK_EXAMPLE_SHORT").is_some() }
    }

    /// One number for the full run, another for the short one.
    pub fn pick<T>(&self, full: T, short: T) -> T {
        if self.is_short { short } else { full }
    }
}

/// An experiment: a title for the terminal, and its function.
pub type Experiment = (&'static str, fn(&Study) -> Outcome<Part>);

/// Contribution of an experiment to the report.
pub struct Part {
    /// Its figures, tables and words.
    pub section: Section,
    /// Verdicts on the paper's claims; shown together at the top.
    pub claims: Vec<Claim>,
}
