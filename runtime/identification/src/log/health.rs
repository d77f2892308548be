//! Checks of the runs of a log: columns that are not velocities, efforts on the other side of a gear, full turns.

use super::super::numeric::statistics::span;
use super::super::robot::Robot;
use super::super::run::{Effort, Run};
use super::finding::{GEAR_DOUBTFUL, TURNS, VELOCITY_DISAGREES};
use super::levels;
use gelenk_findings::Finding;
use gelenk_findings::digits::plain;
use std::f64::consts::{PI, TAU};

/// Findings about all joints, from all runs together.
pub(super) fn findings(runs: &[Run], robot: &dyn Robot) -> Vec<Finding> {
    let (names, units) = (robot.joint_names(), robot.position_units());
    let unit = |joint: usize| units.get(joint).copied().unwrap_or("rad");
    let moving = (0..names.len()).filter(|joint| !stands_still(runs, *joint, unit(*joint)));
    let disagree = moving.filter_map(|joint| {
        velocity(runs, joint).map(|message| VELOCITY_DISAGREES.found(message).joint(&names[joint]))
    });
    disagree.chain(gears(runs, robot)).collect()
}

/// Travel below which a joint is at rest [rad or m].
fn least_travel(unit: &str) -> f64 {
    if unit == "m" { 0.1 * levels::TRAVEL.get() } else { levels::TRAVEL.get() }
}

/// Whether a joint is at rest in all runs, without outliers.
fn stands_still(runs: &[Run], joint: usize, unit: &str) -> bool {
    let travel = |run: &Run| span(run.positions[joint].clone()).map_or(0.0, |[low, high]| high - low);
    runs.iter().all(|run| travel(run) < least_travel(unit))
}

/// Units in which a column of velocities may be instead of rad/s or m/s: factors and names.
const UNITS: [(f64, &str); 5] = [
    (PI / 180.0, "deg/s"),
    (PI / 30.0, "rpm"),
    (TAU, "rev/s"),
    (1e-3, "thousandths (mm/s, mrad/s), or a time that is in ms"),
    (1e3, "thousands, or a time that is in s"),
];

/// Message about a column of velocities that differs from the slope of the positions; `None` if it agrees. They are compared
/// by windows of a few samples.
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
    if correlation.abs() < levels::RELATED.get() {
        return Some(format!(
            "its column of velocities is hardly related to its positions (correlation {correlation:.2}): is it another \
             joint's, or a commanded one?"
        ));
    }
    let size = ratio.abs();
    if ratio > 0.0 && (size - 1.0).abs() < levels::SAME_VELOCITY.get() {
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
    let window = levels::VELOCITY_WINDOW.get();
    let (t, q) = (&run.times, &run.positions[joint]);
    let ends = (window..t.len()).step_by(window);
    ends.map(move |end| {
        let start = end - window;
        let trapezoid = |i: usize| 0.5 * (v[i] + v[i - 1]) * (t[i] - t[i - 1]);
        (q[end] - q[start], (start + 1..=end).map(trapezoid).sum())
    })
}

/// The finding that efforts at the joints seem to be those of the motors, or the other way round. It is decided at the joint
/// that carries the largest weight, if there is a gear between motor and joint.
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
    // The limit is half of the gear's logarithm. Friction and motion change the effort by less.
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

/// Removes jumps by a full turn, as of an encoder that counts one turn only, or that was reset. Returns findings about the
/// jumps.
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

/// Adds or subtracts 2π after each jump by 2π (within 0.5 rad) from the last value. Returns the indices of the jumps.
///
/// No joint turns by 5.8 rad between two samples, so no other motion is mistaken for a full turn.
fn take_out_turns(values: &mut [f64]) -> Vec<usize> {
    let (mut offset, mut last, mut turns) = (0.0, f64::NAN, Vec::new());
    for (i, value) in values.iter_mut().enumerate().filter(|(_, value)| value.is_finite()) {
        let jump = *value + offset - last;
        if (jump.abs() - TAU).abs() < levels::TURN.get() {
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
