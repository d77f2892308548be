//! The command `gelenk report`, which writes a page about a robot.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use gelenk_report::{Report, Verdict};
use serde_json::{Value, json};

use super::arguments::{self, Format};
use super::failure::{FAULT, Failure};
use super::place::{Workspace, shown};
use super::print;
use super::progress::Progress;
use crate::diagnostic::Diagnostics;
use crate::functions::form::Form;
use crate::functions::selection::{self, Request};
use crate::functions::size::MOST_OPERATIONS;
use crate::read::{self, Loaded};
use crate::report::{ClosedForm, Contents, report};
use crate::wording::quoted;

/// Writes the page of a robot. The exit code is 1 if the page's self-check fails.
pub(super) fn write(arguments: &arguments::Report, format: Format) -> Result<ExitCode, Failure> {
    let progress = Progress::start(arguments.description.display().to_string());
    let loaded = read(arguments)?;
    let page = page(arguments, &loaded)?;
    let folder = match &arguments.output {
        Some(folder) => folder.clone(),
        None => Path::new("report").join(&loaded.model.name),
    };
    let files = written(&page, &folder, "--output")?;
    drop(progress);
    match format {
        Format::Json => {
            print::json(&result(&loaded, &page, &files))?;
        }
        Format::Text => say(&loaded, &page, &files)?,
    }
    let failed = page.claims().any(|claim| claim.verdict() == Verdict::DoesNotHold);
    Ok(if failed { ExitCode::from(FAULT) } else { ExitCode::SUCCESS })
}

/// Writes a page to a folder and returns the paths of its files. `option` names the folder's option in the
/// message of an error.
pub(super) fn written(page: &Report, folder: &Path, option: &str) -> Result<Vec<PathBuf>, Failure> {
    page.write(folder).map_err(|error| {
        Failure::Problem(format!(
            "{error}\n  = help: name a new folder, or a folder with write permission, with {option} FOLDER"
        ))
    })
}

fn read(arguments: &arguments::Report) -> Result<Loaded, Failure> {
    read::read(&arguments.description, &arguments.reading.options()).map_err(problem)
}

fn problem(diagnostics: Diagnostics) -> Failure {
    Failure::Descriptions(vec![diagnostics])
}

fn page(arguments: &arguments::Report, loaded: &Loaded) -> Result<Report, Failure> {
    let most = arguments.max_operations.unwrap_or(MOST_OPERATIONS);
    // All functions, whatever the description asks to generate.
    let request = Request { names: &[], most, form: Form::Cheapest, straight: &[] };
    let selected = selection::derive(&loaded.model, &request).map_err(problem)?;
    let notes = [loaded.notes.entries(), &selected.notes].concat();
    let closed_form = closed_form(arguments, loaded)?;
    let contents = Contents {
        model: &loaded.model,
        functions: &selected.functions,
        notes: &Diagnostics::new(notes),
        closed_form: closed_form.as_ref().map_err(String::as_str),
        command: &command(arguments),
    };
    report(&contents).map_err(|error| Failure::Problem(error.to_string()))
}

/// Closed forms, or the text for the page if there are none.
#[cfg(feature = "symbolica")]
fn closed_form(
    arguments: &arguments::Report,
    loaded: &Loaded,
) -> Result<Result<ClosedForm, String>, Failure> {
    super::closed_form::for_page(arguments, loaded)
}

/// Returns the text for the page, because this build lacks the feature `symbolica`.
#[cfg(not(feature = "symbolica"))]
#[expect(clippy::unnecessary_wraps, reason = "as with the feature")]
fn closed_form(_: &arguments::Report, _: &Loaded) -> Result<Result<ClosedForm, String>, Failure> {
    Ok(Err(
        "Closed forms exist for robots with up to three coordinates. Closed forms with symbols need a build of `gelenk` with the \
         feature `symbolica`. This page was made without it."
            .to_owned(),
    ))
}

/// The command for the foot of the page. It does not depend on the machine on which the page is made.
fn command(arguments: &arguments::Report) -> String {
    let description = shown(&arguments.description, Workspace::find().as_ref());
    let mut words = vec!["gelenk report".to_owned(), quoted(&description)];
    words.extend(arguments.reading.words().iter().map(|word| quoted(word)));
    if let Some(most) = arguments.max_operations {
        words.push(format!("--max-operations {most}"));
    }
    words.join(" ")
}

fn say(loaded: &Loaded, page: &Report, files: &[PathBuf]) -> Result<(), Failure> {
    if !loaded.notes.is_empty() {
        print::err(&format!("{}\n\n", loaded.notes));
    }
    let page_file = files.first().map(|file| file.display().to_string());
    let mut text =
        format!("wrote {} and {} data files\n", page_file.unwrap_or_default(), files.len().saturating_sub(1));
    let all = page.claims().count();
    let held = page.claims().filter(|claim| claim.verdict() == Verdict::Holds);
    text.push_str(&format!("self-check: {} of {all} checks hold\n", held.count()));
    for claim in page.claims().filter(|claim| claim.verdict() != Verdict::Holds) {
        text.push_str(&format!("  {}: {}\n", claim.id, claim.verdict()));
    }
    print::out(&text)
}

fn result(loaded: &Loaded, page: &Report, files: &[PathBuf]) -> Value {
    let files = files.iter().map(|file| file.display().to_string());
    let checks = page.claims().map(|claim| json!({ "id": claim.id, "verdict": claim.verdict().to_string() }));
    json!({
        "robot": loaded.model.name,
        "files": files.collect::<Value>(),
        "self_check": checks.collect::<Value>(),
        "notes": print::diagnostics(&loaded.notes),
    })
}
