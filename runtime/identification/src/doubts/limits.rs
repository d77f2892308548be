//! Comparison of positions, speeds and efforts of joints with their described limits.

use super::super::log::{ColumnLabels, Recording, are_minutes, is_seen, unit_value};
use super::super::numeric::statistics::span;
use super::super::pose::rows_of;
use super::super::robot::{FollowerLimits, JointLimits, Robot};
use super::super::run::{Effort, PreparedRun};
use super::levels;
use gelenk_findings::digits::plain;
use gelenk_findings::{Finding, Rule, Severity};
use std::f64::consts::TAU;

/// Sees: positions, speeds or efforts of a joint beyond its described limits.
/// Matters: the values may be in another unit, belong to another joint, or be measured on the other side of a gear.
/// Example: a lift that moves to 2.3 m if its limit is 2 m.
/// Fixture: `joints_that_look_wrong_are_named` in `log/tests/styles.rs`.
const BEYOND: Rule = Rule::note("beyond-limits");

/// Sees: positions, speeds or efforts of a joint that are several times their described limit.
/// Matters: the values are in another unit. The identification stops.
/// Example: degrees in a column whose header has no unit.
/// Fixture: `degrees` in `codegen/tests/findings/arm.rs`.
const FAR_BEYOND: Rule = Rule::error("far-beyond-limits");

/// Units of angles, other than rad, in which columns may be recorded. The names are those of the option
/// `--columns`.
const ANGLES: &[&str] = &["deg", "mrad"];
const LENGTHS: &[&str] = &["cm", "mm", "um"];
const TORQUES: &[&str] = &["Ncm", "mNm"];

/// Returns findings about values beyond their limits. Each quantity has at most one finding, about the joint that exceeds
/// its limits most. The finding names the column and the option for the likely unit. Values far beyond the limits are errors.
///
/// - `prepared`: runs with one column for each joint
pub(crate) fn beyond(robot: &dyn Robot, recording: &Recording, prepared: &[PreparedRun]) -> Vec<Finding> {
    let names = robot.joint_names();
    let exact = rows_of(&robot.quaternion_joints(), names.len());
    let joints = (0..names.len()).filter(|joint| !exact[*joint]).collect();
    let log = Log { robot, recording, prepared, joints, names, limits: robot.limits() };
    let positions = log.positions();
    // If positions are in another unit, the speeds are in this unit, too.
    let is_far = positions.as_ref().is_some_and(|finding| finding.severity == Severity::Error);
    let speeds = if is_far { None } else { log.speeds() };
    let own = [positions, speeds, log.efforts()].into_iter().flatten();
    own.chain(robot.followers().iter().flat_map(|joint| log.follower(joint))).collect()
}

/// Values of a joint (positions, speeds or efforts) with their limits.
#[derive(Default)]
struct Range<'a> {
    joint: &'a str,
    /// Values of the checked quantity, `[run][sample]`.
    values: Vec<Vec<f64>>,
    /// Name of the checked quantity (position, speed or effort) and of its column, for messages.
    what: String,
    unit: String,
    limits: [f64; 2],
    /// Amount by which values may exceed a limit without a finding, in the unit of the values.
    tolerance: f64,
    /// Ratio of a value to its limit from which the finding is an error.
    far: f64,
}

struct Log<'a> {
    robot: &'a dyn Robot,
    recording: &'a Recording,
    prepared: &'a [PreparedRun],
    /// Indices of the joints whose limits are checked.
    joints: Vec<usize>,
    names: Vec<String>,
    limits: Vec<JointLimits>,
}

impl Log<'_> {
    fn unit(&self, joint: usize) -> &'static str {
        self.robot.position_units().get(joint).copied().unwrap_or("rad")
    }

    fn limits(&self, joint: usize) -> JointLimits {
        self.limits.get(joint).copied().unwrap_or(JointLimits::NONE)
    }

    fn by_run(&self, values: impl Fn(&PreparedRun) -> Vec<f64>) -> Vec<Vec<f64>> {
        self.prepared.iter().map(values).collect()
    }

    fn positions(&self) -> Option<Finding> {
        let labels = &self.recording.labels.positions;
        let range = |joint: usize| Range {
            joint: &self.names[joint],
            values: self.by_run(|run| run.positions[joint].clone()),
            what: format!("positions{}", in_column("column", labels.columns.get(joint))),
            unit: self.unit(joint).to_owned(),
            ..Range::positions(self.limits(joint).position)
        };
        // Angles and lengths may be in other units.
        let of_unit = |unit: &str| {
            let all =
                self.joints.iter().filter(|joint| self.unit(**joint) == unit).map(|joint| range(*joint));
            let times = all.filter_map(|range| Some(range.excess(&range.values.concat())?.times));
            likely(times.reduce(f64::max)?, if unit == "m" { LENGTHS } else { ANGLES })
        };
        let units: Vec<Option<&str>> = self.joints.iter().map(|joint| of_unit(self.unit(*joint))).collect();
        self.worst(self.joints.iter().map(|joint| range(*joint)), |times, unit| {
            let known = of_unit(unit).map(|name| {
                format!("the positions seem to be in {name}: use --columns 'position={}'", self.with_units(labels, &units))
            });
            known.or_else(|| {
                let counts =
                    format!("if the positions are encoder counts, give the size of one count: --columns 'position={}[0.001 {unit}]'", labels.pattern);
                Some(counts).filter(|_| times > levels::FAR_AWAY.get())
            })
        })
    }

    /// Returns the columns of the joints with units, in the form of `--columns`. The result is a list if units differ.
    fn with_units(&self, labels: &ColumnLabels, units: &[Option<&str>]) -> String {
        let bracket = |unit: &Option<&str>| unit.map_or_else(String::new, |unit| format!("[{unit}]"));
        match units {
            [first, others @ ..] if others.iter().all(|other| other == first) => {
                format!("{}{}", labels.pattern, bracket(first))
            }
            _ => {
                let column = |(joint, unit): (&usize, &Option<&str>)| {
                    Some(format!("{}{}", labels.written.get(*joint)?.as_ref()?, bracket(unit)))
                };
                self.joints.iter().zip(units).filter_map(column).collect::<Vec<_>>().join("|")
            }
        }
    }

    fn speeds(&self) -> Option<Finding> {
        let labels = &self.recording.labels;
        let range = |joint: usize| Range {
            joint: &self.names[joint],
            values: self.by_run(|run| run.velocities[joint].clone()),
            what: format!("speeds{}", in_column("slopes of column", labels.positions.columns.get(joint))),
            unit: format!("{}/s", self.unit(joint)),
            ..Range::within(self.limits(joint).velocity)
        };
        let pattern = &labels.positions.pattern;
        self.worst(self.joints.iter().map(|joint| range(*joint)), |times, unit| {
            let known = likely(times, if unit == "m/s" { LENGTHS } else { ANGLES });
            let positions = known
                .map(|name| format!("the positions are in {name} (--columns 'position={pattern}[{name}]')"));
            let time = |unit: &str| format!("(--columns 'time={}[{unit}]')", labels.time);
            let times = match are_minutes(times) {
                true => Some(format!("the times are in min {}", time("min"))),
                false => Some(format!("the times are in another unit {}", time("UNIT")))
                    .filter(|_| times > levels::FAR.get()),
            };
            let all: Vec<String> = positions.into_iter().chain(times).collect();
            Some(format!("it may be that {}", all.join(" or "))).filter(|_| !all.is_empty())
        })
    }

    fn efforts(&self) -> Option<Finding> {
        let (matrix, unmeasured) = (self.robot.input_matrix(), self.robot.unmeasured());
        let at_frames = self.robot.has_inputs_at_frames();
        let is_input = self.recording.effort == Effort::Input;
        let labels = &self.recording.labels.efforts;
        let values = |run: &PreparedRun, joint: usize| match run.effort {
            Effort::Current => Vec::new(),
            Effort::Input if at_frames => Vec::new(),
            _ => (0..run.times.len()).map(|sample| run.force(&matrix, joint, sample)).collect(),
        };
        let range = |joint: usize| Range {
            joint: &self.names[joint],
            values: self.by_run(|run| values(run, joint)),
            what: format!("efforts{}", in_column("column", labels.columns.get(joint).filter(|_| !is_input))),
            unit: if self.unit(joint) == "m" { "N" } else { "N·m" }.to_owned(),
            ..Range::within(self.limits(joint).effort)
        };
        let (key, pattern) = (if is_input { "input" } else { "torque" }, &labels.pattern);
        let measured = self.joints.iter().filter(|joint| !unmeasured[**joint]);
        self.worst(measured.map(|joint| range(*joint)), |times, unit| {
            let known = likely(times, if unit == "N" { &[] } else { TORQUES });
            let known = known.map(|name| format!("the efforts may be in {name}: use --columns '{key}={pattern}[{name}]'. Otherwise, "));
            Some(format!(
                "{}for counts and percents, give a factor: --columns '{key}={pattern}[0.05 {}]'. For currents, use --effort \
                 current. For efforts of the motors, use --effort input",
                known.unwrap_or_default(),
                unit.replace('·', "")
            ))
        })
    }

    /// Returns findings about a joint that follows other joints. Its values are computed from those joints.
    fn follower(&self, joint: &FollowerLimits) -> Vec<Finding> {
        let values = |columns: &[Vec<f64>], offset: f64| -> Vec<f64> {
            let count = columns.first().map_or(0, Vec::len);
            (0..count).map(|k| joint.sum(columns.iter().map(|column| column[k]), offset)).collect()
        };
        let range = |what: &str, values: Vec<Vec<f64>>, of: Range<'static>| Range {
            joint: &joint.name,
            values,
            what: format!("{what} (computed from the joints that it follows)"),
            far: f64::INFINITY,
            ..of
        };
        let positions = self.by_run(|run| values(&run.positions, joint.offset));
        let positions = range("positions", positions, Range::positions(joint.position));
        let speeds = self.by_run(|run| values(&run.velocities, 0.0));
        let speeds = range("speeds", speeds, Range::within(joint.velocity));
        [positions, speeds]
            .into_iter()
            .filter_map(|range| self.worst([range].into_iter(), |_, _| None))
            .collect()
    }

    /// Returns the finding about the joint that exceeds its limits most; `None` if no joint exceeds its limits.
    ///
    /// - `help`: function that returns a remedy. Its arguments are the ratio of the values to the limit, and the unit.
    fn worst<'r>(
        &self,
        ranges: impl Iterator<Item = Range<'r>>,
        help: impl Fn(f64, &str) -> Option<String>,
    ) -> Option<Finding> {
        let mut all: Vec<(Excess, Range)> =
            ranges.filter_map(|range| Some((range.excess(&range.values.concat())?, range))).collect();
        // The sort is stable, so that the first of equal joints stays first.
        all.sort_by(|a, b| b.0.times.total_cmp(&a.0.times));
        let (Excess { low, high, times }, range) = all.first()?;
        let is_far = *times > range.far;
        let as_far = |run: &usize| {
            range.excess(&range.values[*run]).is_some_and(|excess| !is_far || excess.times > range.far)
        };
        let runs: Vec<usize> = (0..range.values.len()).filter(as_far).collect();
        let run = runs.first().filter(|_| runs.len() == 1 && range.values.len() > 1);
        let others: Vec<&str> = all[1..].iter().map(|(_, range)| range.joint).collect();
        let others = match others[..] {
            [] => String::new(),
            _ => format!(". The values of {} also exceed their limits", others.join(", ")),
        };
        let [least, most] = range.limits;
        let [low, high, least, most] = [*low, *high, least, most].map(|x| plain(x, 4));
        let unit = if range.unit.is_empty() { String::new() } else { format!(" {}", range.unit) };
        let message = format!(
            "its {} range from {low} to {high}{unit}{}, but the described limits are {least} and {most}{others}",
            range.what,
            run.map_or_else(String::new, |run| format!(", only in run {}", self.prepared[*run].name))
        );
        let rule = if is_far { FAR_BEYOND } else { BEYOND };
        let found = rule.found(message).joint(range.joint).with("times the limit", *times, "");
        // An option for one run would change the other runs, too.
        let alone = run.map(
            |_| "Convert this log to the units of the other logs, because `--columns` applies to all logs",
        );
        let accept = "Or correct the limits in the description. `--accept-poor` uses the values unchanged";
        let remedy = help(*times, &range.unit).into_iter().chain(alone.filter(|_| is_far).map(str::to_owned));
        let remedy = remedy.chain(is_far.then(|| accept.to_owned())).collect::<Vec<_>>().join(". ");
        Some(if remedy.is_empty() { found } else { found.help(remedy) })
    }
}

/// Smallest and largest value without outliers, if one of them is beyond a limit, and the ratio of the larger magnitude to
/// the larger limit.
struct Excess {
    low: f64,
    high: f64,
    times: f64,
}

impl Range<'static> {
    fn positions(limits: [f64; 2]) -> Self {
        let range = (limits[1] - limits[0]).min(TAU);
        let tolerance = levels::ROUNDED_POSITIONS.get() * range;
        Self { limits, tolerance, far: levels::FAR_AWAY.get(), ..Self::default() }
    }

    /// Returns the range from `-limit` to `limit`, for quantities whose magnitude has a limit.
    fn within(limit: f64) -> Self {
        let tolerance = levels::ROUNDED.get() * limit;
        Self { limits: [-limit, limit], tolerance, far: levels::FAR.get(), ..Self::default() }
    }
}

impl Range<'_> {
    /// Returns the excess of values over the limits; `None` if the values are within the limits. A limit of 0 is an entry
    /// that was not filled in, so no value counts as far beyond it.
    fn excess(&self, values: &[f64]) -> Option<Excess> {
        let [low, high] = span(values.iter().copied().filter(|x| x.is_finite()).collect())?;
        let [least, most] = self.limits;
        let leaves = low < least - self.tolerance || high > most + self.tolerance;
        let limit = least.abs().max(most.abs());
        let times = if limit > 0.0 { low.abs().max(high.abs()) / limit } else { 1.0 };
        leaves.then_some(Excess { low, high, times })
    }
}

/// Returns a text that names a column, for example ` (column q1)`; empty if `column` is `None`.
fn in_column(of: &str, column: Option<&String>) -> String {
    column.map_or_else(String::new, |column| format!(" ({of} {column})"))
}

/// Returns the largest unit for which the values are within their limit and use a noticeable part of it; `None` if there is
/// no such unit.
///
/// - `share`: ratio of the values to their limit
fn likely(share: f64, units: &'static [&'static str]) -> Option<&'static str> {
    let fits = |name: &&&str| unit_value(name).is_some_and(|value| is_seen(share * value));
    units.iter().find(fits).copied()
}
