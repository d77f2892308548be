//! Assignment of the columns of a log to the quantities of a robot.

use super::super::super::error::Result;
use super::super::super::run::Effort;
use super::super::sheet::{Sheet, shortened};
use super::families::{Family, Key, Targets};
use super::finder::Finder;
use super::found::{Found, Labels};
use super::header::Header;
use super::pattern::{Chosen, ColumnOptions};
use super::robot::RobotColumns;
use super::table::Kind;
use super::time::TimeColumn;
use gelenk_findings::Finding;

/// Columns of one log, by quantity.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::log) struct Mapping {
    pub time: TimeColumn,
    pub run: Option<usize>,
    pub positions: Found,
    pub velocities: Option<Found>,
    pub efforts: Found,
    pub effort: Effort,
    /// Position (only of a floating joint) and quaternion of each joint that has a quaternion.
    pub poses: Vec<Found>,
    /// Names of the columns in the log.
    pub labels: Labels,
    /// One line of text for each quantity.
    pub brief: Vec<String>,
    /// Warnings about the assignment of columns to quantities.
    pub warnings: Vec<Finding>,
    /// Headers of the columns that are not used.
    pub unused: Vec<String>,
}

/// Quantities of a log, or the errors of those that were not found.
pub(super) struct Parts {
    pub time: Result<TimeColumn>,
    pub places: Result<Vec<Found>>,
    pub attitudes: Result<Vec<Found>>,
    pub position: Result<Found>,
    pub velocity: Result<Option<Found>>,
    pub efforts: Result<(Effort, Found)>,
    pub run: Result<Option<usize>>,
}

/// Line for a robot whose log has no efforts except those of inputs at frames.
const BASE_ALONE: &str = "the log has no efforts of the joints. Only the equations of the base and of joints without a drive are fitted";

/// End of messages that ask the user to name columns.
const HINT: &str = ". --columns '?' prints all columns as a line that you can edit";

/// Finds the columns of a robot in a sheet.
///
/// # Errors
/// [`IdentificationError::File`](super::super::super::error::IdentificationError::File) if a quantity has no columns or two
/// possible sets of columns, or if a unit does not fit. The message contains the argument of `--columns` that solves the
/// problem.
pub(in crate::log) fn resolve(
    sheet: &Sheet,
    robot: &RobotColumns,
    options: &ColumnOptions,
    source: &str,
) -> Result<Mapping> {
    let finder = Finder::new(sheet, robot, options, source, HINT)?;
    finder.require_header()?;
    finder.require_absent()?;
    finder.mapping(finder.parts(options.effort))
}

impl Finder<'_> {
    /// Fails if there is no header and the user does not name all columns. A row of numbers is not a header.
    pub(super) fn require_header(&self) -> Result<()> {
        let is_named = |kind: fn(Kind) -> bool| self.pattern(kind).is_some();
        let all =
            is_named(|k| k == Kind::Time) && is_named(|k| k == Kind::Position) && is_named(Kind::is_effort);
        if !self.headers.is_empty() || all {
            return Ok(());
        }
        let n = self.robot.joints.names.len();
        Err(self.fault(format!(
            "the log has no header. Its first row is `{}`. Name the columns by their numbers, as in --columns \
             'time=1,position=2..{},torque={}..{}'",
            shortened(&self.sheet.first),
            n + 1,
            n + 2,
            2 * n + 1
        )))
    }

    /// Fails if a joint is held although the log has its columns.
    fn require_absent(&self) -> Result<()> {
        let (all, held) = (&self.robot.all_joints, &self.robot.held);
        let own = |family: Family| {
            let is_sure = family.key == Key::Name || family.complete().is_some();
            let columns = family
                .columns
                .into_iter()
                .enumerate()
                .filter(move |(joint, _)| is_sure && held[*joint].is_some());
            columns.filter_map(|(joint, column)| Some((&all.names[joint], column?)))
        };
        let kinds = [Kind::Position, Kind::Torque, Kind::Input, Kind::Current];
        match self.families(&kinds, all).into_iter().flat_map(own).next() {
            Some((name, column)) => Err(self.fault(format!(
                "joint `{name}` is held by an option, but the log has its column {}. Remove --hold {name}",
                self.label(column)
            ))),
            None => Ok(()),
        }
    }

    pub(super) fn parts(&self, effort: Option<Effort>) -> Parts {
        Parts {
            time: self.time(),
            places: self.places(),
            attitudes: self.attitudes(),
            velocity: self.velocities(),
            efforts: self.efforts(effort),
            run: self.run(),
            position: self.positions(),
        }
    }

    fn mapping(&self, parts: Parts) -> Result<Mapping> {
        let (time, poses) = (parts.time?, self.poses(parts.places?, parts.attitudes?));
        let (positions, velocities) = (parts.position?, parts.velocity?);
        let ((effort, efforts), run) = (parts.efforts?, parts.run?);
        let mut used = time.columns();
        used.extend(run);
        let all = [Some(&positions), velocities.as_ref(), Some(&efforts)];
        used.extend(all.into_iter().flatten().chain(&poses).flat_map(Found::indices));
        self.require_distinct(&used)?;
        let (joints, inputs) = (self.robot.held.len(), self.robot.input_units.len());
        let doubts = [positions.if_commanded(), efforts.if_commanded()];
        let warnings = time.doubt.clone().into_iter().chain(doubts.into_iter().flatten());
        let mut mapping = Mapping {
            // Without quaternions, forces at the joints and inputs are equal if the input matrix B is the identity.
            effort: match effort {
                Effort::Input if self.robot.direct && poses.is_empty() => Effort::Joint,
                other => other,
            },
            labels: Labels {
                time: time.text.clone(),
                positions: positions.labels(joints),
                efforts: efforts.labels(if effort == Effort::Joint { joints } else { inputs }),
            },
            brief: Vec::new(),
            warnings: warnings.collect(),
            unused: self.unused(&used),
            time,
            run,
            positions,
            velocities,
            efforts,
            poses,
        };
        mapping.brief = self.brief(&mapping, effort);
        Ok(mapping)
    }

    /// Returns a line of text for each quantity.
    fn brief(&self, mapping: &Mapping, effort: Effort) -> Vec<String> {
        let time: Vec<String> = mapping.time.columns().iter().map(|column| self.label(*column)).collect();
        let time = if time.is_empty() { "the numbers of the rows".to_owned() } else { time.join(" and ") };
        let forces = match effort {
            Effort::Input if self.robot.direct => "forces at the joints",
            Effort::Joint => "forces at the joints",
            Effort::Input => "inputs, before the gears",
            Effort::Current => "motor currents",
        };
        let poses: Vec<usize> = mapping.poses.iter().flat_map(Found::indices).collect();
        let ends = poses.first().zip(poses.last()).map(|(first, last)| {
            format!("poses: {} columns from {} to {}", poses.len(), self.label(*first), self.label(*last))
        });
        let compared = "(only for a comparison: the derivatives of the positions are used)";
        let velocities = mapping.velocities.as_ref().and_then(|found| found.line("velocities"));
        let held: Vec<String> =
            self.robot.held_values().map(|(name, value)| format!("{name} at {value}")).collect();
        let lines = [
            Some(format!("time: {time}")),
            mapping.run.map(|run| format!("number of the run: {}", self.label(run))),
            ends,
            mapping.positions.line("positions"),
            velocities.map(|line| format!("{line} {compared}")),
            mapping.efforts.line(&format!("efforts, as {forces}")),
            self.has_frames_alone(&mapping.efforts).then(|| BASE_ALONE.into()),
            (!held.is_empty()).then(|| format!("joints that are held without columns: {}", held.join(", "))),
        ];
        lines.into_iter().flatten().collect()
    }

    fn unused(&self, used: &[usize]) -> Vec<String> {
        let left = self.headers.iter().filter(|h| !used.contains(&h.index) && !h.text.is_empty());
        left.map(|h| h.text.clone()).collect()
    }

    pub(super) fn require_distinct(&self, used: &[usize]) -> Result<()> {
        let twice = used.iter().enumerate().find(|(i, column)| used[..*i].contains(column));
        match twice {
            Some((_, column)) => Err(self.undecided(format!(
                "column {} fits two quantities: name the columns with --columns",
                self.label(*column)
            ))),
            None => Ok(()),
        }
    }

    fn run(&self) -> Result<Option<usize>> {
        if let Some(pattern) = self.pattern(|k| k == Kind::Run) {
            let chosen = pattern.resolve(&self.headers, self.sheet.width, &Targets::one("run"))?;
            return Ok(chosen.columns.first().copied());
        }
        let is_run = |h: &&Header| h.own_meaning().is_some_and(|m| m.kind == Kind::Run && m.doubt < 2);
        let mut runs = self.headers.iter().filter(is_run);
        match (runs.next(), runs.next()) {
            (Some(a), Some(b)) => Err(self.undecided(format!(
                "both `{}` and `{}` could be the number of the run: use --columns 'run={}'",
                a.text, b.text, a.text
            ))),
            (found, _) => Ok(found.map(|h| h.index)),
        }
    }

    fn positions(&self) -> Result<Found> {
        let joints = &self.robot.joints;
        let choice = match joints.names.is_empty() {
            true => Chosen::default(),
            false => self
                .optional(Kind::Position, joints)?
                .ok_or_else(|| self.missing(&[Kind::Position], joints))?,
        };
        self.found(choice, Kind::Position, joints)
    }

    /// Returns the columns of velocities, which are optional. Columns with a unit of another quantity (`v1 [V]`) are not
    /// velocities.
    fn velocities(&self) -> Result<Option<Found>> {
        let joints = &self.robot.joints;
        if joints.names.is_empty() {
            return Ok(None);
        }
        let Some(choice) = self.optional(Kind::Velocity, joints)? else { return Ok(None) };
        let found = self.found(choice, Kind::Velocity, joints);
        if self.pattern(|k| k == Kind::Velocity).is_some() { found.map(Some) } else { Ok(found.ok()) }
    }
}
