//! Errors of data and settings. Their messages contain the values that are wrong.

use gelenk_findings::digits::plain;
use gelenk_findings::{About, Finding, Rule, Subject};
use std::slice;
use thiserror::Error;

/// Sees: a file, an option, a log or a robot that cannot be used.
/// Matters: nothing is identified.
/// Example: a log without a column of times.
/// Fixture: `what_cannot_be_read_is_explained` in `log/tests/refusals.rs`.
const UNUSABLE: Rule = Rule::error("unusable-input");

/// Error of an identification step. The message names the quantity, its value and, if known, a remedy.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum IdentificationError {
    /// A list that needs at least one entry is empty, for example the list of samples, runs or friction terms.
    #[error("{what} is empty, but it needs at least one entry")]
    Empty {
        /// Name of the empty list.
        what: String,
    },
    /// A value that must be a number is NaN or infinite.
    #[error(
        "{what} is not finite ({value}) at row {row} (counted from 0), and {count} of {samples} values are not finite. Remove \
         these rows or repair the log"
    )]
    NotFinite {
        /// Name of the column or channel.
        what: String,
        /// First row with a value that is not finite, counted from 0.
        row: usize,
        /// Value that is not finite.
        value: f64,
        /// Number of rows with a value that is not finite.
        count: usize,
        /// Number of rows that were checked.
        samples: usize,
    },
    /// Finite samples are so large that their squares overflow.
    #[error("{what} has values up to {}, whose squares overflow. Convert it to SI units", plain(*.largest, 3))]
    Overflow {
        /// Name of the column or channel.
        what: String,
        /// Largest magnitude of the samples.
        largest: f64,
    },
    /// The equations of the fit are singular and have no unique solution, although no value is too large.
    #[error("the fit has no solution: {reason}")]
    NoSolution {
        /// Cause, as far as it is known.
        reason: String,
    },
    /// There are fewer samples than the method needs.
    #[error("{what} needs at least {needed} samples, but there are {got}")]
    TooFewSamples {
        /// Name of the method.
        what: String,
        /// Smallest number of samples that the method needs.
        needed: usize,
        /// Number of samples that were given.
        got: usize,
    },
    /// Two lengths that must be equal differ.
    #[error("{what}: {expected} are expected, but {got} are given")]
    Shape {
        /// Name of the quantities whose lengths are compared.
        what: String,
        /// Length that was expected.
        expected: usize,
        /// Length that was given.
        got: usize,
    },
    /// A setting is outside its range.
    #[error("{name} = {value} is not possible: {requirement}")]
    Setting {
        /// Name of the setting.
        name: String,
        /// Value of the setting.
        value: f64,
        /// Condition that the setting has to meet.
        requirement: String,
    },
    /// Columns of the library of friction terms are linearly dependent, exactly or nearly.
    #[error(
        "the data cannot distinguish the friction terms {}. The condition number of the scaled terms is {}, above {limit:e}. \
         Remove one of these terms, or record a motion that excites the joint more", .terms.join(", "), plain(*.condition, 3)
    )]
    Collinear {
        /// Terms that are linearly dependent.
        terms: Vec<String>,
        /// Condition number of the library with columns scaled to unit length.
        condition: f64,
        /// Largest accepted condition number.
        limit: f64,
    },
    /// A quantity has the same value in all samples, although the identification needs its changes.
    #[error(
        "{what} is constant ({value}) in all {samples} samples, so nothing can be identified from it. Record data in which \
         it changes"
    )]
    Constant {
        /// Name of the constant quantity.
        what: String,
        /// Value of the constant quantity.
        value: f64,
        /// Number of samples.
        samples: usize,
    },
    /// A column of the library is zero in all samples.
    #[error(
        "the term {term} is zero in all {samples} samples, so its coefficient cannot be identified. Remove the term"
    )]
    ZeroColumn {
        /// The term whose column is zero.
        term: String,
        /// Number of samples.
        samples: usize,
    },
    /// No friction term remains, because the threshold of STLS (sequentially thresholded least squares) or
    /// the weight λ of the LASSO's penalty is too large.
    #[error("{what} = {} removes every term. The largest value that keeps a term is {}", plain(*.value, 6), plain(*.largest, 6))]
    EverythingRemoved {
        /// Name of the setting: "threshold" (of STLS) or "lambda" (weight of the LASSO's penalty).
        what: String,
        /// Value of the setting.
        value: f64,
        /// Largest value with which at least one term remains.
        largest: f64,
    },
    /// A text is not a valid expression.
    #[error("expression `{text}`: {message}")]
    Expression {
        /// The text that is not a valid expression.
        text: String,
        /// Description of the fault. It often lists the valid alternatives.
        message: String,
    },
    /// The log does not have a channel of this name.
    #[error("there is no channel `{name}`. The channels are {}", .known.join(", "))]
    UnknownChannel {
        /// Name of the missing channel.
        name: String,
        /// Names of the channels of the log.
        known: Vec<String>,
    },
    /// A file, an option or a robot cannot be used.
    #[error("{0}")]
    File(Box<Finding>),
    /// An iteration did not reach its tolerance.
    #[error("{what} did not converge in {iterations} iterations: {detail}")]
    NotConverged {
        /// Name of the method.
        what: String,
        /// Number of iterations.
        iterations: usize,
        /// Numbers at the end of the iteration, which show how far the iteration is from its tolerance.
        detail: String,
    },
    /// Findings with the severity "error" reject the result.
    #[error("{}", findings.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))]
    Found {
        /// The findings, at least one.
        findings: Vec<Finding>,
    },
    /// An error that occurred after findings had been collected. One of the findings may be the cause of the error.
    #[error("{error}")]
    After {
        /// Earlier findings, in the order in which they were collected.
        noted: Vec<Finding>,
        /// The error that occurred.
        error: Box<Self>,
    },
}

/// Place of a fault in the data: a file, a part of a file, an option, or a part of the robot. The default is the whole robot.
#[derive(Default)]
pub(crate) struct Place(About);

/// Returns the place of a log or another file with this name.
pub(crate) fn at(file: impl Into<String>) -> Place {
    Place(About { log: Some(file.into()), ..About::default() })
}

/// Returns the place of the joint with this name.
pub(crate) fn at_joint(name: impl Into<String>) -> Place {
    Place(About { subject: Subject::Joint(name.into()), ..About::default() })
}

impl Place {
    /// Adds the row of the log to the place.
    pub(crate) fn row(mut self, row: usize) -> Self {
        self.0.rows = Some((row, row));
        self
    }

    /// Adds the option that names columns of the log to the place.
    pub(crate) fn option(mut self, option: String) -> Self {
        self.0.column = Some(option);
        self
    }

    /// Returns the error with this message at this place.
    pub(crate) fn fault(self, message: impl Into<String>) -> IdentificationError {
        IdentificationError::File(Box::new(Finding { about: self.0, ..UNUSABLE.found(message) }))
    }
}

impl IdentificationError {
    /// Adds the earlier findings to the error.
    pub(crate) fn after(self, noted: Vec<Finding>) -> Self {
        if noted.is_empty() { self } else { Self::After { noted, error: Box::new(self) } }
    }

    /// Returns the findings that reject the result. The result is empty for errors of other kinds.
    pub fn refusals(&self) -> &[Finding] {
        match self {
            Self::Found { findings } => findings,
            Self::File(finding) => slice::from_ref(finding),
            Self::After { error, .. } => error.refusals(),
            _ => &[],
        }
    }

    /// Returns the findings that were collected before the error.
    pub fn noted(&self) -> &[Finding] {
        match self {
            Self::After { noted, .. } => noted,
            _ => &[],
        }
    }
}

/// Result of an identification step.
pub type Result<T> = std::result::Result<T, IdentificationError>;

/// Fails if a value of `values` is NaN or infinite.
///
/// # Errors
/// [`IdentificationError::NotFinite`] with the first row and the number of these values.
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

/// Fails if `value` is not finite or `holds` is false.
///
/// - `requirement`: condition on the setting, in words
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
/// [`IdentificationError::Empty`] if there are no samples, [`IdentificationError::TooFewSamples`] if there are too few.
pub(crate) fn require_samples(what: &str, needed: usize, got: usize) -> Result<()> {
    if got == 0 {
        return Err(IdentificationError::Empty { what: what.into() });
    }
    if got < needed {
        return Err(IdentificationError::TooFewSamples { what: what.into(), needed, got });
    }
    Ok(())
}

/// Fails if all values are equal.
///
/// # Errors
/// [`IdentificationError::Constant`]
pub(crate) fn require_changing(what: &str, values: &[f64]) -> Result<()> {
    match values.first() {
        Some(&value) if values.iter().all(|x| *x == value) => {
            Err(IdentificationError::Constant { what: what.into(), value, samples: values.len() })
        }
        _ => Ok(()),
    }
}

/// Returns the error that a threshold or the weight λ of a penalty removes every term.
pub(crate) fn everything_removed(what: &str, value: f64, largest: f64) -> IdentificationError {
    IdentificationError::EverythingRemoved { what: what.into(), value, largest }
}
