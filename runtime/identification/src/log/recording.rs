//! Reads logs as runs of a robot.

use super::super::error::{IdentificationError, Result, at};
use super::super::robot::Robot;
use super::super::run::{Effort, FEWEST_SAMPLES, Run};
use super::bag::table;
use super::columns::{ColumnGuess, ColumnOptions, Labels, Mapping, RobotColumns, guess, resolve};
use super::health;
use super::packed::{LARGEST, unpacked};
use super::runs::{LEFT_OUT, Samples, split};
use super::saturation::cut_off;
use super::sheet::Sheet;
use gelenk_findings::{Finding, Rule, counted};
use sha2::{Digest, Sha256};
use std::borrow::Cow;
use std::path::{Path, PathBuf};
use std::slice;

/// Sees: the columns that are used for each quantity, and the columns that are not used.
/// Matters: a wrong column makes a wrong estimate.
/// Example: the columns `q{}`, from `q1` of joint pan to `q3` of joint elbow, are the positions.
/// Fixture: `good` in `codegen/tests/findings/arm.rs`.
const COLUMNS: Rule = Rule::note("columns");

/// Runs of one or more logs of a robot.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    /// Runs in the order of the files and rows.
    pub runs: Vec<Run>,
    /// Kind of the efforts of all runs. All logs have the same kind.
    pub effort: Effort,
    /// Findings about values of the logs that are suspicious, left out or repaired.
    pub findings: Vec<Finding>,
    /// Headers of the columns in the first log.
    pub(crate) labels: Labels,
    /// Columns that are used, one line of text for each quantity.
    pub columns: Vec<String>,
    /// Headers of columns that are not used.
    pub unused: Vec<String>,
    /// Path of each log, and its SHA-256 in hexadecimal.
    pub hashes: Vec<(String, String)>,
}

/// Largest number of headers in the message about unused columns.
const MOST_UNUSED: usize = 12;

/// Reads logs as runs of a robot. A run is a part of a log without interruption.
///
/// Columns are found by their names or by the user's options ([`ColumnOptions`]). The reader prefers measured columns to
/// commanded ones, names of joints to numbers, and the time stamp of a message to the time of its arrival. Times keep all
/// digits of the file.
///
/// A run ends at the end of a file, if the column of the run number changes, or if the time goes back. These rows are left
/// out: rows without a time, a position or an effort, and rows with the time of the row before. Jumps of a revolute joint's
/// position by a full turn are removed. [`Recording::findings`] reports all of this.
///
/// # Errors
/// - [`IdentificationError::Empty`]: `paths` is empty
/// - [`IdentificationError::File`]: a file cannot be read or is not a table, columns are missing or ambiguous, a unit does
///   not fit, a log has fewer than two complete rows, or logs have efforts of different kinds
pub fn runs(paths: &[PathBuf], robot: &dyn Robot, columns: &ColumnOptions) -> Result<Recording> {
    runs_noting(paths, robot, columns, &mut Vec::new())
}

/// Reads logs as [`runs`] does, and also returns the findings that precede an error.
///
/// - `findings`: receives the findings, also those before an error
pub(crate) fn runs_noting(
    paths: &[PathBuf],
    robot: &dyn Robot,
    columns: &ColumnOptions,
    findings: &mut Vec<Finding>,
) -> Result<Recording> {
    let mut recording: Option<Recording> = None;
    for path in paths {
        let place = path.display().to_string();
        let one = read_bytes(&bytes_of(path)?, &place, robot, columns, findings)?;
        recording = Some(match recording {
            None => one,
            Some(before) => join(before, one)?,
        });
    }
    let mut recording =
        recording.ok_or_else(|| IdentificationError::Empty { what: "the list of logs".into() })?;
    recording.findings = std::mem::take(findings);
    name_by_file(&mut recording, paths);
    recording.look(robot);
    Ok(recording)
}

/// Reads one log as [`runs`] does, from bytes in memory.
///
/// - `source`: name of the log in messages and in the runs
///
/// # Errors
/// The errors are those of [`runs`].
pub fn runs_of(bytes: &[u8], source: &str, robot: &dyn Robot, columns: &ColumnOptions) -> Result<Recording> {
    let mut findings = Vec::new();
    let mut recording = read_bytes(bytes, source, robot, columns, &mut findings)?;
    recording.findings = findings;
    recording.look(robot);
    Ok(recording)
}

impl Recording {
    /// Checks the runs and adds the findings.
    fn look(&mut self, robot: &dyn Robot) {
        self.leave_out_short();
        let columns = &self.labels.efforts.columns;
        // Efforts of inputs at frames have been converted to joint forces, for which there is no column.
        let names = match self.effort {
            Effort::Joint if !robot.has_inputs_at_frames() => robot.joint_names(),
            Effort::Joint => Vec::new(),
            _ => robot.input_names(),
        };
        let names = if names.len() == columns.len() { names } else { Vec::new() };
        let cut_off = cut_off(&self.runs, &names, columns);
        self.findings.extend(health::findings(&self.runs, robot));
        self.findings.extend(cut_off);
    }

    /// Leaves out runs that are too short for a filter, if there are longer runs.
    fn leave_out_short(&mut self) {
        let is_long = |run: &Run| run.times.len() >= FEWEST_SAMPLES;
        let short = self.runs.iter().filter(|run| !is_long(run)).count();
        if short == 0 || short == self.runs.len() {
            return;
        }
        self.runs.retain(is_long);
        let short = counted(short, "run is left out, because it has", "runs are left out, because they have");
        let message = format!("{short} fewer than {FEWEST_SAMPLES} samples, too few for a filter");
        self.findings.push(LEFT_OUT.found(message));
    }

    /// Returns one note for each quantity on the columns that are used, and one note on the columns that are not used.
    pub(crate) fn columns_found(&self) -> Vec<Finding> {
        let shown: Vec<String> =
            self.unused.iter().take(MOST_UNUSED).map(|header| format!("`{header}`")).collect();
        let more = self.unused.len().saturating_sub(MOST_UNUSED);
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        let unused = (!shown.is_empty()).then(|| format!("not used: {}{more}", shown.join(", ")));
        self.columns.iter().cloned().chain(unused).map(|line| COLUMNS.found(line)).collect()
    }

    /// Returns the SHA-256 of the samples. It does not depend on empty lines, comments and unused columns of the log.
    pub(crate) fn content(&self) -> [u8; 32] {
        content(&self.runs)
    }
}

fn content(runs: &[Run]) -> [u8; 32] {
    let mut hasher = Sha256::new();
    for run in runs {
        hasher.update((run.times.len() as u64).to_le_bytes());
        let columns = std::iter::once(&run.times).chain(&run.positions).chain(&run.poses).chain(&run.efforts);
        columns.flatten().for_each(|x| hasher.update(x.to_le_bytes()));
    }
    hasher.finalize().into()
}

/// Finds the columns of a log, and returns them as an argument of `--columns`.
///
/// # Errors
/// [`IdentificationError::File`] if the file cannot be read or is not a table, or if the options are not valid. A missing
/// column is not an error.
pub fn guess_columns(path: &Path, robot: &dyn Robot, columns: &ColumnOptions) -> Result<ColumnGuess> {
    let source = path.display().to_string();
    guess_columns_of(&bytes_of(path)?, &source, robot, columns)
}

/// Finds the columns of a log as [`guess_columns`] does, from bytes in memory.
pub(super) fn guess_columns_of(
    bytes: &[u8],
    source: &str,
    robot: &dyn Robot,
    columns: &ColumnOptions,
) -> Result<ColumnGuess> {
    let text = text_of(bytes, source)?;
    let sheet = Sheet::new(&text, columns.separator, source)?;
    guess(&sheet, &RobotColumns::new(robot, columns)?, columns, source)
}

fn bytes_of(path: &Path) -> Result<Vec<u8>> {
    let fault = |message: String| at(path.display().to_string()).fault(message);
    let size = std::fs::metadata(path).map_err(|e| fault(e.to_string()))?.len();
    if size > LARGEST {
        return Err(fault(format!(
            "the file has {size} bytes, but a log may have at most {LARGEST} bytes. Split it"
        )));
    }
    let mut unwritten = path.as_os_str().to_owned();
    unwritten.push("-wal");
    if std::fs::metadata(&unwritten).is_ok_and(|file| file.len() > 0) {
        let message =
            "the write-ahead log `FILE-wal` has further rows. Write them back with `sqlite3 FILE vacuum`";
        return Err(fault(message.to_owned()));
    }
    std::fs::read(path).map_err(|e| fault(e.to_string()))
}

/// Reads a recording from the bytes of a file.
///
/// - `findings`: receives the findings, also before an error
fn read_bytes(
    bytes: &[u8],
    source: &str,
    robot: &dyn Robot,
    options: &ColumnOptions,
    findings: &mut Vec<Finding>,
) -> Result<Recording> {
    let text = text_of(bytes, source)?;
    let sheet = Sheet::new(&text, options.separator, source)?;
    let names = RobotColumns::new(robot, options)?;
    let mapping = resolve(&sheet, &names, options, source)?;
    let samples = Samples::read(&sheet, &mapping, &names, source, findings)?;
    let runs = split(samples, &mapping, robot, &names, source, findings)?;
    let Mapping { effort, labels, brief, warnings, unused, .. } = mapping;
    let new: Vec<Finding> = warnings.into_iter().filter(|warning| !findings.contains(warning)).collect();
    findings.extend(new);
    Ok(Recording {
        // Inputs at frames have been converted to joint forces.
        effort: runs.first().map_or(effort, |run| run.effort),
        runs,
        findings: Vec::new(),
        labels,
        columns: brief,
        unused,
        hashes: vec![(source.into(), hexadecimal(&Sha256::digest(bytes)))],
    })
}

/// Returns the text of a file. Compressed files are decompressed, bags of ROS 2 are converted to tables.
fn text_of<'a>(bytes: &'a [u8], source: &str) -> Result<Cow<'a, [u8]>> {
    let fault = |message: String| at(source).fault(message);
    let content = unpacked(bytes, LARGEST).map_err(fault)?;
    match table(&content) {
        None => Ok(content),
        Some(text) => text.map(Cow::Owned).map_err(fault),
    }
}

/// Returns the bytes as hexadecimal digits.
pub(crate) fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|b| format!("{b:02x}")).collect()
}

fn join(mut before: Recording, one: Recording) -> Result<Recording> {
    if before.effort != one.effort {
        return Err(at(one.hashes.first().map_or(String::new(), |h| h.0.clone())).fault(format!(
            "the efforts of this log are {}, but those of the logs before it are {}. Use logs with one kind of efforts, or name \
             the columns with `--columns`",
            one.effort.plural(),
            before.effort.plural()
        )));
    }
    if let Some((known, same)) = twice(&before, &one) {
        return Err(at(same).fault(format!("this log has the same samples as {known}: give each log once")));
    }
    before.runs.extend(one.runs);
    before.hashes.extend(one.hashes);
    let place = before.hashes.last().map_or(String::new(), |h| h.0.clone());
    let add = |known: &mut Vec<String>, said: Vec<String>| {
        let new: Vec<String> = said.into_iter().filter(|sentence| !known.contains(sentence)).collect();
        known.extend(new.into_iter().map(|sentence| format!("{place}: {sentence}")));
    };
    add(&mut before.columns, one.columns);
    let unused: Vec<String> = one.unused.into_iter().filter(|name| !before.unused.contains(name)).collect();
    before.unused.extend(unused);
    Ok(before)
}

/// Returns the paths of two logs with the same first run; `None` if there are no such logs. Copies of a log may differ in
/// empty lines or comments.
fn twice(before: &Recording, one: &Recording) -> Option<(String, String)> {
    let ((path, _), run) = (one.hashes.first()?, one.runs.first()?);
    let samples = content(slice::from_ref(run));
    // Times distinguish nearly all runs and are cheaper to compare than hashes.
    let is_same = |known: &&Run| known.times == run.times && content(slice::from_ref(*known)) == samples;
    let known = before.runs.iter().find(is_same)?;
    let logs = before.hashes.iter().map(|(path, _)| path);
    // The path of one log may be the beginning of the path of another log.
    let log = logs.filter(|path| known.name.starts_with(path.as_str())).max_by_key(|path| path.len());
    Some((log.unwrap_or(&known.name).clone(), path.clone()))
}

/// Replaces the paths in the names of runs and in findings by file names, if all file names differ.
fn name_by_file(recording: &mut Recording, paths: &[PathBuf]) {
    let name = |path: &PathBuf| path.file_name().map(|n| n.to_string_lossy().into_owned());
    let names: Vec<Option<String>> = paths.iter().map(name).collect();
    let distinct = names.iter().enumerate().all(|(i, n)| n.is_some() && !names[..i].contains(n));
    if !distinct {
        return;
    }
    for (path, name) in paths.iter().zip(names.iter().flatten()) {
        let place = path.display().to_string();
        for run in &mut recording.runs {
            if let Some(rest) =
                run.name.strip_prefix(&place).filter(|rest| rest.is_empty() || rest.starts_with(", "))
            {
                run.name = format!("{name}{rest}");
            }
        }
        for finding in recording.findings.iter_mut().filter(|f| f.about.log.as_ref() == Some(&place)) {
            finding.about.log = Some(name.clone());
        }
    }
}
