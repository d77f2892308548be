//! The command `gelenk inspect --closed-form`, which prints the equations of motion as formulas with symbols.
//!
//! Symbolica prints a banner to standard output, and ends a process that starts a second instance. Therefore
//! the work runs in a separate process, whose standard output is redirected to standard error, so the printed
//! results can be parsed. If the process ends without a result, a message is printed. The option `--output` needs no
//! separate process.

use std::io;
use std::path::Path;
use std::process::{Command, ExitCode, Stdio};

use serde_json::{Value, json};

use super::arguments::{self, Format, Inspect};
use super::failure::Failure;
use super::print;
use super::progress::Progress;
use crate::closed_form::{self, Instance, display};
use crate::diagnostic::Diagnostics;
use crate::model::Model;
use crate::output::{Planned, Replaces};
use crate::read::{self, Loaded};
use crate::report::{ClosedForm, Symbol};

/// Prints M, k, q and B of the equations of motion in closed form, or writes them to a file.
pub(super) fn inspect(arguments: &Inspect, format: Format) -> Result<ExitCode, Failure> {
    let loaded = read(arguments)?;
    closed_form::check_size(&loaded.model).map_err(problem)?;
    match &arguments.output {
        Some(output) => write(&loaded, arguments, format, output),
        None => delegate(&arguments.description),
    }
}

fn read(arguments: &Inspect) -> Result<Loaded, Failure> {
    let options = arguments.choices.reading.options();
    read::read(&arguments.description, &options).map_err(problem)
}

fn problem(diagnostics: Diagnostics) -> Failure {
    Failure::Descriptions(vec![diagnostics])
}

/// Computes the closed forms for the page of a robot in a separate process. The inner error is the text for
/// the page if there are no closed forms. This happens if the robot has too many joints or the computer
/// algebra failed. A failure of the computer algebra is also printed.
pub(super) fn for_page(
    arguments: &arguments::Report,
    loaded: &Loaded,
) -> Result<Result<ClosedForm, String>, Failure> {
    if let Err(problems) = closed_form::check_size(&loaded.model) {
        let words = problems.entries().iter().map(|problem| &problem.message);
        let words: Vec<&str> = words.map(String::as_str).collect();
        return Ok(Err(format!(
            "This page has no closed forms: {}. The intermediate values above are the equations.",
            words.join("; ")
        )));
    }
    let folder = tempfile::tempdir()?;
    let output = folder.path().join("closed_form");
    let status = Command::new(std::env::current_exe()?)
        .args(["inspect", "--closed-form", "--format", "json", "--output"])
        .arg(&output)
        .args(arguments.reading.words())
        .arg("--")
        .arg(&arguments.description)
        .stdin(Stdio::null())
        .stdout(io::stderr())
        .status()?;
    if !status.success() {
        print::err(&format!(
            "gelenk: the page has no closed forms, because the computer algebra ended with {status}\n"
        ));
        return Ok(Err(
            "This page has no closed forms, because the computer algebra ended without a result.".to_owned(),
        ));
    }
    let value: Value = serde_json::from_str(&std::fs::read_to_string(&output)?)?;
    Ok(Ok(from_json(&value)))
}

fn from_json(value: &Value) -> ClosedForm {
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let entries = |value: &Value| value.as_array().cloned().unwrap_or_default();
    let texts = |name: &str| entries(&value[name]).iter().map(text).collect();
    let symbol =
        |entry: &Value| Symbol { name: text(&entry[0]), value: text(&entry[1]), meaning: text(&entry[2]) };
    ClosedForm {
        equations: texts("equations"),
        constants: texts("constants"),
        symbols: entries(&value["symbols"]).iter().map(symbol).collect(),
    }
}

/// Runs this command again with `--output` in a separate process, and prints the result.
fn delegate(description: &Path) -> Result<ExitCode, Failure> {
    let folder = tempfile::tempdir()?;
    let output = folder.path().join("closed_form");
    let _progress = Progress::start(description.display().to_string());
    let status = Command::new(std::env::current_exe()?)
        .args(std::env::args_os().skip(1))
        .arg("--output")
        .arg(&output)
        .stdin(Stdio::null())
        .stdout(io::stderr())
        .status()?;
    match status.code() {
        Some(0) => print::out(&std::fs::read_to_string(&output)?).map(|()| ExitCode::SUCCESS),
        // The process has printed the reason.
        Some(code @ 1..=3) => Ok(ExitCode::from(code as u8)),
        _ => Err(Failure::Problem(format!(
            "the computer algebra stopped ({status})\n  = help: without a licence key, only one program per machine can use \
             Symbolica. End other programs that use it"
        ))),
    }
}

fn write(loaded: &Loaded, arguments: &Inspect, format: Format, output: &Path) -> Result<ExitCode, Failure> {
    let mut waiting = |path: &Path| {
        print::err(&format!(
            "gelenk: waiting up to {} s for another process that uses Symbolica (lock file {})\n",
            closed_form::lock::PATIENCE.as_secs(),
            path.display()
        ));
    };
    let instance = Instance::acquire(&mut waiting).map_err(problem)?;
    let forms = closed_form::derive(&loaded.model, &instance).map_err(problem)?;
    drop(instance);
    let defaults = defaults(&loaded.model);
    let text = match (format, arguments.latex) {
        (Format::Text, false) => display::text(&forms, &defaults),
        (Format::Text, true) => display::latex(&forms, &defaults),
        (Format::Json, _) => {
            let parts = display::latex_parts(&forms, &defaults);
            let value = json!({
                "robot": forms.robot,
                "equations": parts.equations.iter().map(|(name, value)| format!("{name} = {value}")).collect::<Vec<_>>(),
                "constants": parts.constants.iter().map(|(name, sum, value)| format!("{name} = {sum} = {value}")).collect::<Vec<_>>(),
                "symbols": parts.symbols,
                "text": display::text(&forms, &defaults),
                "latex": display::latex(&forms, &defaults),
                "notes": print::diagnostics(&loaded.notes),
            });
            format!("{value:#}\n")
        }
    };
    if format == Format::Text && !loaded.notes.is_empty() {
        print::err(&format!("{}\n\n", loaded.notes));
    }
    let read = &loaded.files;
    Planned::new(output, &text, Replaces::Nothing, read)?.write()?;
    Ok(ExitCode::SUCCESS)
}

fn defaults(model: &Model) -> Vec<f64> {
    let parameters = model.parameters.iter();
    parameters.map(|parameter| parameter.default).collect()
}
