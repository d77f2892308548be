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
/// Matters: they may be in another unit, another joint's, or on the other side of a gear.
/// Example: a lift that goes to 2.3 rad where 2 rad are described.
/// Fixture: `joints_that_look_wrong_are_named` in `log/tests/styles.rs`.
const BEYOND: Rule = Rule::note("beyond-limits");

/// Sees: positions, speeds or efforts of a joint that are several times their described limit.
/// Matters: they are in another unit; nothing is estimated.
/// Example: degrees without a unit in the header.
/// Fixture: `degrees` in `codegen/tests/findings/arm.rs`.
const FAR_BEYOND: Rule = Rule::error("far-beyond-limits");

/// Units in which columns may be recorded, with the names that `--columns` takes.
const ANGLES: &[&str] = &["deg", "mrad"];
const LENGTHS: &[&str] = &["cm", "mm", "um"];
const TORQUES: &[&str] = &["Ncm", "mNm"];

/// Findings about values beyond their limits: for each quantity the joint that exceeds its limits most, with the column and
/// the switch for the likely unit. Values far beyond the limits are errors.
///
/// - `prepared`: runs with one column for each joint
pub(crate) fn beyond(robot: &dyn Robot, recording: &Recording, prepared: &[PreparedRun]) -> Vec<Finding> {
    let names = robot.joint_names();
    let exact = rows_of(&robot.quaternion_joints(), names.len());
    let joints = (0..names.len()).filter(|joint| !exact[*joint]).collect();
    let log = Log { robot, recording, prepared, joints, names, limits: robot.limits() };
    let positions = log.positions();
    // If positions are in another unit, the speeds are, too.
    let is_far = positions.as_ref().is_some_and(|finding| finding.severity == Severity::Error);
    let speeds = if is_far { None } else { log.speeds() };
    let own = [positions, speeds, log.efforts()].into_iter().flatten();
    own.chain(robot.followers().iter().flat_map(|joint| log.follower(joint))).collect()
}

/// Values of a joint and their limits.
#[derive(Default)]
struct Range<'a> {
    joint: &'a str,
    /// Values of each run.
    values: Vec<Vec<f64>>,
    /// The quantity and the column of its values.
    what: String,
    unit: String,
    limits: [f64; 2],
    /// Amount by which values may exceed a limit without a finding.
    tolerance: f64,
    /// Factor beyond a limit from which the finding is an error.
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
                format!("they look like {name}: --columns 'position={}'", self.with_units(labels, &units))
            });
            known.or_else(|| {
                let counts =
                    format!("counts have a factor: --columns 'position={}[0.001 {unit}]'", labels.pattern);
                Some(counts).filter(|_| times > levels::FAR_AWAY.get())
            })
        })
    }

    /// The columns of the joints in the form that `--columns` takes, with units; as a list if units differ.
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
            let positions =
                known.map(|name| format!("positions are in {name} (--columns 'position={pattern}[{name}]')"));
            let time = |unit: &str| format!("(--columns 'time={}[{unit}]')", labels.time);
            let times = match are_minutes(times) {
                true => Some(format!("times are in min {}", time("min"))),
                false => Some(format!("times are in another unit {}", time("UNIT")))
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
            let known = known.map(|name| format!("they may be in {name}: --columns '{key}={pattern}[{name}]'; "));
            Some(format!(
                "{}counts and percents have a factor, as in --columns '{key}={pattern}[0.05 {}]'; currents are --effort current, \
                 efforts of the motors --effort input",
                known.unwrap_or_default(),
                unit.replace('·', "")
            ))
        })
    }

    /// Findings about a joint that follows other joints. Its values are computed from those joints.
    fn follower(&self, joint: &FollowerLimits) -> Vec<Finding> {
        let values = |columns: &[Vec<f64>], offset: f64| -> Vec<f64> {
            let count = columns.first().map_or(0, Vec::len);
            (0..count).map(|k| joint.sum(columns.iter().map(|column| column[k]), offset)).collect()
        };
        let range = |what: &str, values: Vec<Vec<f64>>, of: Range<'static>| Range {
            joint: &joint.name,
            values,
            what: format!("{what} (by the joints that it follows)"),
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

    /// The finding about the joint that exceeds its limits most; `None` if no joint exceeds its limits.
    ///
    /// - `help`: gives a remedy from the factor by which the limit is exceeded and the unit
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
            _ => format!("; those of {} exceed theirs, too", others.join(", ")),
        };
        let [least, most] = range.limits;
        let [low, high, least, most] = [*low, *high, least, most].map(|x| plain(x, 4));
        let unit = if range.unit.is_empty() { String::new() } else { format!(" {}", range.unit) };
        let message = format!(
            "its {} go from {low} to {high}{unit}{}; the described limits are {least} and {most}{others}",
            range.what,
            run.map_or_else(String::new, |run| format!(", in run {} alone", self.prepared[*run].name))
        );
        let rule = if is_far { FAR_BEYOND } else { BEYOND };
        let found = rule.found(message).joint(range.joint).with("times the limit", *times, "");
        // A switch for one run would change the other runs, too.
        let alone = run.map(|_| "--columns holds for all logs: bring this one to the units of the others");
        let accept = "or correct the description's limits; --accept-poor takes the values as they are";
        let remedy = help(*times, &range.unit).into_iter().chain(alone.filter(|_| is_far).map(str::to_owned));
        let remedy = remedy.chain(is_far.then(|| accept.to_owned())).collect::<Vec<_>>().join("; ");
        Some(if remedy.is_empty() { found } else { found.help(remedy) })
    }
}

/// The least and the largest value without outliers, if they are beyond limits, and their ratio to the larger limit.
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

    /// The range of values with magnitudes up to a limit.
    fn within(limit: f64) -> Self {
        let tolerance = levels::ROUNDED.get() * limit;
        Self { limits: [-limit, limit], tolerance, far: levels::FAR.get(), ..Self::default() }
    }
}

impl Range<'_> {
    /// Excess of values over the limits; `None` if they are within the limits. A limit of 0 is an entry that was not filled
    /// in, so that no value is far beyond it.
    fn excess(&self, values: &[f64]) -> Option<Excess> {
        let [low, high] = span(values.iter().copied().filter(|x| x.is_finite()).collect())?;
        let [least, most] = self.limits;
        let leaves = low < least - self.tolerance || high > most + self.tolerance;
        let limit = least.abs().max(most.abs());
        let times = if limit > 0.0 { low.abs().max(high.abs()) / limit } else { 1.0 };
        leaves.then_some(Excess { low, high, times })
    }
}

/// Text that names a column: ` (column q1)`.
fn in_column(of: &str, column: Option<&String>) -> String {
    column.map_or_else(String::new, |column| format!(" ({of} {column})"))
}

/// The largest unit with which values are within their limit and use a noticeable part of it; `None` if there is none.
///
/// - `share`: ratio of the values to their limit
fn likely(share: f64, units: &'static [&'static str]) -> Option<&'static str> {
    let fits = |name: &&&str| unit_value(name).is_some_and(|value| is_seen(share * value));
    units.iter().find(fits).copied()
}
