//! What a log calls its columns.

use super::families::Targets;
use super::finder::Finder;
use super::search::Found;

/// What a log calls the columns of a quantity, for messages and for `--columns`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ColumnLabels {
    /// Header of the column of each joint or input, or its number.
    pub columns: Vec<String>,
    /// All of them as `--columns` takes them, as `q{}`.
    pub pattern: String,
}

/// What a log calls its columns.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Labels {
    /// The column of times; `row` where rows are counted.
    pub time: String,
    /// Positions of the joints.
    pub positions: ColumnLabels,
    /// Efforts of the joints or inputs.
    pub efforts: ColumnLabels,
}

impl Labels {
    /// - `position`, `effort`: the columns with whom they belong to
    pub(super) fn new(
        finder: &Finder,
        time: Option<usize>,
        position: (&Found, &Targets),
        effort: (&Found, &Targets),
    ) -> Self {
        let of = |(found, targets): (&Found, &Targets)| ColumnLabels {
            columns: found.columns.iter().map(|column| finder.label(*column)).collect(),
            pattern: finder.pattern_of(&found.columns, targets),
        };
        let label = |time: usize| {
            let header = finder.headers.get(time);
            header.map_or_else(|| (time + 1).to_string(), |header| finder.unique(header))
        };
        let time = time.map_or_else(|| "row".to_owned(), label);
        Self { time, positions: of(position), efforts: of(effort) }
    }
}
