//! `gelenk identify`.

mod logs;
mod moments;
mod plan;
mod read;

use std::process::ExitCode;

use super::arguments::{Format, Identify};
use super::failure::Failure;

/// Identifies a robot from its logs or their moments, reduces logs to moments, or plans a motion to record.
pub(super) fn identify(arguments: &Identify, format: Format) -> Result<ExitCode, Failure> {
    match arguments {
        Identify { plan: true, .. } => plan::write(arguments, format),
        Identify { reduce: true, .. } => moments::write_reduced(arguments, format),
        Identify { merge: true, .. } => moments::write_merged(arguments, format),
        _ => logs::write(arguments, format),
    }
}
