//! Columns of one quantity, and their text in messages.

use super::super::units::Unit;
use super::table::Kind;
use gelenk_findings::{Finding, Rule};

/// Sees: columns with names of commanded values if there are no measured values, or times in an unknown unit.
/// Matters: commanded values differ from measured ones by the control error.
/// Example: `q_d1` without a `q1`.
/// Fixture: `what_is_commanded_is_doubted_where_nothing_is_measured` in `log/tests/printed.rs`.
pub(super) const COLUMN_DOUBTFUL: Rule = Rule::warning("column-doubtful");

/// A column with its unit.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::log) struct Column {
    pub index: usize,
    /// Name of the column in messages.
    pub label: String,
    /// Name of the column for `--columns`: its header or its number.
    pub written: String,
    pub unit: Unit,
    /// Unit of the column in words, for messages.
    pub unit_words: String,
    /// Whether the unit comes from the user or from the quantity, not from the header.
    pub is_stated: bool,
}

/// The columns of one quantity.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::log) struct Found {
    pub kind: Kind,
    pub columns: Vec<Column>,
    /// Names of the joints or inputs.
    pub names: Vec<String>,
    /// Indices of the joints or inputs in the description.
    pub places: Vec<usize>,
    /// Columns in the form of `--columns`, for example `q{}`.
    pub pattern: String,
    /// Whether only commanded columns were found and the user did not name them.
    pub is_commanded: bool,
}

/// Names of the columns of a quantity in a log, for messages and for `--columns`.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct ColumnLabels {
    /// Name of the column of each joint or input in messages; `none` if the log does not have this column.
    pub(crate) columns: Vec<String>,
    /// Name of the column of each joint or input for `--columns`; `None` if the log does not have this column.
    pub(crate) written: Vec<Option<String>>,
    /// All columns in the form of `--columns`, for example `q{}`.
    pub(crate) pattern: String,
}

/// Names of the columns of a log.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Labels {
    /// Column of times; `row` if the times are counted rows.
    pub(crate) time: String,
    /// Columns of the joints' positions.
    pub(crate) positions: ColumnLabels,
    /// Columns of the efforts of joints or inputs.
    pub(crate) efforts: ColumnLabels,
}

impl Found {
    pub(super) fn indices(&self) -> impl Iterator<Item = usize> + '_ {
        self.columns.iter().map(|column| column.index)
    }

    /// Returns a line for messages with pattern, first and last joint, and units; `None` if there are no columns.
    pub(super) fn line(&self, what: &str) -> Option<String> {
        let mut units: Vec<&str> = Vec::new();
        for Column { unit_words: unit, .. } in &self.columns {
            units.extend((!units.contains(&unit.as_str())).then_some(unit.as_str()));
        }
        let (first, last) = (self.columns.first()?, self.columns.last()?);
        let name = |i: usize| self.names.get(i).map_or("", String::as_str);
        let whose = match self.columns.len() {
            1 => format!(" of {}", name(0)),
            _ if self.pattern.contains("{name}") => String::new(),
            n => format!(" from {} of {} to {} of {}", first.label, name(0), last.label, name(n - 1)),
        };
        Some(format!("{what}: `{}`{whose}, {}", self.pattern, units.join(" or ")))
    }

    /// Returns the columns of all joints or inputs, by their indices.
    ///
    /// - `count`: number of all joints or inputs
    pub(super) fn labels(&self, count: usize) -> ColumnLabels {
        let (mut columns, mut written) = (vec!["none".to_owned(); count], vec![None; count]);
        for (place, column) in self.places.iter().zip(&self.columns) {
            columns[*place].clone_from(&column.label);
            written[*place] = Some(column.written.clone());
        }
        ColumnLabels { columns, written, pattern: self.pattern.clone() }
    }

    /// Returns a warning if the columns are commanded.
    pub(super) fn if_commanded(&self) -> Option<Finding> {
        let why = match self.kind {
            Kind::Position => "The real positions differ from them by the control error",
            _ => "The real efforts differ if a drive has a delay or a limit",
        };
        self.is_commanded.then(|| {
            let message = format!(
                "the columns of the {} (`{}`) have names of commanded values, and the log has no measured ones. {why}",
                self.kind.plural(),
                self.pattern
            );
            let key = self.kind.key();
            let remedy = format!("log measured values, or name their columns with --columns '{key}=…'");
            COLUMN_DOUBTFUL.found(message).help(remedy)
        })
    }
}
