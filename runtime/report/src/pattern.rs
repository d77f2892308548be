//! Sparsity patterns of matrices.

use maud::{Markup, html};

use super::inline::{Inline, inlines};

/// Sparsity pattern of a matrix.
#[derive(Debug, Clone, PartialEq)]
pub struct Pattern {
    /// Anchor on the page and name of the CSV file: letters, digits, hyphens and underscores.
    pub id: String,
    /// Title, usually the name of the matrix.
    pub title: Vec<Inline>,
    /// Names of the rows.
    pub rows: Vec<String>,
    /// Names of the columns.
    pub columns: Vec<String>,
    /// Whether each entry is non-zero, row by row.
    pub entries: Vec<Vec<bool>>,
}

impl Pattern {
    /// A pattern; `$…$` in the title is an equation in LaTeX.
    #[must_use]
    pub fn new(
        id: impl Into<String>,
        title: &str,
        rows: Vec<String>,
        columns: Vec<String>,
        entries: Vec<Vec<bool>>,
    ) -> Self {
        Self { id: id.into(), title: inlines(title), rows, columns, entries }
    }

    /// Number of non-zero entries.
    pub(super) fn count(&self) -> usize {
        self.entries.iter().flatten().filter(|entry| **entry).count()
    }

    /// Number of all entries.
    pub(super) fn size(&self) -> usize {
        self.entries.iter().map(Vec::len).sum()
    }
}

const CELL: usize = 16;

pub(super) fn svg(pattern: &Pattern) -> Markup {
    let rows = pattern.entries.len();
    let columns = pattern.entries.iter().map(Vec::len).max().unwrap_or(0);
    let (width, height) = (columns * CELL + 2, rows * CELL + 2);
    let label = format!(
        "{} rows, {} columns, {} of {} entries are non-zero",
        rows,
        columns,
        pattern.count(),
        pattern.size()
    );
    let name = |names: &[String], index: usize| {
        names.get(index).map_or_else(|| (index + 1).to_string(), Clone::clone)
    };
    html! {
        svg.spy viewBox=(format!("0 0 {width} {height}")) style=(format!("width: {width}px")) role="img" aria-label=(label) {
            rect.frame x="0.5" y="0.5" width=(width - 1) height=(height - 1) {}
            @for (i, row) in pattern.entries.iter().enumerate() {
                @for (j, entry) in row.iter().enumerate() {
                    @if *entry {
                        rect.entry x=(j * CELL + 3) y=(i * CELL + 3) width=(CELL - 4) height=(CELL - 4) {
                            title { (name(&pattern.rows, i)) ", " (name(&pattern.columns, j)) }
                        }
                    }
                }
            }
        }
    }
}
