//! Whether runs go so far beyond the described limits that a unit must be another one.

use super::super::log::{Recording, SEEN, are_minutes, unit_value};
use super::super::pose::rows_of;
use super::super::robot::{JointLimits, Robot};
use super::super::run::{Effort, PreparedRun};
use gelenk_findings::digits::plain;
use gelenk_findings::{Finding, Rule};

/// Sees: positions, speeds or efforts of a joint that are several times their described limit.
/// Matters: they are in another unit; nothing is estimated.
/// Example: degrees without a unit in the header.
/// Fixture: `degrees` in `codegen/tests/findings/arm.rs`.
const FAR_BEYOND_LIMITS: Rule = Rule::error("far-beyond-limits");

/// Factor beyond a limit of speed or effort that no right log reaches: the least confusion of units is rpm or a gear.
const FAR_BEYOND: f64 = 3.0;
/// The same for positions, which may be counted from elsewhere.
const FAR_AWAY: f64 = 10.0;
/// Share of values at each end that are outliers.
const OUTLIERS: usize = 200;

/// Units that columns may be in, as `--columns` calls them.
const ANGLES: &[&str] = &["deg", "mrad"];
const LENGTHS: &[&str] = &["cm", "mm", "um"];
const TORQUES: &[&str] = &["Ncm", "mNm"];

/// Values far beyond the limits, with the column, the factor, and the switch that states the likely unit.
///
/// - `prepared`: rows are joints
pub(crate) fn far_beyond(robot: &dyn Robot, recording: &Recording, prepared: &[PreparedRun]) -> Vec<Finding> {
    let runs = Runs { robot, recording, prepared };
    // Positions in another unit have speeds in another unit.
    let motion = runs.positions().or_else(|| runs.speeds());
    motion.into_iter().chain(runs.efforts()).collect()
}

/// The joint that goes farthest.
struct Worst {
    joint: usize,
    largest: f64,
    limit: f64,
    /// How many joints go too far.
    joints: usize,
    /// The run in which alone it does; `None` if it does in several or in the only one.
    run: Option<usize>,
}

struct Runs<'a> {
    robot: &'a dyn Robot,
    recording: &'a Recording,
    prepared: &'a [PreparedRun],
}

impl Runs<'_> {
    /// Limits by joint; none if none are described.
    fn limits(&self) -> impl Fn(usize) -> JointLimits {
        let limits = self.robot.limits();
        move |joint| limits.get(joint).copied().unwrap_or(JointLimits::NONE)
    }

    fn unit(&self, joint: usize) -> &'static str {
        self.robot.position_units().get(joint).copied().unwrap_or("rad")
    }

    /// The joint whose values are farthest beyond their limit, if that is too far.
    fn worst(
        &self,
        most: f64,
        limit: impl Fn(usize) -> f64,
        values: impl Fn(&PreparedRun, usize) -> Vec<f64>,
    ) -> Option<Worst> {
        let exact = rows_of(&self.robot.quaternion_joints(), self.robot.joint_names().len());
        let judged = (0..exact.len()).filter(|joint| !exact[*joint]);
        let judged = judged.filter(|joint| limit(*joint).is_finite() && limit(*joint) > 0.0);
        let far = judged.filter_map(|joint| {
            let all: Vec<Vec<f64>> = self.prepared.iter().map(|run| values(run, joint)).collect();
            let limit = limit(joint);
            let is_far = |run: &usize| largest(all[*run].clone()).is_some_and(|size| size > most * limit);
            let far: Vec<usize> = (0..all.len()).filter(is_far).collect();
            let run = far.first().copied().filter(|_| far.len() == 1 && all.len() > 1);
            let largest = largest(all.concat())?;
            (largest > most * limit).then_some(Worst { joint, largest, limit, joints: 1, run })
        });
        far.reduce(|a, b| {
            let joints = a.joints + b.joints;
            let farther = if b.largest / b.limit > a.largest / a.limit { b } else { a };
            Worst { joints, ..farther }
        })
    }

    fn positions(&self) -> Option<Finding> {
        let limits = self.limits();
        let limit = |joint: usize| {
            let [least, most] = limits(joint).position;
            least.abs().max(most.abs())
        };
        let worst = self.worst(FAR_AWAY, limit, |run, joint| run.positions[joint].clone())?;
        let labels = &self.recording.labels.positions;
        let unit = self.unit(worst.joint);
        let said = self.said(&worst, ("positions", unit), ("column", labels.columns.get(worst.joint)));
        let known = likely(&worst, if unit == "m" { LENGTHS } else { ANGLES });
        let pattern = &labels.pattern;
        let remedy = known.map_or_else(
            || format!("counts have a factor: --columns 'position={pattern}[0.001 {unit}]'"),
            |name| format!("they look like {name}: --columns 'position={pattern}[{name}]'"),
        );
        Some(self.finding(&worst, said, remedy))
    }

    fn speeds(&self) -> Option<Finding> {
        let limits = self.limits();
        let worst =
            self.worst(FAR_BEYOND, |j| limits(j).velocity, |run, joint| run.velocities[joint].clone())?;
        let labels = &self.recording.labels;
        let unit = self.unit(worst.joint);
        let said = self.said(
            &worst,
            ("speeds", &format!("{unit}/s")),
            ("slopes of column", labels.positions.columns.get(worst.joint)),
        );
        let known = likely(&worst, if unit == "m" { LENGTHS } else { ANGLES });
        let positions = known.map(|name| {
            format!("positions are in {name} (--columns 'position={}[{name}]') or ", labels.positions.pattern)
        });
        let times = match are_minutes(worst.largest / worst.limit) {
            true => format!("times are in min (--columns 'time={}[min]')", labels.time),
            false => format!("times are in another unit (--columns 'time={}[UNIT]')", labels.time),
        };
        Some(self.finding(&worst, said, format!("it may be that {}{times}", positions.unwrap_or_default())))
    }

    fn efforts(&self) -> Option<Finding> {
        let limits = self.limits();
        let matrix = self.robot.input_matrix();
        let at_frames = self.robot.has_inputs_at_frames();
        let values = |run: &PreparedRun, joint: usize| match run.effort {
            Effort::Current => Vec::new(),
            Effort::Input if at_frames => Vec::new(),
            _ => (0..run.times.len()).map(|sample| run.force(&matrix, joint, sample)).collect(),
        };
        let worst = self.worst(FAR_BEYOND, |j| limits(j).effort, values)?;
        let is_input = self.recording.effort == Effort::Input;
        let labels = &self.recording.labels.efforts;
        let is_force = self.unit(worst.joint) == "m";
        let unit = if is_force { "N" } else { "N·m" };
        let column = labels.columns.get(worst.joint).filter(|_| !is_input);
        let said = self.said(&worst, ("efforts", unit), ("column", column));
        let (key, pattern) = (if is_input { "input" } else { "torque" }, &labels.pattern);
        let known = likely(&worst, if is_force { &[] } else { TORQUES });
        let known = known.map(|name| format!("they may be in {name}: --columns '{key}={pattern}[{name}]'; "));
        let plain = unit.replace('·', "");
        let remedy = format!(
            "{}counts and percents have a factor, as in --columns '{key}={pattern}[0.05 {plain}]'; currents are --effort current, \
             efforts of the motors --effort input",
            known.unwrap_or_default()
        );
        Some(self.finding(&worst, said, remedy))
    }

    fn finding(&self, worst: &Worst, message: String, remedy: String) -> Finding {
        let found = FAR_BEYOND_LIMITS.found(message).joint(&self.robot.joint_names()[worst.joint]);
        let all = "or correct the description's limits; --accept-poor takes the values as they are";
        found.with("times the limit", worst.largest / worst.limit, "").help(format!("{remedy}; {all}"))
    }

    fn said(
        &self,
        worst: &Worst,
        (what, unit): (&str, &str),
        (of, column): (&str, Option<&String>),
    ) -> String {
        let Worst { largest, limit, joints, run, .. } = *worst;
        let times = largest / limit;
        let [largest, limit] = [largest, limit].map(|x| plain(x, 4));
        let column = column.map_or_else(String::new, |column| format!(" ({of} {column})"));
        let others = match joints - 1 {
            0 => String::new(),
            1 => ", and one more joint goes too far".to_owned(),
            others => format!(", and {others} more joints go too far"),
        };
        let alone = run.map_or_else(String::new, |run| {
            let name = &self.prepared[run].name;
            format!(
                ", in run {name} alone: --columns holds for all logs, bring this one to the others' units"
            )
        });
        format!(
            "its {what}{column} reach {largest} {unit}, {times:.1} times the described limit of {limit}{others}{alone}"
        )
    }
}

/// The largest magnitude without the outermost values.
fn largest(values: Vec<f64>) -> Option<f64> {
    let mut sizes: Vec<f64> = values.into_iter().map(f64::abs).filter(|x| x.is_finite()).collect();
    let last = sizes.len().checked_sub(1)?;
    let place = last - sizes.len() / OUTLIERS;
    Some(*sizes.select_nth_unstable_by(place, f64::total_cmp).1)
}

/// The largest unit in which the values are within their limit, and use a part of it that can be seen.
fn likely(worst: &Worst, units: &'static [&'static str]) -> Option<&'static str> {
    let share = worst.largest / worst.limit;
    let fits = |name: &&&str| unit_value(name).is_some_and(|value| SEEN.contains(&(share * value)));
    units.iter().find(fits).copied()
}
