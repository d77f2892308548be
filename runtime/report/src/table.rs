//! Tables of values.

use super::inline::{Inline, inlines};
use super::number;

/// A table with named columns and rows of cells.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Table {
    /// Anchor on the page and name of the CSV file: letters, digits, hyphens and underscores.
    pub id: String,
    /// Caption above the table.
    pub caption: Vec<Inline>,
    /// Columns with heading, name and unit.
    pub columns: Vec<Column>,
    /// Rows, with one cell for each column.
    pub rows: Vec<Vec<Cell>>,
}

/// A column of a table.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Heading on the page. It can contain equations.
    pub heading: Vec<Inline>,
    /// Name of the column in JSON and CSV.
    pub name: String,
    /// Unit of the numbers; may be empty.
    pub unit: String,
}

/// A cell of a table.
#[derive(Debug, Clone, PartialEq)]
pub enum Cell {
    /// An empty cell.
    Empty,
    /// Text without markup.
    Text(String),
    /// A name from source code.
    Code(String),
    /// Text with equations and code.
    Line(Vec<Inline>),
    /// A formula. The page, JSON and CSV contain LaTeX. [`Table::plain`] and [`Table::records`] contain plain text.
    Formula {
        /// Formula in LaTeX.
        latex: String,
        /// Formula as plain text.
        text: String,
    },
    /// A measured number, and the number of significant digits to show.
    Rounded(f64, usize),
    /// A number from a description. All its digits are shown, but at most nine.
    Exact(f64),
    /// A whole number, for example a count.
    Count(usize),
}

impl Table {
    /// A table without columns and rows; `$…$` in the caption is an equation in LaTeX.
    #[must_use]
    pub fn new(id: impl Into<String>, caption: &str) -> Self {
        Self { id: id.into(), caption: inlines(caption), ..Self::default() }
    }

    /// Adds a column. `$…$` in the heading is an equation in LaTeX. `name` is used in JSON and CSV.
    #[must_use]
    pub fn column(mut self, heading: &str, name: impl Into<String>, unit: impl Into<String>) -> Self {
        self.columns.push(Column { heading: inlines(heading), name: name.into(), unit: unit.into() });
        self
    }

    /// Adds columns without units. Their headings are also their names in JSON and CSV.
    #[must_use]
    pub fn columns(self, headings: &[&str]) -> Self {
        headings.iter().fold(self, |table, heading| table.column(heading, *heading, ""))
    }

    /// Adds a row.
    #[must_use]
    pub fn row(mut self, cells: impl IntoIterator<Item = Cell>) -> Self {
        self.rows.push(cells.into_iter().collect());
        self
    }

    /// Adds several rows.
    #[must_use]
    pub fn rows(mut self, rows: impl IntoIterator<Item = Vec<Cell>>) -> Self {
        self.rows.extend(rows);
        self
    }

    /// Whether the column contains only numbers. Numeric columns are right-aligned.
    pub(super) fn is_numeric(&self, column: usize) -> bool {
        let mut cells = self.rows.iter().filter_map(|row| row.get(column));
        let is_number =
            |cell: &Cell| matches!(cell, Cell::Rounded(..) | Cell::Exact(_) | Cell::Count(_) | Cell::Empty);
        cells.all(is_number)
            && self.rows.iter().any(|row| row.get(column).is_some_and(|cell| *cell != Cell::Empty))
    }
}

impl Cell {
    /// A measured number with four significant digits.
    #[must_use]
    pub fn number(value: f64) -> Self {
        Self::Rounded(value, number::DIGITS)
    }

    /// A number from a description, or an empty cell for `None`.
    #[must_use]
    pub fn exact_or_empty(value: Option<f64>) -> Self {
        value.map_or(Self::Empty, Self::Exact)
    }

    /// Text, or an empty cell for empty text.
    #[must_use]
    pub fn text(text: impl Into<String>) -> Self {
        let text = text.into();
        if text.is_empty() { Self::Empty } else { Self::Text(text) }
    }

    /// A formula in LaTeX and as plain text.
    #[must_use]
    pub fn formula([latex, text]: [String; 2]) -> Self {
        Self::Formula { latex, text }
    }

    /// Text with markup: `$…$` is an equation in LaTeX, `` `…` `` is code.
    #[must_use]
    pub fn line(source: &str) -> Self {
        Self::Line(inlines(source))
    }
}
