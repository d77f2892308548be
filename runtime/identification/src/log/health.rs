//! Checks of a log by its runs: joints that stood still, limits, units, columns that are not velocities.

use super::super::pose::rows_of;
use super::super::robot::{FollowerLimits, JointLimits, Robot};
use super::super::run::{Effort, Run};
use super::finding::{
    BEYOND_EFFORT, BEYOND_POSITION, BEYOND_SPEED, GEAR_DOUBTFUL, TURNS, VELOCITY_DISAGREES,
};
use super::units::are_minutes;
use gelenk_findings::digits::plain;
use gelenk_findings::{Finding, Rule};
use std::f64::consts::{PI, TAU};

/// Findings of all joints, pooled over the runs.
pub(super) fn findings(runs: &[Run], robot: &dyn Robot) -> Vec<Finding> {
    let (names, units, limits) = (robot.joint_names(), robot.position_units(), robot.limits());
    let mut findings = Vec::new();
    for (joint, name) in names.iter().enumerate() {
        let unit = units.get(joint).copied().unwrap_or("rad");
        let limits = limits.get(joint).copied().unwrap_or(JointLimits::NONE);
        let mut say = |rule: Rule, message: String| findings.push(rule.found(message).joint(name));
        if stands_still(runs, joint, unit) {
            continue;
        }
        positions(runs, joint, unit, limits).into_iter().for_each(|m| say(BEYOND_POSITION, m));
        speeds(runs, joint, unit, limits).into_iter().for_each(|m| say(BEYOND_SPEED, m));
        velocity(runs, joint).into_iter().for_each(|m| say(VELOCITY_DISAGREES, m));
    }
    findings.extend(robot.followers().iter().flat_map(|joint| beyond_limits(runs, joint)));
    findings.extend(efforts(runs, robot, &limits));
    findings.extend(gears(runs, robot));
    findings
}

/// A joint that moves by less than this stands still [rad or m].
fn least_travel(unit: &str) -> f64 {
    if unit == "m" { 2e-4 } else { 2e-3 }
}

/// Smallest and largest value without the outermost 0.5 % at both ends: single outliers do not count as motion.
fn span(values: &mut [f64]) -> Option<(f64, f64)> {
    let last = values.len().checked_sub(1)?;
    let cut = values.len() / 200;
    let low = *values.select_nth_unstable_by(cut, f64::total_cmp).1;
    let high = *values.select_nth_unstable_by(last - cut, f64::total_cmp).1;
    Some((low, high))
}

fn pooled(runs: &[Run], column: impl Fn(&Run) -> Option<&Vec<f64>>) -> Vec<f64> {
    runs.iter().filter_map(column).flatten().copied().collect()
}

fn stands_still(runs: &[Run], joint: usize, unit: &str) -> bool {
    let travel = |run: &Run| span(&mut run.positions[joint].clone()).map_or(0.0, |(low, high)| high - low);
    runs.iter().all(|run| travel(run) < least_travel(unit))
}

fn positions(runs: &[Run], joint: usize, unit: &str, limits: JointLimits) -> Option<String> {
    let (low, high) = span(&mut pooled(runs, |r| r.positions.get(joint)))?;
    let [least, most] = limits.position;
    let tolerance = 0.01 * (most - least).min(TAU) + least_travel(unit);
    if low >= least - tolerance && high <= most + tolerance {
        return None;
    }
    let inside = |factor: f64| low * factor >= least - tolerance && high * factor <= most + tolerance;
    let remedy = looks_like(unit, "position", inside);
    let [low, high, least, most] = [low, high, least, most].map(|x| plain(x, 4));
    Some(format!("its positions go from {low} to {high} {unit}, its limits are {least} and {most}{remedy}"))
}

/// Findings of a joint that follows others: where these take it beyond its limits.
fn beyond_limits(runs: &[Run], joint: &FollowerLimits) -> Vec<Finding> {
    let say = |rule: Rule, message: String| rule.found(message).joint(&joint.name);
    let mut positions: Vec<f64> =
        runs.iter().flat_map(|run| sums(joint, &run.positions, joint.offset)).collect();
    let of_speeds = |run: &Run| {
        let columns: Vec<Vec<f64>> = (0..run.positions.len()).map(|i| slopes(run, i)).collect();
        sums(joint, &columns, 0.0)
    };
    let mut speeds: Vec<f64> = runs.iter().flat_map(of_speeds).map(f64::abs).collect();
    let [least, most] = joint.position;
    let tolerance = 0.01 * (most - least).min(TAU) + least_travel("rad");
    let beyond =
        span(&mut positions).filter(|(low, high)| *low < least - tolerance || *high > most + tolerance);
    let position = beyond.map(|(low, high)| {
        let [low, high, least, most] = [low, high, least, most].map(|x| plain(x, 4));
        let message = format!(
            "the joints that it follows take it from {low} to {high}, its limits are {least} and {most}"
        );
        say(BEYOND_POSITION, message)
    });
    let fast = span(&mut speeds).filter(|(_, fastest)| *fastest > 1.1 * joint.velocity);
    let speed = fast.map(|(_, fastest)| {
        let message = format!(
            "the joints that it follows move it by up to {} in a second, its limit is {}",
            plain(fastest, 4),
            plain(joint.velocity, 4)
        );
        say(BEYOND_SPEED, message)
    });
    position.into_iter().chain(speed).collect()
}

/// Values of a joint that follows others, by columns of theirs.
fn sums(joint: &FollowerLimits, columns: &[Vec<f64>], offset: f64) -> Vec<f64> {
    let count = columns.iter().map(Vec::len).min().unwrap_or(0);
    let at = |k: usize| columns.iter().map(move |column| column[k]);
    (0..count).map(|k| joint.sum(at(k), offset)).collect()
}

/// Whether another unit would mend it.
fn looks_like(unit: &str, key: &str, inside: impl Fn(f64) -> bool) -> String {
    let candidates: [(&str, f64); 2] =
        if unit == "m" { [("mm", 1e-3), ("cm", 1e-2)] } else { [("deg", PI / 180.0), ("rev", TAU)] };
    let better = candidates.iter().filter(|(_, factor)| *factor < 1.0).find(|(_, factor)| inside(*factor));
    better
        .map_or(String::new(), |(name, _)| format!("; they would fit in {name}: --columns '{key}=…[{name}]'"))
}

/// Speeds over a few samples at a time, which noise and coarse encoders disturb less than single steps.
fn slopes(run: &Run, joint: usize) -> Vec<f64> {
    let (t, q) = (&run.times, &run.positions[joint]);
    let stride = 10.min(t.len().saturating_sub(1)).max(1);
    (stride..t.len()).map(|i| (q[i] - q[i - stride]) / (t[i] - t[i - stride])).collect()
}

fn speeds(runs: &[Run], joint: usize, unit: &str, limits: JointLimits) -> Option<String> {
    let mut speeds: Vec<f64> = runs.iter().flat_map(|r| slopes(r, joint)).map(f64::abs).collect();
    let (_, fastest) = span(&mut speeds)?;
    let limit = limits.velocity;
    if !limit.is_finite() || fastest <= 1.1 * limit {
        return None;
    }
    let minutes =
        if are_minutes(fastest / limit) { "; times would fit in min: --columns 'time=…[min]'" } else { "" };
    Some(format!(
        "it moves by up to {} {unit}/s, {:.1} times its limit of {}{}{minutes}",
        plain(fastest, 4),
        fastest / limit,
        plain(limit, 4),
        looks_like(unit, "position", |factor| fastest * factor <= 1.1 * limit)
    ))
}

/// Factors between units of velocities, and their names: unit of a column where rad/s or m/s are expected.
const UNITS: [(f64, &str); 5] = [
    (PI / 180.0, "deg/s"),
    (PI / 30.0, "rpm"),
    (TAU, "rev/s"),
    (1e-3, "thousandths (mm/s, mrad/s), or a time that is in ms"),
    (1e3, "thousands, or a time that is in s"),
];

/// A column of velocities against the slope of the positions, by windows of a few samples.
fn velocity(runs: &[Run], joint: usize) -> Option<String> {
    let (mut qq, mut qv, mut vv) = (0.0, 0.0, 0.0);
    for run in runs {
        let Some(v) = run.velocities.get(joint)?.as_ref() else { continue };
        for (travel, integral) in travels(run, joint, v) {
            qq += travel * travel;
            qv += travel * integral;
            vv += integral * integral;
        }
    }
    if runs.iter().all(|r| r.velocities[joint].is_none()) || qq <= 0.0 {
        return None;
    }
    if vv <= 0.0 {
        return Some("its column of velocities is zero while it moves; the column is not needed".into());
    }
    let correlation = qv / (qq * vv).sqrt();
    let ratio = qv / vv;
    if correlation.abs() < 0.8 {
        return Some(format!(
            "its column of velocities is hardly related to its positions (correlation {correlation:.2}): is it another \
             joint's, or a commanded one?"
        ));
    }
    let size = ratio.abs();
    if ratio > 0.0 && (size - 1.0).abs() < 0.15 {
        return None;
    }
    let sign = if ratio < 0.0 { "the opposite sign of" } else { "another scale than" };
    let unit = UNITS.iter().find(|(factor, _)| (size / factor - 1.0).abs() < 0.1);
    let guess = unit.map_or(String::new(), |(_, name)| format!("; velocities in {name} would explain it"));
    Some(format!(
        "its column of velocities has {sign} the slope of its positions: the slope is {} times the column{guess}",
        plain(ratio, 4)
    ))
}

/// Change of the position and integral of the velocity over windows.
fn travels<'a>(run: &'a Run, joint: usize, v: &'a [f64]) -> impl Iterator<Item = (f64, f64)> + 'a {
    const WINDOW: usize = 10;
    let (t, q) = (&run.times, &run.positions[joint]);
    let ends = (WINDOW..t.len()).step_by(WINDOW);
    ends.map(move |end| {
        let start = end - WINDOW;
        let trapezoid = |i: usize| 0.5 * (v[i] + v[i - 1]) * (t[i] - t[i - 1]);
        (q[end] - q[start], (start + 1..=end).map(trapezoid).sum())
    })
}

fn efforts(runs: &[Run], robot: &dyn Robot, limits: &[JointLimits]) -> Vec<Finding> {
    if runs.first().is_none_or(|run| run.effort != Effort::Joint) {
        return Vec::new();
    }
    let names = robot.joint_names();
    let exact = rows_of(&robot.quaternion_joints(), names.len());
    let unmeasured = robot.unmeasured();
    let is_exact = |i: usize| exact[i] || unmeasured[i];
    let mut findings = Vec::new();
    for (i, name) in names.iter().enumerate().filter(|(i, _)| !is_exact(*i)) {
        let mut values = pooled(runs, |r| r.efforts.get(i));
        let limit = limits.get(i).map_or(f64::INFINITY, |l| l.effort);
        let beyond = span(&mut values).filter(|(low, high)| high.max(-low) > 1.05 * limit);
        findings.extend(beyond.map(|(low, high)| {
            let [low, high, limit] = [low, high, limit].map(|x| plain(x, 4));
            let message = format!(
                "its effort goes from {low} to {high}, its limit is {limit}: another unit (--columns 'torque=…[UNIT]'), or not at the \
                 joint (--effort)?"
            );
            BEYOND_EFFORT.found(message).joint(name)
        }));
    }
    findings
}

/// Whether efforts at the joints were taken for those of the motors, or the other way round: where a gear stands
/// between them, the joint that carries the largest weight shows it.
fn gears(runs: &[Run], robot: &dyn Robot) -> Option<Finding> {
    let (n, m, matrix) = (robot.joint_names().len(), robot.input_names().len(), robot.input_matrix());
    let effort = runs.first()?.effort;
    if n != m || effort == Effort::Current || !robot.quaternion_joints().is_empty() {
        return None;
    }
    let weights = weights(runs, robot, n);
    let joint = (0..n).max_by(|a, b| weights[*a].total_cmp(&weights[*b]))?;
    let (weight, gear) = (weights[joint], matrix.get(joint * m + joint)?.abs());
    let recorded = root_mean_square(runs.iter().filter_map(|r| r.efforts.get(joint)).flatten().copied());
    if !(weight > 0.0 && recorded > 0.0 && (gear > 4.0 || gear < 0.25 && gear > 0.0)) {
        return None;
    }
    let ratio = if effort == Effort::Input { recorded * gear / weight } else { recorded / weight };
    // Half of the gear, in logarithms: friction and motion change the effort by less than that.
    let is_doubtful = match effort {
        Effort::Input => ratio.ln() / gear.ln() > 0.5,
        _ => -ratio.ln() / gear.ln() > 0.5,
    };
    let (taken, other, key) = match effort {
        Effort::Input => ("efforts of the motors", "forces at the joints", "torque"),
        _ => ("forces at the joints", "efforts of the motors", "input"),
    };
    is_doubtful.then(|| {
        let message = format!(
            "its efforts are taken as {taken} and are then {} times the forces that carry the described weight (rms), with \
             {} between motor and joint: they look like {other} (--columns '{key}=…')",
            plain(ratio, 3),
            plain(gear, 6)
        );
        GEAR_DOUBTFUL.found(message).joint(robot.joint_names().swap_remove(joint))
    })
}

/// Root mean squares of the forces that hold the described robot, over some of the samples.
fn weights(runs: &[Run], robot: &dyn Robot, n: usize) -> Vec<f64> {
    const SAMPLES: usize = 20;
    let zero = vec![0.0; n];
    let mut forces = vec![vec![]; n];
    for run in runs.iter().step_by((runs.len() / SAMPLES).max(1)) {
        for i in (0..run.times.len()).step_by((run.times.len() / SAMPLES).max(1)) {
            let y: Vec<f64> = run.positions.iter().map(|q| q[i]).collect();
            let mut force = zero.clone();
            robot.rigid_forces(&y, &zero, &zero, &mut force);
            forces.iter_mut().zip(force).for_each(|(column, f)| column.push(f));
        }
    }
    forces.into_iter().map(|column| root_mean_square(column.into_iter())).collect()
}

fn root_mean_square(values: impl Iterator<Item = f64>) -> f64 {
    let (count, sum) =
        values.filter(|v| v.is_finite()).fold((0.0, 0.0), |(n, sum), v| (n + 1.0, sum + v * v));
    if count > 0.0 { f64::sqrt(sum / count) } else { 0.0 }
}

/// Undoes jumps by a turn: an encoder that counts one turn only, or one that was set anew.
pub(super) fn unwrap_turns(run: &mut Run, robot: &dyn Robot, source: &str) -> Vec<Finding> {
    let (names, units) = (robot.joint_names(), robot.position_units());
    let mut findings = Vec::new();
    for (joint, q) in run.positions.iter_mut().enumerate() {
        if units.get(joint).is_none_or(|unit| *unit != "rad") {
            continue;
        }
        let jumps = take_out_turns(q);
        let (Some(first), Some(last)) = (jumps.first(), jumps.last()) else { continue };
        let rows = Some((run.rows[*first], run.rows[*last]));
        let message = format!("its position jumps by a turn {} times and is unwrapped", jumps.len());
        findings.push(TURNS.found(message).joint(&names[joint]).log(source, rows));
    }
    findings
}

/// Adds or subtracts 2π after each jump by 2π (within 0.5 rad) from the last value; returns the rows of the jumps.
///
/// No joint turns by 5.8 rad between two samples, so nothing else is mistaken for a turn.
fn take_out_turns(values: &mut [f64]) -> Vec<usize> {
    let (mut offset, mut last, mut turns) = (0.0, f64::NAN, Vec::new());
    for (i, value) in values.iter_mut().enumerate().filter(|(_, value)| value.is_finite()) {
        let jump = *value + offset - last;
        if (jump.abs() - TAU).abs() < 0.5 {
            offset -= TAU * jump.signum();
            turns.push(i);
        }
        *value += offset;
        last = *value;
    }
    turns
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An encoder whose zero lies off the middle, with a missing value where it jumps.
    #[test]
    fn turns_are_taken_out_over_missing_values() {
        let truth: Vec<f64> = (0..1000).map(|i| 0.02 * f64::from(i) - 0.5).collect();
        let mut values: Vec<f64> = truth.iter().map(|q| (q + 3.64).rem_euclid(TAU) - 3.64).collect();
        let jumps: Vec<usize> = (1..1000).filter(|i| values[*i] < values[*i - 1]).collect();
        values[jumps[1]] = f64::NAN;
        assert_eq!(take_out_turns(&mut values), [jumps[0], jumps[1] + 1, jumps[2]]);
        for (i, value) in values.iter().enumerate().filter(|(i, _)| *i != jumps[1]) {
            assert!((value - truth[i]).abs() < 1e-12, "{i}");
        }
        // The joint moved while the log paused.
        let mut paused = [-2.6, -2.59, 2.6, 2.59];
        assert!(take_out_turns(&mut paused).is_empty() && paused[2] == 2.6);
    }
}
