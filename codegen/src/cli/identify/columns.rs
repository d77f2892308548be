//! The command `gelenk identify --columns '?'`, which prints the columns of a log.

use std::process::ExitCode;

use gelenk_findings::Finding;
use gelenk_identification::log::guess_columns;
use serde_json::json;

use super::super::arguments::{Format, Identify};
use super::super::failure::{FAULT, Failure};
use super::super::print;
use super::logs::settings;
use super::read::read;

/// Prints the columns of the first log as a line for `--columns`. If columns are missing, it also prints
/// all columns of the log, and the exit code is [`FAULT`].
pub(super) fn print(arguments: &Identify, format: Format) -> Result<ExitCode, Failure> {
    let (_, robot) = read(arguments)?;
    let settings = settings(arguments)?;
    let Some(log) = arguments.logs.first() else {
        return Err(Failure::Usage(
            "no log is given: name the log whose columns are to be printed".to_owned(),
        ));
    };
    let guess = guess_columns(log, &robot, &settings.columns)?;
    let code = if guess.faults.is_empty() { ExitCode::SUCCESS } else { ExitCode::from(FAULT) };
    if format == Format::Json {
        let missing: Vec<String> = guess.faults.iter().map(Finding::sentence).collect();
        print::json(&json!({ "columns": guess.line, "missing": missing, "headers": guess.columns }))?;
        return Ok(code);
    }
    print::err(&print::lines(&guess.faults));
    let mut text = format!("--columns '{}'\n", guess.line);
    if !guess.faults.is_empty() {
        let headers = guess.columns.iter().zip(1..);
        let headers: Vec<String> =
            headers.map(|(header, number)| format!("{number:5}  {header}\n")).collect();
        text.push_str(&print::few(&headers, "columns"));
    }
    print::out(&text)?;
    Ok(code)
}
