//! What a user says about the columns of a log: `--columns 'position=joint{}_pos[deg],torque=…,time=…'`.

use super::super::error::{IdentificationError, Result};
use super::super::run::Effort;
use super::families::Targets;
use super::sheet::shortened;
use super::units::{self, Unit};
use super::vocabulary::{Header, words};

/// What is said about the columns of a log; nothing by default.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct ColumnOptions {
    /// `QUANTITY=COLUMNS,…`; quantities that are not named are looked for.
    ///
    /// - quantities: `time`, `position`, `desired` (the commanded position), `velocity`, one of `torque` (at the joints), `input` (of the motors) and
    ///   `current`, and `run`; of joints with a quaternion `place` (x, y, z) and `xyzw` or `wxyz` (the quaternion's entries
    ///   in this order);
    /// - columns: a header with `{}` where the joint's number stands or `{name}` where its name does; headers with
    ///   `|` between them, in the robot's order; or numbers, counted from 1: `2..7`;
    /// - a unit in brackets may follow: `position=2..7[deg]`, `position=count{}[0.0879 deg]`;
    /// - rows at equal times have no need of a column: `time=row[4 ms]`.
    pub columns: Option<String>,
    /// Field separator, where it is not found.
    pub separator: Option<char>,
    /// What the efforts are, where their names do not say it.
    pub effort: Option<Effort>,
}

/// A quantity that `--columns` can name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Named {
    Time,
    Position,
    Desired,
    Velocity,
    Torque,
    Input,
    Current,
    Run,
    Place,
    Xyzw,
    Wxyz,
}

const KEYS: [(&str, Named); 13] = [
    ("time", Named::Time),
    ("position", Named::Position),
    ("desired", Named::Desired),
    ("velocity", Named::Velocity),
    ("torque", Named::Torque),
    ("effort", Named::Torque),
    ("input", Named::Input),
    ("current", Named::Current),
    ("run", Named::Run),
    ("trial", Named::Run),
    ("place", Named::Place),
    ("xyzw", Named::Xyzw),
    ("wxyz", Named::Wxyz),
];

/// One `QUANTITY=COLUMNS`.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Pattern {
    pub named: Named,
    text: String,
}

/// Columns that a pattern names, each with its unit where the pattern gives one.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Chosen {
    pub columns: Vec<usize>,
    pub units: Vec<Option<Unit>>,
}

impl Chosen {
    /// Columns in one unit.
    fn alike(columns: Vec<usize>, unit: Option<Unit>) -> Self {
        Self { units: vec![unit; columns.len()], columns }
    }

    /// The unit of the first column.
    pub(super) fn unit(&self) -> Option<Unit> {
        self.units.first().copied().flatten()
    }
}

impl ColumnOptions {
    /// The patterns in the order of the line.
    pub(super) fn patterns(&self) -> Result<Vec<Pattern>> {
        let mut patterns: Vec<Pattern> = Vec::new();
        let line = self.columns.as_deref().unwrap_or("");
        for part in parts(line) {
            let (key, text) = part.split_once('=').ok_or_else(|| {
                fault(part, "this is not `QUANTITY=COLUMNS`, as in `position=q{},torque=tau{},time=t`".into())
            })?;
            let key = key.trim().to_lowercase();
            let named =
                KEYS.iter().find(|(known, _)| *known == key).map(|(_, named)| *named).ok_or_else(|| {
                    fault(
                        part,
                        format!("there is no quantity `{key}`; known are {}", KEYS.map(|k| k.0).join(", ")),
                    )
                })?;
            if patterns.iter().any(|p| p.named == named || is_effort(p.named) && is_effort(named)) {
                return Err(fault(
                    part,
                    "the line names this quantity twice; torque, input and current are one".into(),
                ));
            }
            patterns.push(Pattern { named, text: text.trim().to_owned() });
        }
        Ok(patterns)
    }
}

pub(super) fn is_effort(named: Named) -> bool {
    matches!(named, Named::Torque | Named::Input | Named::Current)
}

/// Parts between commas that a `QUANTITY=` follows; other commas belong to headers.
fn parts(line: &str) -> Vec<&str> {
    let begins = |rest: &str| {
        let key = rest.split_once('=').map_or("", |(key, _)| key).trim();
        !key.is_empty() && key.chars().all(|c| c.is_ascii_alphabetic())
    };
    let mut parts = Vec::new();
    let mut start = 0;
    for (at, _) in line.match_indices(',').filter(|(at, _)| begins(&line[at + 1..])) {
        parts.push(&line[start..at]);
        start = at + 1;
    }
    parts.push(&line[start..]);
    parts.retain(|part| !part.trim().is_empty());
    parts
}

fn fault(text: &str, message: String) -> IdentificationError {
    IdentificationError::File { place: format!("--columns `{}`", text.trim()), message }
}

impl Pattern {
    /// Commanded positions in the log of the runtime's control loop.
    pub(super) fn of_control_loop() -> Self {
        Self { named: Named::Desired, text: "desired_{name}".into() }
    }

    /// The period \[s\] of rows that are counted as the time, `row[4 ms]`, where no column has this name.
    pub(super) fn counts_rows(&self, headers: &[Header]) -> Option<f64> {
        let unit = self.text.strip_prefix("row[")?.strip_suffix(']')?;
        let is_free = headers.iter().all(|header| bare(&header.text) != "row");
        units::find(unit).filter(|unit| is_free && unit.si == "s").map(|unit| unit.factor)
    }

    /// The columns for each of `targets`.
    ///
    /// - `width`: fields of a row, for numbers of columns
    pub(super) fn resolve(&self, headers: &[Header], width: usize, targets: &Targets) -> Result<Chosen> {
        let count = targets.names.len();
        let whole = self.columns(&self.text, headers, width, targets)?;
        if let Some(columns) = whole {
            return self.counted(Chosen::alike(columns, None), count);
        }
        let split = self.text.strip_suffix(']').and_then(|rest| rest.rsplit_once('['));
        if let Some((text, unit)) = split.filter(|(_, unit)| !unit.contains("{")) {
            let Some(found) = units::find(unit) else {
                return Err(fault(
                    &self.text,
                    format!("unknown unit `{unit}`; known are {}", units::known_units()),
                ));
            };
            if let Some(columns) = self.columns(text.trim_end(), headers, width, targets)? {
                return self.counted(Chosen::alike(columns, Some(found)), count);
            }
        }
        match each(&self.text, headers, width) {
            Some(chosen) => self.counted(chosen, count),
            None => Err(self.nothing(headers)),
        }
    }

    fn counted(&self, chosen: Chosen, count: usize) -> Result<Chosen> {
        let given = chosen.columns.len();
        if given == count {
            return Ok(chosen);
        }
        let needed = format!("it names {given} columns, {count} are needed, one for each joint or input");
        Err(fault(&self.text, needed))
    }

    /// None where nothing has this name.
    fn columns(
        &self,
        text: &str,
        headers: &[Header],
        width: usize,
        targets: &Targets,
    ) -> Result<Option<Vec<usize>>> {
        if text.contains("{name}") {
            return by_names(text, headers, targets);
        }
        if text.contains("{}") {
            return by_numbers(text, headers, targets.names.len());
        }
        if let Some((first, last)) = text.split_once("..")
            && let (Ok(first), Ok(last)) =
                (first.trim().parse::<usize>(), last.trim().trim_start_matches('=').parse())
        {
            return range(text, first, last, width).map(Some);
        }
        Ok(text.split('|').map(|item| one(item.trim(), headers, width)).collect())
    }

    /// Nothing has the name: which columns there are, and which is the nearest.
    fn nothing(&self, headers: &[Header]) -> IdentificationError {
        let names: Vec<String> = headers.iter().map(|h| h.text.clone()).collect();
        if names.is_empty() {
            return fault(
                &self.text,
                "the log has no header; give the columns' numbers, as in `position=2..7`".into(),
            );
        }
        // The comparison takes time with the product of the lengths.
        let cut = |text: &str| text.to_lowercase().chars().take(100).collect::<String>();
        let wanted = cut(&self.text);
        let likeness = |name: &&String| strsim::jaro_winkler(&cut(name), &wanted);
        let nearest = names.iter().take(1000).rev().max_by(|a, b| likeness(a).total_cmp(&likeness(b)));
        let nearest = nearest.map_or(String::new(), |n| format!("; the nearest is `{n}`"));
        fault(&self.text, format!("no columns have this name{nearest}. There are {}", shortened(&names)))
    }
}

/// Columns of a list, each with a unit of its own or none, as in `tau1|tau2[-1 Nm]|tau3`; `None` where one of them is not
/// there.
fn each(text: &str, headers: &[Header], width: usize) -> Option<Chosen> {
    let item = |item: &str| {
        let item = item.trim();
        if let Some(column) = one(item, headers, width) {
            return Some((column, None));
        }
        let (name, unit) = item.strip_suffix(']')?.rsplit_once('[')?;
        Some((one(name.trim_end(), headers, width)?, Some(units::find(unit)?)))
    };
    let items: Option<Vec<(usize, Option<Unit>)>> = text.split('|').map(item).collect();
    let (columns, units) = items?.into_iter().unzip();
    Some(Chosen { columns, units })
}

/// A header, or the number of a column.
fn one(item: &str, headers: &[Header], width: usize) -> Option<usize> {
    let same = |h: &&Header| h.text.trim() == item;
    let lower = item.to_lowercase();
    let alike =
        |h: &&Header| h.text.trim().to_lowercase() == lower || (!item.is_empty() && bare(&h.text) == lower);
    let header = headers.iter().find(same).or_else(|| headers.iter().find(alike));
    let number = || item.parse::<usize>().ok().filter(|n| (1..=width).contains(n)).map(|n| n - 1);
    header.map(|h| h.index).or_else(number)
}

/// In lower case and without a unit in brackets at the end.
fn bare(text: &str) -> String {
    let text = text.trim();
    let cut = text.strip_suffix([']', ')']).and_then(|rest| rest.rsplit_once(['[', '(']));
    let cut = cut.filter(|(_, unit)| units::find(unit).is_some() && unit.parse::<f64>().is_err());
    cut.map_or(text, |(name, _)| name.trim_end()).to_lowercase()
}

fn range(text: &str, first: usize, last: usize, width: usize) -> Result<Vec<usize>> {
    if first == 0 || last < first || last > width {
        return Err(fault(text, format!("the log has columns 1 to {width}")));
    }
    Ok((first - 1..last).collect())
}

fn by_names(text: &str, headers: &[Header], targets: &Targets) -> Result<Option<Vec<usize>>> {
    let column = |name: &String| {
        let filled = text.replace("{name}", name);
        let spelled = words(&filled);
        let exact = one(&filled, headers, 0);
        exact.or_else(|| headers.iter().find(|h| h.words == spelled).map(|h| h.index))
    };
    let found: Vec<Option<usize>> = targets.names.iter().map(column).collect();
    if found.iter().all(Option::is_none) {
        return Ok(None);
    }
    match found.iter().position(Option::is_none) {
        Some(missing) => Err(fault(
            text,
            format!("there is no column `{}`", text.replace("{name}", &targets.names[missing])),
        )),
        None => Ok(found.into_iter().collect()),
    }
}

/// Numbers from 0 where there is a 0, otherwise from 1; others are left.
fn by_numbers(text: &str, headers: &[Header], count: usize) -> Result<Option<Vec<usize>>> {
    let (before, after) = text.split_once("{}").unwrap_or((text, ""));
    let (before, after) = (before.to_lowercase(), after.to_lowercase());
    let number = |header: &str| {
        let middle = header.strip_prefix(before.as_str())?.strip_suffix(after.as_str())?;
        middle.parse::<u64>().ok()
    };
    let mut numbered: Vec<(u64, usize)> = headers
        .iter()
        .filter_map(|h| {
            let full = h.text.trim().to_lowercase();
            number(&full).or_else(|| number(&bare(&full))).map(|n| (n, h.index))
        })
        .collect();
    numbered.sort_unstable();
    let Some(first) = numbered.first().map(|n| n.0) else { return Ok(None) };
    let base = if numbered.len() == count { first } else { u64::from(first != 0) };
    let column =
        |joint: usize| numbered.iter().find(|n| Some(n.0) == base.checked_add(joint as u64)).map(|n| n.1);
    let found: Option<Vec<usize>> = (0..count).map(column).collect();
    match found {
        Some(columns) => Ok(Some(columns)),
        None => {
            let numbers: Vec<String> = numbered.iter().take(40).map(|n| n.0.to_string()).collect();
            Err(fault(
                text,
                format!("the numbers are {}; {count} from {base} on are needed", numbers.join(", ")),
            ))
        }
    }
}
