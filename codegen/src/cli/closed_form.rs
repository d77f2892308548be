//! `gelenk inspect --closed-form`.
//!
//! The computer algebra prints a banner to standard output, and a second instance of it ends its whole process. So the
//! work runs in a process of its own, whose standard output is our standard error: the banner is shown there, results
//! stay parseable, and an end without a word becomes a message. With `--output` there is nothing to keep apart.

use std::io;
use std::path::Path;
use std::process::{Command, ExitCode, Stdio};

use serde_json::json;

use super::Failure;
use super::arguments::{Format, Inspect};
use super::print;
use super::progress::Progress;
use crate::closed_form::{self, Instance, display};
use crate::diagnostic::Diagnostics;
use crate::model::{self, Loaded, Model, ReadOptions};
use crate::output;

/// Shows M, k, q and B in closed form.
pub(super) fn inspect(arguments: &Inspect, format: Format) -> Result<ExitCode, Failure> {
    let loaded = read(arguments)?;
    closed_form::check_size(&loaded.model).map_err(problem)?;
    match &arguments.output {
        Some(output) => write(&loaded, arguments, format, output),
        None => delegate(&arguments.description),
    }
}

fn read(arguments: &Inspect) -> Result<Loaded, Failure> {
    let options = ReadOptions {
        ignore_mimic: arguments.choices.ignore_mimic,
        snap_angles: arguments.choices.snap_angles,
        no_friction: arguments.choices.no_friction,
        smooth_sign: arguments.choices.smooth_sign,
    };
    model::read(&arguments.description, &options).map_err(problem)
}

fn problem(diagnostics: Diagnostics) -> Failure {
    Failure::Descriptions(vec![diagnostics])
}

/// Runs this command again with `--output` and prints what came out.
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
        // It has said why.
        Some(1) => Ok(ExitCode::from(1)),
        _ => Err(Failure::Problem(format!(
            "the computer algebra ended its process ({status})\n  \
             = help: without a key only one instance of Symbolica may run per machine; end other programs that use it"
        ))),
    }
}

fn write(
    loaded: &Loaded,
    arguments: &Inspect,
    format: Format,
    output: &Path,
) -> Result<ExitCode, Failure> {
    let mut waiting = |path: &Path| {
        print::err(&format!(
            "gelenk: waiting for another process with Symbolica, up to {} s (lock {})\n",
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
            let value = json!({
                "robot": forms.robot,
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
    output::write(output, &text)?;
    Ok(ExitCode::SUCCESS)
}

fn defaults(model: &Model) -> Vec<f64> {
    let parameters = model.parameters.iter();
    parameters.map(|parameter| parameter.default).collect()
}
