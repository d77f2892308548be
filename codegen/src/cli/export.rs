//! The command `gelenk export`, which writes a robot as URDF or MJCF.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use serde_json::json;

use super::arguments::{Export, Format};
use super::failure::Failure;
use super::place::{Workspace, shown};
use super::print;
use crate::diagnostic::Diagnostics;
use crate::export::{self, Exported};
use crate::functions::catalogue::EXPORT;
use crate::output::{Outcome, Planned, Replaces};
use crate::read::{self, Loaded, ReadOptions};

/// Writes a description in another format.
pub(super) fn export(arguments: &Export, format: Format) -> Result<ExitCode, Failure> {
    let reading = arguments.reading.options();
    // Both formats have dry friction for `sign`, but nothing for `tanh`.
    let options = ReadOptions { exact_sign: reading.smooth_sign.is_none(), ..reading };
    let loaded = read::read(&arguments.description, &options);
    let Loaded { model, notes, files } = loaded.map_err(|why| Failure::Descriptions(vec![why]))?;
    EXPORT.check(&model).map_err(|why| Failure::Descriptions(vec![why]))?;
    let target = if arguments.mjcf { export::Format::Mjcf } else { export::Format::Urdf };
    let source = shown(&arguments.description, Workspace::find().as_ref());
    let Exported { text, notes: losses } = export::export(&model, target, &source);
    let notes = Diagnostics::new([notes.into_entries(), losses.into_entries()].concat());
    if format == Format::Text && !notes.is_empty() {
        print::err(&format!("{notes}\n\n"));
    }
    let default = || PathBuf::from(format!("{}.{}", model.name, target.extension()));
    let path = arguments.output.clone().unwrap_or_else(default);
    if path == Path::new("-") {
        return print::out(&text).map(|()| ExitCode::SUCCESS);
    }
    let outcome = Planned::new(&path, &text, Replaces::Export, &files)?.write()?;
    let path = path.display().to_string();
    match (format, outcome) {
        (Format::Json, outcome) => print::json(&json!({
            "robot": model.name,
            "file": path,
            "written": outcome == Outcome::Written,
            "notes": print::diagnostics(&notes),
        })),
        (_, Outcome::Written) => print::out(&format!("wrote     {path}\n")).map(|()| ExitCode::SUCCESS),
        (_, Outcome::Unchanged) => print::out(&format!("unchanged {path}\n")).map(|()| ExitCode::SUCCESS),
    }
}
