//! The commands `gelenk identify --reduce`, which reduces logs to moments, and `--merge`, which identifies the
//! robot from moments. Moments are sums of products of a log's samples.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use gelenk_findings::{Severity, counted, texts};
use gelenk_identification::fleet::{LogMoments, identify_moments, reduce};
use gelenk_identification::robot::Robot;
use serde_json::{Value, json};

use super::super::arguments::{Format, Identify};
use super::super::failure::Failure;
use super::super::print;
use super::logs::{finish, output, settings};
use super::motor_constants;
use super::read::{read, say};
use crate::identify::InterpretedRobot;
use crate::read::Loaded;

/// Extension of files with moments.
pub(super) const MOMENTS: &str = "moments";

/// Reduces logs to one file of moments.
pub(super) fn write_reduced(arguments: &Identify, format: Format) -> Result<ExitCode, Failure> {
    let (loaded, robot) = read(arguments)?;
    let path = output(arguments, &loaded, "identified")?;
    if !is_moments(&path) {
        return Err(Failure::Usage(format!(
            "`--reduce` writes a file of moments. Name a file *.{MOMENTS} with --output"
        )));
    }
    let settings = settings(arguments)?;
    let description = Description::of(arguments, &loaded, &robot)?;
    let parts = arguments.logs.iter().map(|log| {
        let moments = print::identified(reduce(&robot, &description.parts(), log, &settings, &mut say))?;
        Ok::<_, Failure>((moments, log.display().to_string()))
    });
    write(&LogMoments::sum(parts)?, &description, &path, format)
}

/// Identifies the robot from files of moments. If the output is also a file of moments, only the sum of the
/// moments is written.
pub(super) fn write_merged(arguments: &Identify, format: Format) -> Result<ExitCode, Failure> {
    let (loaded, robot) = read(arguments)?;
    let path = output(arguments, &loaded, "identified")?;
    let of_results = [("--report", arguments.report.is_some()), ("--method", arguments.method.is_some())];
    if let Some((option, _)) = of_results.iter().find(|(_, is_given)| is_moments(&path) && *is_given) {
        return Err(Failure::Usage(format!(
            "{option} needs an identification, but --output *.moments writes only the sum of the moments. Name a description \
             (*.toml) with --output"
        )));
    }
    let description = Description::of(arguments, &loaded, &robot)?;
    let files = arguments.logs.iter();
    let moments = LogMoments::sum(
        files.map(|file| Ok::<_, Failure>((LogMoments::read(file)?, file.display().to_string()))),
    )?;
    if is_moments(&path) {
        return write(&moments, &description, &path, format);
    }
    let found = identify_moments(&robot, &description.parts(), &moments, &settings(arguments)?, &mut say);
    let mut found = print::identified(found)?;
    motor_constants::add_doubts(&mut found);
    finish(arguments, format, &loaded, &robot, &found, &[], &path)
}

fn is_moments(path: &Path) -> bool {
    path.extension().is_some_and(|end| end == MOMENTS)
}

fn write(
    moments: &LogMoments,
    description: &Description,
    path: &Path,
    format: Format,
) -> Result<ExitCode, Failure> {
    moments.write(&description.parts(), path)?;
    print::result(format, || as_json(moments, path), || as_text(moments, path))
}

fn samples(moments: &LogMoments) -> u64 {
    moments.logs().iter().map(|log| log.samples).sum()
}

fn as_text(moments: &LogMoments, path: &Path) -> String {
    let (logs, samples, shares) = (moments.logs().len(), samples(moments), moments.shares());
    let logs = counted(logs, "log", "logs");
    format!(
        "wrote {}: {logs}, {samples} samples in {shares} of 16 groups for cross-validation\n",
        path.display()
    )
}

fn as_json(moments: &LogMoments, path: &Path) -> Value {
    let logs = moments.logs().iter().map(|log| {
        json!({
            "name": log.name,
            "sha256": log.hash(),
            "samples": log.samples,
            "seconds": log.seconds,
            "bandwidth": log.bandwidth,
            "delays": log.delays,
        })
    });
    json!({
        "moments": path.display().to_string(),
        "logs": logs.collect::<Value>(),
        "samples": samples(moments),
        "shares": moments.shares(),
        "warnings": texts(&moments.doubts(), Severity::Warning),
    })
}

/// Identity of the description to which moments belong: the bytes of its files, and the options with which
/// it was read.
struct Description {
    files: Vec<Vec<u8>>,
    reading: String,
}

impl Description {
    fn of(arguments: &Identify, loaded: &Loaded, robot: &InterpretedRobot) -> Result<Self, Failure> {
        let read = |path: &PathBuf| {
            fs::read(path).map_err(|error| Failure::Problem(format!("{}: {error}", path.display())))
        };
        let files = loaded.files.iter().map(read).collect::<Result<_, _>>()?;
        let mut reading = arguments.reading.keys().join("\n");
        // Moments of shafts must not be added to moments of joints, even if their sizes are equal.
        if !robot.shafts().is_empty() {
            reading.push_str("\nrows of shafts");
        }
        Ok(Self { files, reading })
    }

    fn parts(&self) -> Vec<&[u8]> {
        self.files.iter().map(Vec::as_slice).chain([self.reading.as_bytes()]).collect()
    }
}
