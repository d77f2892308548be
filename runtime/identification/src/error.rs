//! Errors of data and settings, each with the numbers that show it.

use gelenk_findings::digits::plain;
use gelenk_findings::{Finding, Subject};
use thiserror::Error;

/// Error of an identification step. Every message names the quantity, its value and a remedy.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum IdentificationError {
    /// No samples at all.
    #[error("{what} is empty: there is nothing to identify from")]
    Empty {
        /// The quantity.
        what: String,
    },
    /// NaN or an infinity if a number is needed.
    #[error(
        "{what} is not finite ({value}) at row {row} (counted from 0), {count} such values of {samples}: deselect these rows or repair the log"
    )]
    NotFinite {
        /// Column or channel.
        what: String,
        /// First row with such a value, from 0.
        row: usize,
        /// The value there.
        value: f64,
        /// How many rows hold such a value.
        count: usize,
        /// Number of rows looked at.
        samples: usize,
    },
    /// Finite samples whose squares overflow.
    #[error("{what} has values up to {}, whose squares overflow: scale it to sensible units", plain(*.largest, 3))]
    Overflow {
        /// Column or channel.
        what: String,
        /// Largest magnitude.
        largest: f64,
    },
    /// Equations of sensible size that are singular.
    #[error("the fit has no solution: {reason}")]
    NoSolution {
        /// Known details of the cause.
        reason: String,
    },
    /// Fewer samples than the method needs.
    #[error("{what} needs at least {needed} samples, there are {got}")]
    TooFewSamples {
        /// The method.
        what: String,
        /// Smallest number that works.
        needed: usize,
        /// Number at hand.
        got: usize,
    },
    /// Lengths that should agree do not.
    #[error("{what}: {expected} expected, {got} given")]
    Shape {
        /// The things that are compared.
        what: String,
        /// Expected size.
        expected: usize,
        /// Given size.
        got: usize,
    },
    /// A setting outside its range.
    #[error("{name} = {value} is not possible: {requirement}")]
    Setting {
        /// Name of the setting.
        name: String,
        /// Its value.
        value: f64,
        /// The condition that it has to meet.
        requirement: String,
    },
    /// Library columns that are (nearly) linearly dependent.
    #[error(
        "the terms {} are collinear on these data: condition number {} of the scaled library exceeds {limit:e}; remove one of them or excite the joint more", .terms.join(", "), plain(*.condition, 3)
    )]
    Collinear {
        /// Terms that take part in the dependency.
        terms: Vec<String>,
        /// Condition number of the library with columns scaled to unit length.
        condition: f64,
        /// The accepted limit.
        limit: f64,
    },
    /// A quantity that never changes if its change is needed.
    #[error("{what} is constant ({value}) in all {samples} samples: nothing can be identified from it")]
    Constant {
        /// The quantity.
        what: String,
        /// Its value.
        value: f64,
        /// Number of samples.
        samples: usize,
    },
    /// A library column that is zero everywhere.
    #[error("the term {term} is zero in all {samples} samples: no coefficient can be found for it")]
    ZeroColumn {
        /// The term.
        term: String,
        /// Number of samples.
        samples: usize,
    },
    /// A threshold or λ that leaves no term.
    #[error("{what} = {} removes every term: the largest value that keeps one is {}", plain(*.value, 6), plain(*.largest, 6))]
    EverythingRemoved {
        /// "threshold" or "lambda".
        what: String,
        /// Its value.
        value: f64,
        /// Bound below which at least one term stays.
        largest: f64,
    },
    /// Text that is not a valid expression.
    #[error("expression `{text}`: {message}")]
    Expression {
        /// The text.
        text: String,
        /// The fault, and the possible texts.
        message: String,
    },
    /// A channel that the log does not have.
    #[error("there is no channel `{name}`; known are {}", .known.join(", "))]
    UnknownChannel {
        /// The name asked for.
        name: String,
        /// Names of the channels.
        known: Vec<String>,
    },
    /// A file that cannot be read, understood or written.
    #[error("{place}: {message}")]
    File {
        /// Path and position.
        place: String,
        /// The fault.
        message: String,
    },
    /// An iteration that did not reach its tolerance.
    #[error("{what} did not converge in {iterations} iterations: {detail}")]
    NotConverged {
        /// The method.
        what: String,
        /// Iterations done.
        iterations: usize,
        /// The numbers at the end.
        detail: String,
    },
    /// A fit that explains too little of a joint's force on data that it has not seen.
    #[error("{}", unexplained(subject, [*r_squared, *least], reasons))]
    Unexplained {
        /// The joint, or the shaft that takes its row.
        subject: Subject,
        /// Centred R² on held-out data.
        r_squared: f64,
        /// The level that was asked for.
        least: f64,
        /// Likely reasons.
        reasons: Vec<Finding>,
    },
    /// Findings that refuse a result.
    #[error("{}", findings.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))]
    Found {
        /// At least one.
        findings: Vec<Finding>,
    },
    /// An error after some findings, which may have its reason.
    #[error("{error}")]
    After {
        /// In the order in which they were found.
        noted: Vec<Finding>,
        /// The error.
        error: Box<Self>,
    },
}

fn unexplained(subject: &Subject, [r_squared, least]: [f64; 2], reasons: &[Finding]) -> String {
    let reasons: String = reasons.iter().map(|reason| format!("\n{reason}")).collect();
    if r_squared >= least {
        return format!(
            "the fit of {subject} is doubted, though R² is {r_squared:.3} on held-out data{reasons}"
        );
    }
    format!(
        "the fit does not explain {subject}: R² {r_squared:.3} on held-out data, at least {least} is asked for{reasons}"
    )
}

impl IdentificationError {
    /// The error with the earlier findings.
    pub(crate) fn after(self, noted: Vec<Finding>) -> Self {
        if noted.is_empty() { self } else { Self::After { noted, error: Box::new(self) } }
    }

    /// The findings that refuse a result, if findings do.
    pub fn refusals(&self) -> &[Finding] {
        match self {
            Self::Found { findings } => findings,
            Self::After { error, .. } => error.refusals(),
            _ => &[],
        }
    }

    /// Findings collected before the error.
    pub fn noted(&self) -> &[Finding] {
        match self {
            Self::After { noted, .. } => noted,
            _ => &[],
        }
    }
}

/// Result of an identification step.
pub type Result<T> = std::result::Result<T, IdentificationError>;

/// Fails with row and count if a value of `values` is NaN or infinite.
///
/// # Errors
/// [`IdentificationError::NotFinite`]
pub(crate) fn require_finite(what: &str, values: &[f64]) -> Result<()> {
    let Some(row) = values.iter().position(|x| !x.is_finite()) else {
        return Ok(());
    };
    Err(IdentificationError::NotFinite {
        what: what.into(),
        row,
        value: values[row],
        count: values.iter().filter(|x| !x.is_finite()).count(),
        samples: values.len(),
    })
}

/// Fails unless `value` is finite and satisfies `holds`; `requirement` says so in words.
///
/// # Errors
/// [`IdentificationError::Setting`]
pub(crate) fn require_setting(name: &str, value: f64, holds: bool, requirement: &str) -> Result<()> {
    if value.is_finite() && holds {
        return Ok(());
    }
    Err(IdentificationError::Setting { name: name.into(), value, requirement: requirement.into() })
}

/// Fails unless `got == expected`.
///
/// # Errors
/// [`IdentificationError::Shape`]
pub(crate) fn require_length(what: &str, expected: usize, got: usize) -> Result<()> {
    if expected == got {
        return Ok(());
    }
    Err(IdentificationError::Shape { what: what.into(), expected, got })
}

/// Fails if there are fewer than `needed` samples.
///
/// # Errors
/// [`IdentificationError::Empty`] and [`IdentificationError::TooFewSamples`]
pub(crate) fn require_samples(what: &str, needed: usize, got: usize) -> Result<()> {
    if got == 0 {
        return Err(IdentificationError::Empty { what: what.into() });
    }
    if got < needed {
        return Err(IdentificationError::TooFewSamples { what: what.into(), needed, got });
    }
    Ok(())
}
