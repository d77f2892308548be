//! Writes the modules of a build script.

use std::fmt;
use std::path::{Path, PathBuf};

use super::write::{Planned, Replaces, WriteError};
use crate::diagnostic::Diagnostics;
use crate::pipeline::Generated;

/// Errors that a build script may return.
#[derive(Debug)]
pub enum BuildError {
    /// The build script gave no description.
    NothingToDo,
    /// The output folder is unknown: neither `OUT_DIR` nor
    /// [`Builder::output_folder`](super::Builder::output_folder) sets it.
    NoFolder,
    /// One or more descriptions have errors.
    Descriptions(Vec<Diagnostics>),
    /// A file could not be written, for the reason in the field.
    Write(WriteError),
    /// Two descriptions have the same robot name, which the field contains.
    SameName(String),
}

impl fmt::Display for BuildError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NothingToDo => f.write_str("no description is given: call `description(\"robot.toml\")`"),
            Self::NoFolder => f.write_str(
                "OUT_DIR is not set: call this function from build.rs, or call `output_folder` first",
            ),
            Self::Descriptions(all) => {
                let texts: Vec<String> = all.iter().map(ToString::to_string).collect();
                f.write_str(&texts.join("\n\n"))
            }
            Self::Write(error) => error.fmt(f),
            Self::SameName(name) => {
                write!(f, "two descriptions have the robot name `{name}`: rename one")
            }
        }
    }
}

impl std::error::Error for BuildError {}

/// A generated module and its description.
pub(super) struct Robot {
    pub(super) description: PathBuf,
    pub(super) generated: Generated,
}

/// Writes all modules of a build script and returns their paths. If one module must not be written, no module
/// is written.
pub(super) fn write(folder: &Path, robots: &[Robot]) -> Result<Vec<PathBuf>, BuildError> {
    let read = robots.iter().flat_map(|robot| robot.generated.files.clone());
    let read: Vec<PathBuf> = read.collect();
    let files = robots.iter().flat_map(|robot| {
        let source = &robot.generated.source;
        let files = source.files().into_iter();
        files.map(|(ending, text)| (folder.join(format!("{}{ending}", source.name)), text))
    });
    let planned = files.map(|(path, text)| Planned::new(&path, text, Replaces::Module, &read));
    let planned = planned.collect::<Result<Vec<_>, _>>().map_err(BuildError::Write)?;
    let paths = planned.iter().map(|file| {
        file.write()?;
        Ok(file.path().to_owned())
    });
    paths.collect::<Result<_, _>>().map_err(BuildError::Write)
}
