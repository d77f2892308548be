//! The command `gelenk identify`, which estimates friction, inertias and drive gains from logs.

mod columns;
mod found_json;
mod logs;
mod moments;
mod motor_constants;
mod online;
mod payload;
mod plan;
mod read;

use std::process::ExitCode;

use super::arguments::{Format, Identify};
use super::failure::Failure;

/// Runs the task that the arguments choose:
///
/// - identification from logs or from moments (sums of products of a log's samples)
/// - reduction of logs to moments
/// - plan of a motion
/// - identification of a load
/// - replay of a log
/// - list of the columns of a log
pub(super) fn identify(arguments: &Identify, format: Format) -> Result<ExitCode, Failure> {
    match arguments {
        _ if read::stated(arguments).asks() => columns::print(arguments, format),
        Identify { plan: true, .. } => plan::write(arguments, format),
        Identify { reduce: true, .. } => moments::write_reduced(arguments, format),
        Identify { merge: true, .. } => moments::write_merged(arguments, format),
        Identify { online: true, .. } => online::write(arguments, format),
        Identify { payload, .. } if !payload.is_empty() => payload::write(arguments, format),
        _ => logs::write(arguments, format),
    }
}
