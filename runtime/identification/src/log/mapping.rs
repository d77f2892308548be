//! Which column of a stranger's log is which quantity of a robot.

use super::super::error::Result;
use super::super::run::Effort;
use super::acting::Acting;
use super::brief::Taken;
use super::families::Targets;
use super::finder::{Finder, RobotColumns};
use super::labels::Labels;
use super::options::{ColumnOptions, Named, Pattern, is_effort};
use super::pose_columns::{self, PoseColumns};
use super::search::{Found, Source};
use super::sheet::{Sheet, shortened};
use super::time::{TimeColumn, find_time};
use super::vocabulary::{Header, Kind, Origin, is_number, meaning, words};
use gelenk_findings::Finding;

/// The columns of one log.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Mapping {
    pub time: TimeColumn,
    pub run: Option<usize>,
    pub positions: Vec<Source>,
    pub velocities: Vec<Option<Source>>,
    /// Commanded positions, where there are columns of all joints.
    pub desired: Option<Vec<Source>>,
    pub efforts: Vec<Source>,
    pub effort: Effort,
    /// Entries of the poses of all joints with a quaternion.
    pub poses: Vec<Source>,
    /// What the efforts act on where joints have quaternions.
    pub acting: Option<Acting>,
    /// What the log calls its columns.
    pub labels: Labels,
    /// One line for each quantity.
    pub brief: Vec<String>,
    /// What makes the result doubtful: quantities that are commanded, where measured ones are needed.
    pub warnings: Vec<Finding>,
    /// One sentence for each column, then what was assumed.
    pub sentences: Vec<String>,
    /// Headers of the columns that nothing uses.
    pub unused: Vec<String>,
}

/// Finds the columns of a robot in a sheet.
///
/// # Errors
/// Quantities without columns or with two sets of them, and units that do not fit, each with the line of
/// `--columns` that settles it.
pub(super) fn resolve(
    sheet: &Sheet,
    robot: &RobotColumns,
    options: &ColumnOptions,
    source: &str,
) -> Result<Mapping> {
    let patterns = options.patterns()?;
    let headers: Vec<Header> = sheet
        .headers
        .iter()
        .enumerate()
        .map(|(i, text)| Header::new(i, text, sheet.units.get(i).and_then(Option::as_deref)))
        .collect();
    let listed = listed_names(sheet, &headers, robot);
    let finder =
        Finder { sheet, headers: &headers, robot, patterns: &patterns, listed: listed.as_deref(), source };
    finder.require_header()?;
    finder.mapping(options)
}

impl Finder<'_> {
    /// A row of numbers is no header.
    fn require_header(&self) -> Result<()> {
        let asked = |named: fn(Named) -> bool| self.pattern(named).is_some();
        let all = asked(|n| n == Named::Time) && asked(|n| n == Named::Position) && asked(is_effort);
        if !self.headers.is_empty() || all {
            return Ok(());
        }
        let n = self.robot.joints.names.len();
        Err(self.fault(format!(
            "the log has no header: its first row is `{}`. Say which column is what by numbers, as in --columns \
             'time=1,position=2..{},torque={}..{}'",
            shortened(&self.sheet.first),
            n + 1,
            n + 2,
            2 * n + 1
        )))
    }

    fn mapping(&self, options: &ColumnOptions) -> Result<Mapping> {
        let joints = &self.robot.joints;
        let time = find_time(self)?;
        let poses = self.poses()?;
        let position = self.positions()?;
        let velocity = self.velocities()?;
        let (effort, acting, efforts) = self.efforts_and_places(options.effort)?;
        let run = self.run()?;
        let mut sentences = vec![time.said.clone()];
        let mut used = time.columns();
        used.extend(run);
        used.extend(&position.columns);
        used.extend(poses.sources.iter().map(|source| source.column));
        sentences.extend(poses.sentences);
        let positions = self.sources(&position, Kind::Position, joints, &mut sentences)?;
        used.extend(velocity.iter().flat_map(|found| &found.columns));
        let velocities = self.of_velocities(velocity.as_ref(), &mut sentences)?;
        let (kind, targets) = self.of_effort(effort, acting.as_ref());
        let labels = Labels::new(self, time.column, (&position, joints), (&efforts, targets));
        used.extend(&efforts.columns);
        let efforts_sources = self.sources(&efforts, kind, targets, &mut sentences)?;
        let desired = self.desired(&position, &mut sentences)?;
        used.extend(desired.iter().flatten().map(|source| source.column));
        sentences.extend(run.map(|r| format!("Column {} is the number of the run.", self.label(r))));
        self.require_distinct(&used)?;
        let taken = Taken {
            time: &time,
            run,
            position: &position,
            velocity: velocity.as_ref(),
            efforts: (&efforts, kind, targets),
            desired: desired.as_deref(),
            poses: &poses.sources,
        };
        let brief = self.brief(&taken, effort);
        let commanded = self.commanded_said((&position, &efforts), (kind, targets));
        let warnings = time.doubt.iter().cloned().chain(commanded).collect();
        sentences
            .extend([Some(position), velocity, Some(efforts)].into_iter().flatten().flat_map(|f| f.remarks));
        Ok(Mapping {
            time,
            run,
            positions,
            velocities,
            desired,
            efforts: efforts_sources,
            poses: poses.sources,
            acting,
            labels,
            effort: if self.robot.direct && effort == Effort::Input { Effort::Joint } else { effort },
            brief,
            warnings,
            sentences,
            unused: self.unused(&used),
        })
    }

    /// Columns of the poses; none where no joint has a quaternion.
    fn poses(&self) -> Result<PoseColumns> {
        let asks = self.pattern(|n| matches!(n, Named::Place | Named::Xyzw | Named::Wxyz)).is_some();
        match (self.robot.quaternions.is_empty(), asks) {
            (true, false) => Ok(PoseColumns::default()),
            (true, true) => Err(self.fault(
                "--columns names a place or a quaternion, but no joint of this robot is spherical or floating".into(),
            )),
            (false, _) => pose_columns::find(self),
        }
    }

    fn positions(&self) -> Result<Found> {
        if self.robot.joints.names.is_empty() {
            return Ok(Found::default());
        }
        self.required(Named::Position, &[Kind::Position], &self.robot.joints)
    }

    /// Columns of the efforts, and what they act on where joints have quaternions.
    fn efforts_and_places(&self, wanted: Option<Effort>) -> Result<(Effort, Option<Acting>, Found)> {
        if self.robot.quaternions.is_empty() {
            return self.efforts(wanted).map(|(effort, found)| (effort, None, found));
        }
        let (acting, mut found) = self.acting(wanted)?;
        let effort = if acting == Acting::Joints { Effort::Joint } else { Effort::Input };
        found.remarks.push(self.effort_said(effort, wanted.is_some() || self.pattern(is_effort).is_some()));
        Ok((effort, Some(acting), found))
    }

    fn of_effort(&self, effort: Effort, acting: Option<&Acting>) -> (Kind, &Targets) {
        if let Some(Acting::Inputs(known)) = acting
            && known.len() < self.robot.inputs.names.len()
        {
            return (Kind::Input, &self.robot.frame_inputs);
        }
        match effort {
            Effort::Joint => (Kind::Torque, &self.robot.torques),
            Effort::Input => (Kind::Input, &self.robot.inputs),
            Effort::Current => (Kind::Current, &self.robot.inputs),
        }
    }

    fn unused(&self, used: &[usize]) -> Vec<String> {
        let left = self.headers.iter().filter(|h| !used.contains(&h.index) && !h.text.is_empty());
        left.map(|h| h.text.clone()).collect()
    }

    fn require_distinct(&self, used: &[usize]) -> Result<()> {
        let twice = used.iter().enumerate().find(|(i, column)| used[..*i].contains(column));
        match twice {
            Some((_, column)) => Err(self.fault(format!(
                "column {} would stand for two quantities: name the columns with --columns",
                self.label(*column)
            ))),
            None => Ok(()),
        }
    }

    fn run(&self) -> Result<Option<usize>> {
        if let Some(pattern) = self.pattern(|n| n == Named::Run) {
            let one = Targets::new(&["run".into()], &[]);
            return Ok(pattern.resolve(self.headers, self.sheet.width, &one)?.columns.first().copied());
        }
        let mut runs = self.headers.iter().filter(|h| {
            let words: Vec<&str> = h.words.iter().map(String::as_str).collect();
            meaning(&words).is_some_and(|m| m.kind == Kind::Run && m.doubt < 2)
        });
        match (runs.next(), runs.next()) {
            (Some(a), Some(b)) => Err(self.fault(format!(
                "both `{}` and `{}` could be the number of the run: --columns 'run={}' settles it",
                a.text, b.text, a.text
            ))),
            (found, _) => Ok(found.map(|h| h.index)),
        }
    }

    /// By the user's pattern, or the best family; none without one.
    fn optional(&self, named: Named, kind: Kind, targets: &Targets) -> Result<Option<Found>> {
        if let Some(pattern) = self.pattern(|n| n == named) {
            return self.by_pattern(pattern, targets).map(Some);
        }
        self.best(&[kind], targets)
    }

    /// Velocities are no must: columns in a unit that is none of theirs (`v1 [V]`) are something else.
    fn velocities(&self) -> Result<Option<Found>> {
        let joints = &self.robot.joints;
        if joints.names.is_empty() {
            return Ok(None);
        }
        let found = self.optional(Named::Velocity, Kind::Velocity, joints)?;
        if self.pattern(|n| n == Named::Velocity).is_some() {
            return Ok(found);
        }
        Ok(found.filter(|f| self.sources(f, Kind::Velocity, joints, &mut Vec::new()).is_ok()))
    }

    /// The velocity of each joint; none where the log has none.
    fn of_velocities(
        &self,
        found: Option<&Found>,
        sentences: &mut Vec<String>,
    ) -> Result<Vec<Option<Source>>> {
        let joints = &self.robot.joints;
        let Some(found) = found else { return Ok(vec![None; joints.names.len()]) };
        Ok(self.sources(found, Kind::Velocity, joints, sentences)?.into_iter().map(Some).collect())
    }

    /// Commanded positions are no must either. They are looked for beside measured ones only.
    fn desired(&self, position: &Found, sentences: &mut Vec<String>) -> Result<Option<Vec<Source>>> {
        let joints = &self.robot.joints;
        if !self.robot.quaternions.is_empty() {
            let is_asked = self.pattern(|n| n == Named::Desired).is_some();
            let fault = "commanded positions are not read where joints have quaternions: leave out `desired`";
            return if is_asked { Err(self.fault(fault.into())) } else { Ok(None) };
        }
        let given = self.pattern(|n| n == Named::Desired).map(|p| self.by_pattern(p, joints)).transpose()?;
        let is_given = given.is_some();
        let Some(found) = given.or_else(|| self.commanded(position)) else { return Ok(None) };
        let sources = match self.sources(&found, Kind::Position, joints, &mut Vec::new()) {
            Err(fault) if is_given => return Err(fault),
            Err(_) => return Ok(None),
            Ok(sources) => sources,
        };
        sentences.push(format!(
            "Columns {} are the commanded positions: instruments that tell whether noise of the measurement biases the \
             estimate.",
            self.pattern_of(&found.columns, joints)
        ));
        Ok(Some(sources))
    }

    /// The only best family of commanded positions beside measured ones.
    fn commanded(&self, position: &Found) -> Option<Found> {
        if self.is_commanded(&position.columns) {
            return None;
        }
        let mut families = self.families(&[Kind::Position], &self.robot.joints);
        families.retain(|f| f.meaning.origin == Origin::Commanded && f.meaning.doubt < 2);
        let complete = families.iter().filter_map(|f| Some((f.rank(), f.complete()?)));
        let complete: Vec<_> = complete.filter(|(_, columns)| *columns != position.columns).collect();
        let Some((rank, columns)) = complete.first() else {
            return self.by_pattern(&Pattern::of_control_loop(), &self.robot.joints).ok();
        };
        let is_only = complete.iter().all(|(other, others)| other != rank || others == columns);
        is_only.then(|| Found { columns: columns.clone(), ..Found::default() })
    }

    fn required(&self, named: Named, kinds: &[Kind], targets: &Targets) -> Result<Found> {
        match self.optional(named, kinds[0], targets)? {
            Some(found) => Ok(found),
            None => Err(self.missing(kinds, targets)),
        }
    }

    fn efforts(&self, wanted: Option<Effort>) -> Result<(Effort, Found)> {
        if let Some(pattern) = self.pattern(is_effort) {
            let named = match pattern.named {
                Named::Input => Effort::Input,
                Named::Current => Effort::Current,
                _ => Effort::Joint,
            };
            let effort = wanted.unwrap_or(named);
            let mut found = self.by_pattern(pattern, self.of_effort(effort, None).1)?;
            found.remarks.push(self.effort_said(effort, true));
            return Ok((effort, found));
        }
        let tried: &[(Effort, &[Kind])] = match wanted {
            Some(Effort::Joint) => &[(Effort::Joint, &[Kind::Torque, Kind::Input])],
            Some(Effort::Input) => &[(Effort::Input, &[Kind::Input, Kind::Torque])],
            Some(Effort::Current) => &[(Effort::Current, &[Kind::Current, Kind::Torque, Kind::Input])],
            None => &[
                (Effort::Joint, &[Kind::Torque]),
                (Effort::Input, &[Kind::Input]),
                (Effort::Current, &[Kind::Current]),
            ],
        };
        let mut found = Vec::new();
        for (effort, kinds) in tried {
            let targets = self.of_effort(*effort, None).1;
            // No columns would do for a robot without drives.
            if !targets.names.is_empty() {
                found.extend(self.best(kinds, targets)?.map(|f| (*effort, f)));
            } else if wanted.is_some() {
                return Err(self.missing(kinds, targets));
            }
        }
        // What was commanded is the last choice: a torque that was asked for says less than a current that flowed.
        let commanded = |f: &(Effort, Found)| self.is_commanded(&f.1.columns);
        let best = found.iter().position(|f| !commanded(f)).or((!found.is_empty()).then_some(0));
        let Some(best) = best else {
            return Err(self.missing(&[Kind::Torque, Kind::Input, Kind::Current], &self.robot.joints));
        };
        let (effort, mut efforts) = found.swap_remove(best);
        efforts.remarks.push(self.effort_said(effort, wanted.is_some()));
        Ok((effort, efforts))
    }

    fn effort_said(&self, effort: Effort, is_told: bool) -> String {
        let why = if is_told { "as told" } else { "by their names" };
        match effort {
            _ if self.robot.direct && effort != Effort::Current => format!(
                "The efforts are taken as forces at the joints, {why}; the description's drives are ideal (B = 1), so \
                 inputs are the same."
            ),
            Effort::Joint => format!("The efforts are taken as forces at the joints (B u), {why}."),
            Effort::Input => {
                format!("The efforts are taken as the inputs u, at the motors' side of the gears, {why}.")
            }
            Effort::Current => {
                format!("The efforts are taken as motor currents, {why}; u = K_M i with K_M unknown.")
            }
        }
    }
}

/// Joints in the order of a message that names them in its rows: `field.name0`, … or one list of names.
fn listed_names(sheet: &Sheet, headers: &[Header], robot: &RobotColumns) -> Option<Vec<Option<usize>>> {
    let is_name = |h: &&Header| {
        let words: Vec<&str> = h.words.iter().map(String::as_str).filter(|w| !is_number(w)).collect();
        meaning(&words).is_some_and(|m| m.kind == Kind::Name)
    };
    let columns: Vec<&Header> = headers.iter().filter(is_name).collect();
    let value = |h: &&Header| sheet.first.get(h.index).map(|text| text.trim().to_owned());
    let names: Vec<String> = match columns.as_slice() {
        [only] => value(only)?.split(['\'', '"']).skip(1).step_by(2).map(str::to_owned).collect(),
        several => several.iter().filter_map(value).collect(),
    };
    let joint = |name: &String| robot.joints.position(name).or_else(|| robot.joints.mentioned(&words(name)));
    let joints: Vec<Option<usize>> = names.iter().map(joint).collect();
    let all = (0..robot.joints.names.len()).all(|j| joints.contains(&Some(j)));
    (all && !names.is_empty()).then_some(joints)
}
