//! Prints tables and JSON to standard output, and messages to standard error.

use std::io::{self, Write};
use std::process::ExitCode;

use gelenk_identification::IdentificationError;
use serde_json::{Value, json};

use super::arguments::Format;
use super::failure::Failure;
use crate::diagnostic::{Diagnostic, Diagnostics};

/// Largest number of printed lines of findings. With messages about the steps and a table of 20 joints, the
/// whole output has 120 lines.
const ROOM: usize = 84;

/// Writes to standard output. A closed pipe (`gelenk … | head`) is not a failure.
pub(super) fn out(text: &str) -> Result<(), Failure> {
    let mut stdout = io::stdout().lock();
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Failure::Problem(format!("cannot write to standard output: {error}")))
        }
        _ => Ok(()),
    }
}

/// Writes indented JSON to standard output.
pub(super) fn json(value: &Value) -> Result<ExitCode, Failure> {
    out(&format!("{value:#}\n"))?;
    Ok(ExitCode::SUCCESS)
}

/// Writes the result of a command to standard output in the chosen format.
pub(super) fn result(
    format: Format,
    as_json: impl FnOnce() -> Value,
    as_text: impl FnOnce() -> String,
) -> Result<ExitCode, Failure> {
    match format {
        Format::Json => json(&as_json()),
        Format::Text => out(&as_text()).map(|()| ExitCode::SUCCESS),
    }
}

/// Writes to standard error. Failures are ignored.
pub(super) fn err(text: &str) {
    let _ = io::stderr().lock().write_all(text.as_bytes());
}

/// Prints the problems of descriptions: as text on standard error, as JSON on standard output.
pub(super) fn problems(all: &[Diagnostics], format: Format) {
    match format {
        Format::Text => {
            let texts: Vec<String> = all.iter().map(ToString::to_string).collect();
            err(&format!("{}\n", texts.join("\n\n")));
        }
        Format::Json => {
            let entries: Value = all.iter().flat_map(Diagnostics::entries).map(diagnostic).collect();
            // Exit code 1 follows in any case.
            let _ = out(&format!("{:#}\n", json!({ "diagnostics": entries })));
        }
    }
}

/// Diagnostics of a description as a JSON list.
pub(super) fn diagnostics(diagnostics: &Diagnostics) -> Value {
    diagnostics.entries().iter().map(diagnostic).collect()
}

/// Findings about an identification as a JSON list.
pub(super) fn findings(all: &[Diagnostic]) -> Value {
    all.iter().map(diagnostic).collect()
}

/// Findings about an identification as text, one or two lines for each. If there are more than [`ROOM`]
/// lines, only the most severe findings are included.
pub(super) fn lines(all: &[Diagnostic]) -> String {
    let texts: Vec<String> = all.iter().map(|finding| format!("{finding}\n")).collect();
    let count = |text: &String| text.lines().count();
    if texts.iter().map(count).sum::<usize>() <= ROOM {
        return texts.concat();
    }
    let mut order: Vec<usize> = (0..all.len()).collect();
    order.sort_by_key(|i| all[*i].severity);
    let mut used = 0;
    let mut shown: Vec<usize> = order
        .into_iter()
        .take_while(|i| {
            used += count(&texts[*i]);
            used < ROOM
        })
        .collect();
    shown.sort_unstable();
    let more = all.len() - shown.len();
    let shown: String = shown.into_iter().map(|i| texts[i].as_str()).collect();
    shown + left_out(more, "findings").as_str()
}

/// Returns at most [`ROOM`] lines, and the number of omitted lines.
///
/// - `kind`: plural noun for the contents of the lines
pub(super) fn few(lines: &[String], kind: &str) -> String {
    let shown = lines.len().min(ROOM);
    lines[..shown].concat() + left_out(lines.len() - shown, kind).as_str()
}

fn left_out(count: usize, kind: &str) -> String {
    match count {
        0 => String::new(),
        _ => format!("… and {count} more {kind}; --format json prints all\n"),
    }
}

/// Returns the result. If it is an error, the findings so far are printed to standard error, because they may
/// explain the error.
pub(super) fn after<T, E: Into<Failure>>(
    result: Result<T, E>,
    findings: &[Diagnostic],
) -> Result<T, Failure> {
    if result.is_err() {
        err(&lines(findings));
    }
    result.map_err(E::into)
}

/// Returns the result of an identification. If it is an error, the findings so far are printed to standard
/// error.
pub(super) fn identified<T>(result: Result<T, IdentificationError>) -> Result<T, Failure> {
    result.map_err(|error| {
        err(&lines(error.noted()));
        error.into()
    })
}

fn diagnostic(entry: &Diagnostic) -> Value {
    let values = entry
        .values
        .iter()
        .map(|value| json!({"name": value.name, "value": value.value, "unit": value.unit}));
    let mut shown = json!({
        "severity": entry.severity.as_str(),
        "code": entry.code,
        "message": entry.message,
        "file": entry.location().map(|at| &at.file),
        "line": entry.location().map(|at| at.line),
        "column": entry.location().map(|at| at.column),
        "help": entry.remedy,
        "text": entry.to_string(),
    });
    // Findings about logs have these entries instead of a file.
    if entry.location().is_none() {
        shown["log"] = json!(entry.about.log);
        shown["rows"] = json!(entry.about.rows);
        shown["part"] = json!(entry.about.subject.name());
        shown["values"] = values.collect();
    }
    shown
}

/// Text of a table with these column headings and rows.
pub(super) fn headed(head: &[&str], rows: impl Iterator<Item = Vec<String>>) -> String {
    let head = head.iter().map(|heading| (*heading).to_owned()).collect();
    table(&std::iter::once(head).chain(rows).collect::<Vec<_>>())
}

/// Text of a table whose first row is the head. Columns of numbers are right-aligned.
pub(super) fn table(rows: &[Vec<String>]) -> String {
    let column = |column: usize| rows.iter().filter_map(move |row| row.get(column));
    let width = |index: usize| column(index).map(|cell| cell.chars().count()).max().unwrap_or(0);
    let is_number = |index: usize| column(index).skip(1).all(|cell| cell.parse::<f64>().is_ok());
    let line = |row: &Vec<String>| {
        let cells = row.iter().enumerate().map(|(index, cell)| {
            let space = " ".repeat(width(index) - cell.chars().count());
            if is_number(index) { format!("{space}{cell}") } else { format!("{cell}{space}") }
        });
        format!("  {}\n", cells.collect::<Vec<_>>().join("  ").trim_end())
    };
    rows.iter().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use gelenk_findings::Severity;

    #[test]
    fn the_gravest_of_many_findings_are_shown() {
        let warning = Diagnostic::warning("late", "comes late");
        let note = Diagnostic { severity: Severity::Note, ..Diagnostic::warning("read", "was read") };
        let few = vec![note.clone(); ROOM];
        assert_eq!(lines(&few).lines().count(), ROOM);
        let many = [vec![note; 2 * ROOM], vec![warning]].concat();
        let text = lines(&many);
        assert!(text.lines().count() == ROOM && text.contains("comes late"), "{text}");
        assert!(
            text.ends_with(&format!("… and {} more findings; --format json prints all\n", ROOM + 2)),
            "{text}"
        );
    }

    #[test]
    fn numbers_stand_to_the_right() {
        let rows = [["function", "kind", "calls"], ["f", "ω", "12"], ["long_name", "b", "3"]];
        let rows: Vec<Vec<String>> = rows.iter().map(|row| row.map(str::to_owned).to_vec()).collect();
        let expected = "  function   kind  calls\n  f          ω        12\n  long_name  b         3\n";
        assert_eq!(table(&rows), expected);
    }
}
