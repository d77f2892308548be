//! All stages in order.

use std::path::{Path, PathBuf};

use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::dynamics::function::Function;
use crate::emit::{self, EmitOptions, SourceFile};
use crate::model::Model;

/// What the caller may ask for beyond the description.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct GenerateOptions {
    /// Functions to generate; empty: what the description asks for, by default all.
    pub functions: Vec<String>,
    /// Angles within this many radians of a multiple of 90° are taken for it.
    pub snap_angles: Option<f64>,
    /// Leaves out friction.
    pub no_friction: bool,
    /// Makes mimic joints independent coordinates.
    pub ignore_mimic: bool,
    /// How the module is written.
    pub emit: EmitOptions,
}

/// What became of a description.
#[derive(Debug, Clone, PartialEq)]
pub struct Generated {
    /// The robot.
    pub model: Model,
    /// Its functions.
    pub functions: Vec<Function>,
    /// The module.
    pub source: SourceFile,
    /// What is worth knowing about the description.
    pub notes: Diagnostics,
    /// All files that were read, the description first.
    pub files: Vec<PathBuf>,
}

/// From a description to the text of a Rust module. Reads files, writes none.
///
/// # Errors
/// All [`Diagnostics`] of the first stage that found the description at fault.
pub fn generate(description: &Path, options: &GenerateOptions) -> Result<Generated, Diagnostics> {
    let (model, notes, files) = read(description, options)?;
    let functions = derive(&model, options)?;
    let source = emit::module(&model, &functions, &options.emit);
    Ok(Generated {
        model,
        functions,
        source,
        notes,
        files,
    })
}

/// Stage 1. Placeholder until the branch `descriptions` is merged.
fn read(
    description: &Path,
    _options: &GenerateOptions,
) -> Result<(Model, Diagnostics, Vec<PathBuf>), Diagnostics> {
    let shown = description.display();
    std::fs::metadata(description).map_err(|error| {
        Diagnostic::error("unreadable-file", format!("cannot read {shown}: {error}"))
            .help("check the path")
    })?;
    Err(Diagnostic::error(
        "not-implemented",
        format!("{shown}: reading descriptions is not part of this build"),
    )
    .into())
}

/// Stages 2 to 4. Placeholder until derivation is merged.
fn derive(_model: &Model, _options: &GenerateOptions) -> Result<Vec<Function>, Diagnostics> {
    Err(Diagnostic::error(
        "not-implemented",
        "deriving equations is not part of this build",
    )
    .into())
}
