//! Findings: messages about a description, a log or a fit, with a place and a remedy.
//!
//! Each check has a [`Rule`] and creates [`Finding`]s. The message of a finding does not name the part of
//! the robot or of the log that it is about. The field [`About`] names this part. Therefore findings can be
//! sorted, counted and removed by rule and part, and one function formats the text of all findings.

pub mod digits;

use std::fmt;

/// Severity of a finding. The most severe one is first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// The input cannot be used, or a result is rejected.
    Error,
    /// The input is used but probably has a fault.
    Warning,
    /// The input is used. A part of it was skipped or changed, or the finding is a remark.
    Note,
}

impl Severity {
    /// Returns the name of the severity: `error`, `warning` or `note`.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Error => "error",
            Self::Warning => "warning",
            Self::Note => "note",
        }
    }
}

/// Kind of a finding, with a code and a severity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rule {
    /// Name in kebab case. It does not change between versions, so scripts can use it.
    pub code: &'static str,
    /// Severity of the findings of this rule.
    pub severity: Severity,
}

impl Rule {
    /// Creates a rule whose findings reject a result.
    pub const fn error(code: &'static str) -> Self {
        Self { code, severity: Severity::Error }
    }

    /// Creates a rule whose findings question a result.
    pub const fn warning(code: &'static str) -> Self {
        Self { code, severity: Severity::Warning }
    }

    /// Creates a rule whose findings are remarks.
    pub const fn note(code: &'static str) -> Self {
        Self { code, severity: Severity::Note }
    }

    /// Creates a finding of this rule. The finding is about the whole input, until [`Finding::of`] or another
    /// method sets a part.
    ///
    /// - `message`: text without the name of the part, because [`Finding::sentence`] adds the name
    pub fn found(&self, message: impl Into<String>) -> Finding {
        Finding { severity: self.severity, ..Finding::error(self.code, message) }
    }
}

/// A place in a source file, with the source line for messages.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Location {
    /// Name of the file as the user gave it.
    pub file: String,
    /// Line of the file, counted from 1.
    pub line: usize,
    /// Column of the line in characters, counted from 1.
    pub column: usize,
    /// Number of marked characters on this line, at least 1.
    pub length: usize,
    /// Source line without control characters. If the line is very long, only a part of it.
    pub excerpt: String,
    /// Position of the mark within `excerpt`, in characters from 0.
    pub excerpt_column: usize,
}

/// The part of a robot that a finding is about.
#[derive(Debug, Clone, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Subject {
    /// The whole robot, or a whole file.
    #[default]
    Whole,
    /// The joint with this name.
    Joint(String),
    /// The shaft of a drive that moves several joints, with the name of the drive.
    Shaft(String),
    /// The input with this name.
    Input(String),
}

impl Subject {
    /// Returns the name of the part; `None` for the whole robot.
    pub fn name(&self) -> Option<&str> {
        match self {
            Self::Whole => None,
            Self::Joint(name) | Self::Shaft(name) | Self::Input(name) => Some(name),
        }
    }
}

impl fmt::Display for Subject {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Whole => Ok(()),
            Self::Joint(name) => write!(out, "joint {name}"),
            Self::Shaft(name) => write!(out, "the shaft of {name}"),
            Self::Input(name) => write!(out, "input {name}"),
        }
    }
}

/// Place and subject of a finding.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct About {
    /// Place in a description; `None` if the finding is not about a place in a description.
    pub place: Option<Location>,
    /// Name of the log; `None` for a finding that is not about a log.
    pub log: Option<String>,
    /// First and last row of the log to which the finding refers, as line numbers of the file, from 1; `None` for
    /// the whole log.
    pub rows: Option<(usize, usize)>,
    /// Column of the log; `None` if the finding is not about a column.
    pub column: Option<String>,
    /// Part of the robot that the finding is about.
    pub subject: Subject,
}

/// A number on which a finding is based.
#[derive(Debug, Clone, PartialEq)]
pub struct Value {
    /// Name of the quantity.
    pub name: &'static str,
    /// Value of the quantity.
    pub value: f64,
    /// Unit of the quantity; empty for pure numbers.
    pub unit: &'static str,
}

/// A problem or a remark, with its place, numbers and remedy.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// Severity of the finding.
    pub severity: Severity,
    /// Code of the rule of the finding.
    pub code: &'static str,
    /// Place and subject of the finding.
    pub about: About,
    /// Message with the numbers, without the subject.
    pub message: String,
    /// The numbers of the message, for programs.
    pub values: Vec<Value>,
    /// Advice for the user; `None` if there is no advice.
    pub remedy: Option<String>,
}

impl Finding {
    /// Creates a finding with the severity "error", without a place.
    ///
    /// - `code`: code of the rule in kebab case
    pub fn error(code: &'static str, message: impl Into<String>) -> Self {
        let (message, about) = (message.into(), About::default());
        Self { severity: Severity::Error, code, about, message, values: Vec::new(), remedy: None }
    }

    /// Creates a finding with the severity "warning", without a place.
    pub fn warning(code: &'static str, message: impl Into<String>) -> Self {
        Rule::warning(code).found(message)
    }

    /// Creates a finding with the severity "note", without a place.
    pub fn note(code: &'static str, message: impl Into<String>) -> Self {
        Rule::note(code).found(message)
    }

    /// Sets the place in a description.
    #[must_use]
    pub fn at(mut self, location: Location) -> Self {
        self.about.place = Some(location);
        self
    }

    /// Sets the advice for the user.
    #[must_use]
    pub fn help(mut self, remedy: impl Into<String>) -> Self {
        self.remedy = Some(remedy.into());
        self
    }

    /// Sets the part of the robot that the finding is about.
    #[must_use]
    pub fn of(mut self, subject: Subject) -> Self {
        self.about.subject = subject;
        self
    }

    /// Sets the joint that the finding is about.
    #[must_use]
    pub fn joint(self, name: impl Into<String>) -> Self {
        self.of(Subject::Joint(name.into()))
    }

    /// Sets the log that the finding is about. `rows`: first and last row, as line numbers of the file from 1; `None` for the
    /// whole log.
    #[must_use]
    pub fn log(mut self, log: impl Into<String>, rows: Option<(usize, usize)>) -> Self {
        (self.about.log, self.about.rows) = (Some(log.into()), rows);
        self
    }

    /// Sets the column of a log.
    #[must_use]
    pub fn column(mut self, column: Option<String>) -> Self {
        self.about.column = column;
        self
    }

    /// Converts an error to a warning, because the user accepts it. Warnings and notes are not changed.
    #[must_use]
    pub fn accepted(mut self) -> Self {
        self.severity = self.severity.max(Severity::Warning);
        self
    }

    /// Adds a number that programs can read with [`Self::value`].
    #[must_use]
    pub fn with(mut self, name: &'static str, value: f64, unit: &'static str) -> Self {
        self.values.push(Value { name, value, unit });
        self
    }

    /// Returns the number `name`; `None` if the finding has no number of this name.
    pub fn value(&self, name: &str) -> Option<f64> {
        self.values.iter().find(|value| value.name == name).map(|value| value.value)
    }

    /// Returns whether another finding has the same code and is about the same place, log, rows, column and part of
    /// the robot ([`About`]).
    pub fn is_like(&self, other: &Self) -> bool {
        self.code == other.code && self.about == other.about
    }

    /// Returns the place of the finding in a description; `None` if the finding has no such place.
    pub fn location(&self) -> Option<&Location> {
        self.about.place.as_ref()
    }

    /// Returns the text of the finding: log, rows, column, part of the robot, and message.
    pub fn sentence(&self) -> String {
        let rows = self.about.rows.map(|(first, last)| match last {
            last if last == first => format!("row {first}"),
            last => format!("rows {first} to {last}"),
        });
        let subject = Some(self.about.subject.to_string()).filter(|subject| !subject.is_empty());
        let places = [self.about.log.clone(), rows, self.about.column.clone(), subject];
        let places: Vec<String> = places.into_iter().flatten().collect();
        let colon = if places.is_empty() { "" } else { ": " };
        format!("{}{colon}{}", places.join(", "), self.message)
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{}[{}]: {}", self.severity.as_str(), self.code, self.sentence())?;
        if let Some(at) = self.location() {
            let number = at.line.to_string();
            let margin = " ".repeat(number.len());
            write!(out, "\n{margin}--> {}:{}:{}", at.file, at.line, at.column)?;
            write!(out, "\n{margin} |\n{number} | {}", at.excerpt)?;
            write!(out, "\n{margin} | {}{}", " ".repeat(at.excerpt_column), "^".repeat(at.length))?;
        }
        match &self.remedy {
            Some(remedy) => write!(out, "\n  = help: {remedy}"),
            None => Ok(()),
        }
    }
}

/// Returns a number with its noun or phrase: `1 row` or `3 rows`.
///
/// - `one`: text after the number 1
/// - `many`: text after any other number
pub fn counted(count: usize, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}

/// Removes duplicates. If several findings about a part of the robot have the same rule and place, only the
/// last one is kept.
pub fn distinct(findings: impl IntoIterator<Item = Finding>) -> Vec<Finding> {
    let mut kept: Vec<Finding> = Vec::new();
    for finding in findings {
        let is_part = finding.about.subject != Subject::Whole;
        match kept.iter_mut().find(|known| **known == finding || (is_part && known.is_like(&finding))) {
            Some(known) => *known = finding,
            None => kept.push(finding),
        }
    }
    kept
}

/// Returns the texts of the findings with this severity.
pub fn texts(findings: &[Finding], severity: Severity) -> Vec<String> {
    findings.iter().filter(|finding| finding.severity == severity).map(ToString::to_string).collect()
}

#[cfg(test)]
mod tests {
    use super::counted;

    #[test]
    fn only_one_is_singular() {
        let rows = [0, 1, 2].map(|count| counted(count, "row is left out", "rows are left out"));
        assert_eq!(rows, ["0 rows are left out", "1 row is left out", "2 rows are left out"]);
    }
}
