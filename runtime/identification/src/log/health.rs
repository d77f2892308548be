//! Checks of a log by its runs: joints that stood still, limits, units, columns that are not velocities.

use super::super::numeric::digits::plain;
use super::super::pose::rows_of;
use super::super::robot::{FollowerLimits, JointLimits, Robot};
use super::super::run::{Effort, Run};
use super::finding::{BEYOND_EFFORT, BEYOND_POSITION, BEYOND_SPEED, TURNS, VELOCITY_DISAGREES};
use super::units::are_minutes;
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

/// Factors between units of velocities, and their names: what a column is in where rad/s or m/s are expected.
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

/// Undoes jumps by a turn: the encoder counts one turn only.
pub(super) fn unwrap_turns(run: &mut Run, robot: &dyn Robot, source: &str) -> Vec<Finding> {
    let (names, units) = (robot.joint_names(), robot.position_units());
    let mut findings = Vec::new();
    for (joint, q) in run.positions.iter_mut().enumerate() {
        let is_angle = units.get(joint).is_some_and(|u| *u == "rad");
        let jumps: Vec<usize> = (1..q.len()).filter(|i| is_turn(q[*i] - q[*i - 1])).collect();
        let (Some(first), Some(last)) = (jumps.first(), jumps.last()) else { continue };
        if !is_angle || !in_one_turn(q) {
            continue;
        }
        unwrap(q, TAU);
        let rows = Some((run.rows[*first], run.rows[*last]));
        let message = format!("its position jumps by a turn {} times and is unwrapped", jumps.len());
        findings.push(TURNS.found(message).joint(&names[joint]).log(source, rows));
    }
    findings
}

fn is_turn(jump: f64) -> bool {
    (jump.abs() / TAU - 1.0).abs() < 0.2
}

fn in_one_turn(q: &[f64]) -> bool {
    let (low, high) =
        q.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), q| (low.min(*q), high.max(*q)));
    high - low <= 1.01 * TAU && low >= -1.01 * PI && high <= 1.01 * TAU
}

/// Undoes overflows of a counter: a step of more than half a period is taken as the shorter way around.
fn unwrap(values: &mut [f64], period: f64) {
    let (mut turns, mut last) = (0.0, f64::NAN);
    for value in values {
        let raw = *value;
        if last.is_finite() && raw.is_finite() {
            turns -= ((raw - last) / period).round();
        }
        if raw.is_finite() {
            last = raw;
        }
        *value = raw + turns * period;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counters_unwrap_over_missing_values() {
        let mut values: Vec<f64> = (0..100).map(|i| f64::from(i * 7 % 256)).collect();
        values[37] = f64::NAN;
        unwrap(&mut values, 256.0);
        for (i, v) in values.iter().enumerate().filter(|(i, _)| *i != 37) {
            assert_eq!(*v, 7.0 * i as f64);
        }
    }
}
