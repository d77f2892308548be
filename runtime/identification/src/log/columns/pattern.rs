//! The user's options for the columns of a log: `--columns 'position=joint{}_pos[deg],torque=…,time=…'`.

use gelenk_formula::Hold;

use super::super::super::error::{IdentificationError, Place, Result};
use super::super::super::run::Effort;
use super::super::sheet::shortened;
use super::super::units::{self, Unit};
use super::families::Targets;
use super::header::{Header, words};
use super::table::Kind;

/// The user's options for the columns of a log. By default the columns are found by their headers.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct ColumnOptions {
    /// Text `QUANTITY=COLUMNS,…`. The columns of other quantities are found by their headers.
    ///
    /// - Quantities: `time`, `position`, `velocity`, `run` (number of the run), and one of `torque` (at the joints),
    ///   `input` (of the motors) and `current`. A joint with a quaternion has `xyzw` or `wxyz` (the entries of the
    ///   quaternion in this order) and, if it is floating, `place` (x, y, z).
    /// - Columns: a header with `{}` instead of the joint's number or `{name}` instead of its name; headers in the order of
    ///   the joints, separated by `|`; or numbers, counted from 1: `2..7`.
    /// - A unit in brackets may follow: `position=2..7[deg]`, `position=count{}[0.0879 deg]`.
    /// - Rows that were recorded at equal intervals need no column of times: `time=row[4 ms]`.
    /// - Joints without columns, with their positions in rad or m (0 if there is no value): `hold=gripper|wrist_*=0.5`.
    pub columns: Option<String>,
    /// Field separator; if it is `None`, it is detected.
    pub separator: Option<char>,
    /// Kind of the efforts; if it is `None`, the names of the columns decide.
    pub effort: Option<Effort>,
}

/// Key of `--columns` for joints that are held at fixed positions.
const HOLD: &str = "hold";
/// Part of `--columns` that requests the list of columns.
const ASKED: &str = "?";

/// One part `QUANTITY=COLUMNS` of the argument.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Pattern {
    pub kind: Kind,
    key: &'static str,
    text: String,
}

/// Columns of a quantity, each with the unit that the user specifies.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Chosen {
    pub columns: Vec<usize>,
    pub units: Vec<Option<Unit>>,
    /// Whether only commanded columns were found and the user did not name them.
    pub is_commanded: bool,
}

impl Chosen {
    /// Creates columns with the same unit.
    pub(super) fn alike(columns: Vec<usize>, unit: Option<Unit>) -> Self {
        Self { units: vec![unit; columns.len()], columns, ..Self::default() }
    }

    /// Splits the columns into groups of `width`, one group for each joint.
    pub(super) fn split(&self, width: usize) -> Vec<Self> {
        let parts = self.columns.chunks(width).zip(self.units.chunks(width));
        let part = |(columns, units): (&[usize], &[Option<Unit>])| (columns.to_vec(), units.to_vec());
        parts.map(part).map(|(columns, units)| Self { columns, units, ..Self::default() }).collect()
    }
}

impl ColumnOptions {
    /// Returns the patterns in the order of the argument.
    pub(super) fn patterns(&self) -> Result<Vec<Pattern>> {
        let mut patterns: Vec<Pattern> = Vec::new();
        for (part, name, text) in self.named()?.into_iter().filter(|(_, name, _)| name != HOLD) {
            let Some((kind, key)) = Kind::of_key(&name) else {
                let known: Vec<&str> = Kind::keys().chain([HOLD]).collect();
                let message =
                    format!("there is no quantity `{name}`. The quantities are {}", known.join(", "));
                return Err(fault(part, message));
            };
            if patterns.iter().any(|p| p.kind == kind || p.kind.is_effort() && kind.is_effort()) {
                return Err(fault(part, twice(kind)));
            }
            patterns.push(Pattern { kind, key, text: text.to_owned() });
        }
        Ok(patterns)
    }

    /// Returns whether the argument has a `?`, which requests the list of columns.
    pub fn asks(&self) -> bool {
        parts(self.columns.as_deref().unwrap_or("")).contains(&ASKED)
    }

    /// Returns the position of each joint that is held, in rad or m; `None` for other joints.
    ///
    /// # Errors
    /// [`IdentificationError::File`] if a pattern matches no joint, or if a value is not a number.
    pub fn held(&self, joints: &[String]) -> Result<Vec<Option<f64>>> {
        let mut held = vec![None; joints.len()];
        let all = self.named()?;
        let holds = all.iter().filter(|(_, name, _)| name == HOLD);
        for pattern in holds.flat_map(|(.., text)| text.split('|')) {
            let fault =
                |message: String| Place::default().option(format!("--hold `{pattern}`")).fault(message);
            let hold = Hold::parse(pattern).map_err(fault)?;
            let matching: Vec<usize> = (0..joints.len()).filter(|j| hold.matches(&joints[*j])).collect();
            if matching.is_empty() {
                return Err(fault(format!(
                    "no joint matches this name or pattern. The joints are {}",
                    shortened(joints)
                )));
            }
            matching.into_iter().for_each(|joint| held[joint] = Some(hold.position));
        }
        Ok(held)
    }

    /// Returns text, key and columns of each part of the argument.
    fn named(&self) -> Result<Vec<(&str, String, &str)>> {
        let split = |part| {
            match str::split_once(part, '=') {
            Some((name, text)) => Ok((part, name.trim().to_lowercase(), text.trim())),
            None => Err(fault(
                part,
                "this part does not have the form `QUANTITY=COLUMNS`, as in `position=q{},torque=tau{},time=t`".into(),
            )),
        }
        };
        let parts = parts(self.columns.as_deref().unwrap_or("")).into_iter();
        parts.filter(|part| *part != ASKED).map(split).collect()
    }
}

fn twice(kind: Kind) -> String {
    match kind {
        Kind::Attitude => "the quaternions are named twice, by `xyzw` and by `wxyz`: remove one of them".into(),
        _ => "this quantity is named twice. Remove one part: `torque`, `input` and `current` count as one quantity".into(),
    }
}

/// Splits the argument into its parts. A comma separates parts only if `QUANTITY=` follows. Other commas belong to headers.
fn parts(line: &str) -> Vec<&str> {
    let mut parts = Vec::new();
    let mut start = 0;
    for (at, _) in line.match_indices(',').filter(|(at, _)| begins_part(&line[at + 1..])) {
        parts.push(&line[start..at]);
        start = at + 1;
    }
    parts.push(&line[start..]);
    parts.retain(|part| !part.trim().is_empty());
    parts
}

fn begins_part(rest: &str) -> bool {
    let key = rest.split_once('=').map_or("", |(key, _)| key).trim();
    !key.is_empty() && key.chars().all(|c| c.is_ascii_alphabetic())
}

/// Returns whether a pattern can contain the text of a header.
pub(super) fn is_spellable(text: &str) -> bool {
    let is_cut = text.match_indices(',').any(|(at, _)| begins_part(&text[at + 1..]));
    !(is_cut
        || text.is_empty()
        || text != text.trim()
        || text.contains(['|', '{', '\''])
        || text.contains(".."))
}

fn fault(text: &str, message: String) -> IdentificationError {
    Place::default().option(format!("--columns `{}`", text.trim())).fault(message)
}

impl Pattern {
    pub(super) fn new(kind: Kind, text: &str) -> Self {
        Self { kind, key: kind.key(), text: text.to_owned() }
    }

    /// Returns the period in s if the pattern counts rows as the time, as in `row[4 ms]`; `None` for other texts, or if a
    /// column is called `row`.
    pub(super) fn counts_rows(&self, headers: &[Header]) -> Option<f64> {
        let unit = self.text.strip_prefix("row[")?.strip_suffix(']')?;
        let is_free = headers.iter().all(|header| bare(&header.text) != "row");
        units::find(unit).filter(|unit| is_free && unit.si == "s").map(|unit| unit.factor)
    }

    /// Returns the columns of the `targets`, in their order. Components are in the order of the table of quantities.
    ///
    /// - `width`: number of fields of a row, which limits the numbers of columns
    pub(super) fn resolve(&self, headers: &[Header], width: usize, targets: &Targets) -> Result<Chosen> {
        let mut chosen = self.chosen(headers, width, targets)?;
        let (given, count) = (chosen.columns.len(), targets.names.len());
        if given != count {
            let needed = format!(
                "the pattern names {given} columns, but {count} are needed: one for each joint, input or component"
            );
            return Err(fault(&self.text, needed));
        }
        let components = self.kind.row().components;
        if let Some(turn) =
            components.first().and_then(|letter| self.key.find(letter)).filter(|turn| *turn > 0)
        {
            chosen.columns.chunks_mut(components.len()).for_each(|entries| entries.rotate_left(turn));
        }
        Ok(chosen)
    }

    fn chosen(&self, headers: &[Header], width: usize, targets: &Targets) -> Result<Chosen> {
        if let Some(columns) = columns(&self.text, headers, width, targets)? {
            return Ok(Chosen::alike(columns, None));
        }
        let split = self.text.strip_suffix(']').and_then(|rest| rest.rsplit_once('['));
        if let Some((text, unit)) = split.filter(|(_, unit)| !unit.contains('{')) {
            let Some(found) = units::find(unit) else {
                let message =
                    format!("the unit `{unit}` is unknown. The known units are {}", units::known_units());
                return Err(fault(&self.text, message));
            };
            if let Some(columns) = columns(text.trim_end(), headers, width, targets)? {
                return Ok(Chosen::alike(columns, Some(found)));
            }
        }
        each(&self.text, headers, width).ok_or_else(|| self.nothing(headers))
    }

    /// Returns the error that no column has the name. The message lists the columns and the most similar name.
    fn nothing(&self, headers: &[Header]) -> IdentificationError {
        let names: Vec<String> = headers.iter().map(|h| h.text.clone()).collect();
        if names.is_empty() {
            let message = "the log has no header: give the numbers of the columns, as in `position=2..7`";
            return fault(&self.text, message.into());
        }
        // The time for the comparison grows with the product of the lengths.
        let cut = |text: &str| text.to_lowercase().chars().take(100).collect::<String>();
        let wanted = cut(&self.text);
        let likeness = |name: &&String| strsim::jaro_winkler(&cut(name), &wanted);
        let nearest = names.iter().take(1000).rev().max_by(|a, b| likeness(a).total_cmp(&likeness(b)));
        let nearest = nearest.map_or(String::new(), |n| format!(". The most similar name is `{n}`"));
        fault(&self.text, format!("no column has this name{nearest}. The columns are {}", shortened(&names)))
    }
}

/// Returns the columns that a text names; `None` if there are no such columns.
fn columns(text: &str, headers: &[Header], width: usize, targets: &Targets) -> Result<Option<Vec<usize>>> {
    if text.contains("{name}") {
        return by_names(text, headers, targets);
    }
    if text.contains("{}") {
        return by_numbers(text, headers, targets);
    }
    if let Some((first, last)) = text.split_once("..")
        && let (Ok(first), Ok(last)) =
            (first.trim().parse::<usize>(), last.trim().trim_start_matches('=').parse())
    {
        return range(text, first, last, width).map(Some);
    }
    Ok(text.split('|').map(|item| one(item.trim(), headers, width)).collect())
}

/// Returns the columns of a list, each with or without a unit, as in `tau1|tau2[-1 Nm]|tau3`; `None` if one of the columns
/// does not exist.
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
    Some(Chosen { columns, units, ..Chosen::default() })
}

/// Returns the column with this header or number; `None` if there is no such column.
fn one(item: &str, headers: &[Header], width: usize) -> Option<usize> {
    let same = |h: &&Header| h.text.trim() == item;
    let lower = item.to_lowercase();
    let alike =
        |h: &&Header| h.text.trim().to_lowercase() == lower || (!item.is_empty() && bare(&h.text) == lower);
    let header = headers.iter().find(same).or_else(|| headers.iter().find(alike));
    let number = || item.parse::<usize>().ok().filter(|n| (1..=width).contains(n)).map(|n| n - 1);
    header.map(|h| h.index).or_else(number)
}

/// Returns the text in lower case, without a unit in brackets at the end.
fn bare(text: &str) -> String {
    let text = text.trim();
    let cut = text.strip_suffix([']', ')']).and_then(|rest| rest.rsplit_once(['[', '(']));
    let cut = cut.filter(|(_, unit)| units::find(unit).is_some() && unit.parse::<f64>().is_err());
    cut.map_or(text, |(name, _)| name.trim_end()).to_lowercase()
}

fn range(text: &str, first: usize, last: usize, width: usize) -> Result<Vec<usize>> {
    if first == 0 || last < first || last > width {
        return Err(fault(
            text,
            format!("the range of columns is not valid: the log has columns 1 to {width}"),
        ));
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
        Some(missing) => {
            let column = text.replace("{name}", &targets.names[missing]);
            Err(fault(text, format!("there is no column `{column}`")))
        }
        None => Ok(found.into_iter().collect()),
    }
}

fn by_numbers(text: &str, headers: &[Header], targets: &Targets) -> Result<Option<Vec<usize>>> {
    let (before, after) = text.split_once("{}").unwrap_or((text, ""));
    let (before, after) = (before.to_lowercase(), after.to_lowercase());
    let number = |header: &str| {
        let middle = header.strip_prefix(before.as_str())?.strip_suffix(after.as_str())?;
        middle.parse::<u64>().ok()
    };
    let numbered = headers.iter().filter_map(|h| {
        let full = h.text.trim().to_lowercase();
        number(&full).or_else(|| number(&bare(&full))).map(|n| (n, h.index))
    });
    let mut numbered: Vec<(u64, usize)> = numbered.collect();
    numbered.sort_unstable();
    let Some((first, _)) = numbered.first() else { return Ok(None) };
    let found: Option<Vec<usize>> = targets.by_number(&numbered).into_iter().collect();
    if found.is_some() {
        return Ok(found);
    }
    let (numbers, base): (Vec<String>, _) =
        (numbered.iter().take(40).map(|n| n.0.to_string()).collect(), u8::from(*first != 0));
    let count = targets.names.len();
    Err(fault(
        text,
        format!(
            "the headers have the numbers {}, but {count} consecutive numbers from {base} on are \
                             needed",
            numbers.join(", ")
        ),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joints_are_held_by_patterns() {
        let joints = ["shoulder", "wrist_1", "wrist_2"].map(str::to_owned);
        let held = |line: &str| {
            ColumnOptions { columns: Some(line.into()), ..ColumnOptions::default() }.held(&joints)
        };
        assert_eq!(held("time=t,hold=wrist_*").unwrap(), [None, Some(0.0), Some(0.0)]);
        assert_eq!(held("hold=*_1=0.5|shoulder=-1e-1").unwrap(), [Some(-0.1), Some(0.5), None]);
        assert_eq!(held("hold=*r*").unwrap(), [Some(0.0); 3]);
        assert_eq!(held("hold=s*l*r|wrist*_*2").unwrap(), [Some(0.0), None, Some(0.0)]);
        assert!(["hold=shoulder*r", "hold=wrist_1*_*", "hold=w*w*"].iter().all(|line| held(line).is_err()));
        assert_eq!(held("").unwrap(), [None; 3]);
        let message = |line: &str| held(line).unwrap_err().to_string();
        assert!(
            message("hold=elbow")
                .contains("--hold `elbow`: no joint matches this name or pattern. The joints are shoulder")
        );
        assert!(message("hold=wrist_1=up").contains("the value must be a finite number"));
    }
}
