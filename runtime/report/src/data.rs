//! Conversion of the numbers of a report to JSON and CSV.

use serde_json::{Value, json};

use super::block::{Block, Section};
use super::claim::{Bound, Claim, Criterion};
use super::error::ReportError;
use super::inline::Inline;
use super::number;
use super::pattern::Pattern;
use super::plot::{self, Figure, Plot};
use super::report::Report;
use super::table::{Cell, Table};

/// The whole report as JSON.
pub(super) fn json(report: &Report) -> Value {
    let section = |section: &Section| {
        let parts: Vec<Value> = section.all_blocks().into_iter().filter_map(block).collect();
        json!({ "id": section.id, "title": section.title, "parts": parts })
    };
    json!({
        "title": report.title,
        "facts": report.facts.iter().map(|(name, value)| (name.clone(), json!(value))).collect::<serde_json::Map<_, _>>(),
        "sections": report.sections.iter().map(section).collect::<Value>(),
        "made_by": report.made_by,
    })
}

/// Whether a JSON value has the keys of the results of [`json`].
pub(super) fn is_report(value: &Value) -> bool {
    let mut expected = json(&Report::default());
    match (expected.as_object_mut(), value.as_object()) {
        (Some(expected), Some(found)) => expected.keys().eq(found.keys()),
        _ => false,
    }
}

/// Names of the CSV and SVG files of a report, for its JSON.
pub(super) fn tables(report: &Value) -> Vec<String> {
    let entries = |value: &Value, name: &str| value[name].as_array().cloned().unwrap_or_default();
    let (mut names, mut drawings) = (Vec::new(), Vec::new());
    let mut name = |id: &Value, end: &str| {
        names.extend(id.as_str().map(|id| format!("{id}{end}.csv")));
    };
    for section in entries(report, "sections") {
        for part in entries(&section, "parts") {
            name(&part["table"]["id"], "");
            name(&part["figure"]["id"], "");
            let plots = entries(&part["figure"], "plots").len();
            drawings
                .extend(part["figure"]["id"].as_str().into_iter().flat_map(|id| drawing_names(id, plots)));
            for pattern in entries(&part, "patterns") {
                name(&pattern["id"], "");
            }
            if part["claims"].is_array() {
                name(&section["id"], "-claims");
            }
        }
    }
    names.extend(drawings);
    names
}

/// Names of the SVG files of a figure.
fn drawing_names(id: &str, plots: usize) -> Vec<String> {
    match plots {
        1 => vec![format!("{id}.svg")],
        _ => (1..=plots).map(|plot| format!("{id}.{plot}.svg")).collect(),
    }
}

/// Name and text of the SVG file of each plot.
pub(super) fn svg(report: &Report) -> Result<Vec<(String, String)>, ReportError> {
    let mut files = Vec::new();
    for block in report.sections.iter().flat_map(Section::all_blocks) {
        if let Block::Figure(figure) = block {
            let names = drawing_names(&figure.id, figure.plots.len());
            for (name, plot) in names.into_iter().zip(&figure.plots) {
                files.push((name, plot::file(plot, &figure.id)?));
            }
        }
    }
    Ok(files)
}

fn block(block: &Block) -> Option<Value> {
    match block {
        Block::Table(table) => Some(json!({ "table": table_json(table) })),
        Block::Claims(claims) => Some(json!({ "claims": claims.iter().map(claim_json).collect::<Value>() })),
        Block::Figure(figure) => Some(json!({ "figure": figure_json(figure) })),
        Block::Equations(equations) | Block::Abbreviations(equations) => {
            Some(json!({ "equations": equations.iter().map(|one| one.latex()).collect::<Vec<_>>() }))
        }
        Block::Patterns(patterns) => {
            Some(json!({ "patterns": patterns.iter().map(pattern_json).collect::<Value>() }))
        }
        Block::Scene(scene) => Some(json!({ "robot": scene.json() })),
        Block::Text(_) | Block::Heading(_) | Block::Tree(_) | Block::Code(_) | Block::Details { .. } => None,
    }
}

fn table_json(table: &Table) -> Value {
    let columns = table.columns.iter();
    let columns = columns.map(|column| json!({ "name": column.name, "unit": column.unit }));
    let row = |row: &Vec<Cell>| row.iter().map(cell_json).collect::<Value>();
    json!({
        "id": table.id,
        "caption": words(&table.caption),
        "columns": columns.collect::<Value>(),
        "rows": table.rows.iter().map(row).collect::<Value>(),
    })
}

impl Table {
    /// Caption of the table as plain text, with equations in LaTeX.
    #[must_use]
    pub fn title(&self) -> String {
        words(&self.caption)
    }

    /// The table as plain text for a terminal. The first row contains the names of the columns with units. The other rows
    /// contain the cells.
    #[must_use]
    pub fn plain(&self) -> Vec<Vec<String>> {
        table_rows(self, plain)
    }

    /// The rows as JSON objects. Keys are the names of the columns. Formulas are plain text.
    #[must_use]
    pub fn records(&self) -> Value {
        let names = self.columns.iter().map(|column| column.name.replace(' ', "_"));
        let names: Vec<String> = names.collect();
        let record =
            |row: &Vec<Cell>| -> Value { names.iter().cloned().zip(row.iter().map(value)).collect() };
        self.rows.iter().map(record).collect()
    }
}

/// A cell as plain text.
fn plain(cell: &Cell) -> String {
    match cell {
        Cell::Formula { text, .. } => text.clone(),
        Cell::Rounded(value, digits) => number::plain(*value, *digits),
        Cell::Exact(value) => number::plain(*value, number::MOST_DIGITS),
        other => cell_text(other),
    }
}

/// A cell as a value of JSON, with formulas as plain text.
fn value(cell: &Cell) -> Value {
    match cell {
        Cell::Formula { text, .. } => text.clone().into(),
        other => cell_json(other),
    }
}

fn pattern_json(pattern: &Pattern) -> Value {
    json!({
        "id": pattern.id,
        "rows": pattern.rows,
        "columns": pattern.columns,
        "entries": pattern.entries,
    })
}

fn cell_json(cell: &Cell) -> Value {
    match cell {
        Cell::Empty => Value::Null,
        Cell::Text(text) | Cell::Code(text) => json!(text),
        Cell::Line(parts) => json!(words(parts)),
        Cell::Formula { latex, .. } => json!(format!("${latex}$")),
        Cell::Rounded(value, _) | Cell::Exact(value) => number_json(*value),
        Cell::Count(count) => json!(count),
    }
}

/// A number as JSON. Infinity and NaN are written as text, because JSON cannot represent them.
fn number_json(value: f64) -> Value {
    if value.is_finite() { json!(value) } else { json!(value.to_string()) }
}

fn claim_json(claim: &Claim) -> Value {
    let criterion = |criterion: &Criterion| {
        let (relation, bound) = relation(criterion);
        json!({
            "name": criterion.name,
            "value": number_json(criterion.value),
            "relation": relation,
            "bound": number_json(bound),
            "unit": criterion.unit,
            "met": criterion.is_met(),
        })
    };
    json!({
        "id": claim.id,
        "statement": claim.statement,
        "verdict": claim.verdict().to_string(),
        "condition": claim.condition,
        "criteria": claim.criteria.iter().map(criterion).collect::<Value>(),
        "flipped_by": claim.flipped_by,
        "remark": claim.remark,
    })
}

fn relation(criterion: &Criterion) -> (&'static str, f64) {
    match criterion.bound {
        Bound::AtMost(bound) => ("<=", bound),
        Bound::AtLeast(bound) => (">=", bound),
    }
}

fn figure_json(figure: &Figure) -> Value {
    let plot = |plot: &Plot| {
        let series = plot.series.iter().map(|series| {
            let point = |&[x, y]: &[f64; 2]| json!([number_json(x), number_json(y)]);
            json!({ "name": series.name, "points": series.points.iter().map(point).collect::<Value>() })
        });
        json!({
            "title": plot.title,
            "x": plot.x.title(),
            "y": plot.y.title(),
            "series": series.collect::<Value>(),
        })
    };
    json!({
        "id": figure.id,
        "caption": words(&figure.caption),
        "plots": figure.plots.iter().map(plot).collect::<Value>(),
    })
}

/// A line as text, with equations in LaTeX.
pub(super) fn words(parts: &[Inline]) -> String {
    let word = |part: &Inline| match part {
        Inline::Text(text) | Inline::Code(text) => text.clone(),
        Inline::Math(latex) => format!("${latex}$"),
    };
    parts.iter().map(word).collect()
}

/// Name and text of one CSV file for each table, list of claims, figure and pattern.
pub(super) fn csv(report: &Report) -> Result<Vec<(String, String)>, ReportError> {
    let mut files = Vec::new();
    for section in &report.sections {
        for block in section.all_blocks() {
            if let Block::Patterns(patterns) = block {
                for pattern in patterns {
                    let text = written(&pattern.id, &pattern_rows(pattern))?;
                    files.push((format!("{}.csv", pattern.id), text));
                }
            }
            let (id, rows) = match block {
                Block::Table(table) => (table.id.clone(), table_rows(table, cell_text)),
                Block::Claims(claims) => (format!("{}-claims", section.id), claim_rows(claims)),
                Block::Figure(figure) => (figure.id.clone(), figure_rows(figure)),
                _ => continue,
            };
            files.push((format!("{id}.csv"), written(&id, &rows)?));
        }
    }
    Ok(files)
}

fn written(id: &str, rows: &[Vec<String>]) -> Result<String, ReportError> {
    let fault = |message: String| ReportError::Data { id: id.to_owned(), message };
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in rows {
        writer.write_record(row).map_err(|error| fault(error.to_string()))?;
    }
    let bytes = writer.into_inner().map_err(|error| fault(error.to_string()))?;
    String::from_utf8(bytes).map_err(|error| fault(error.to_string()))
}

fn with_unit(name: &str, unit: &str) -> String {
    match unit {
        "" => name.to_owned(),
        unit => format!("{name} [{unit}]"),
    }
}

/// Rows of a table as text: a row of names with units, and the rows of cells.
fn table_rows(table: &Table, cell: impl Fn(&Cell) -> String) -> Vec<Vec<String>> {
    let columns = table.columns.iter();
    let head = columns.map(|column| with_unit(&column.name, &column.unit));
    let row = |row: &Vec<Cell>| row.iter().map(&cell).collect();
    std::iter::once(head.collect()).chain(table.rows.iter().map(row)).collect()
}

fn cell_text(cell: &Cell) -> String {
    match cell {
        Cell::Empty => String::new(),
        Cell::Text(text) | Cell::Code(text) => text.clone(),
        Cell::Line(parts) => words(parts),
        Cell::Formula { latex, .. } => format!("${latex}$"),
        Cell::Rounded(value, _) | Cell::Exact(value) => format!("{value:?}"),
        Cell::Count(count) => count.to_string(),
    }
}

fn pattern_rows(pattern: &Pattern) -> Vec<Vec<String>> {
    let head = std::iter::once(String::new()).chain(pattern.columns.iter().cloned());
    let rows = pattern.rows.iter().zip(&pattern.entries);
    let rows = rows.map(|(name, entries)| {
        let entries = entries.iter().map(|entry| u8::from(*entry).to_string());
        std::iter::once(name.clone()).chain(entries).collect()
    });
    std::iter::once(head.collect()).chain(rows).collect()
}

fn claim_rows(claims: &[Claim]) -> Vec<Vec<String>> {
    let head = ["claim", "criterion", "value", "relation", "bound", "unit", "met", "verdict"];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    for claim in claims {
        for criterion in &claim.criteria {
            let (relation, bound) = relation(criterion);
            rows.push(vec![
                claim.id.clone(),
                criterion.name.clone(),
                format!("{:?}", criterion.value),
                relation.to_owned(),
                format!("{bound:?}"),
                criterion.unit.clone(),
                criterion.is_met().to_string(),
                claim.verdict().to_string(),
            ]);
        }
    }
    rows
}

/// Rows of a figure as text, one for each point, because curves have different abscissae.
fn figure_rows(figure: &Figure) -> Vec<Vec<String>> {
    let mut rows = vec![["plot", "series", "x", "y"].map(str::to_owned).to_vec()];
    for (index, plot) in figure.plots.iter().enumerate() {
        let title = match plot.title.as_str() {
            "" => (index + 1).to_string(),
            title => title.to_owned(),
        };
        for series in &plot.series {
            rows.extend(
                series.points.iter().map(|[x, y]| {
                    vec![title.clone(), series.name.clone(), format!("{x:?}"), format!("{y:?}")]
                }),
            );
        }
    }
    rows
}
