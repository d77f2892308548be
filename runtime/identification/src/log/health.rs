//! Checks of the runs of a log: velocities that do not fit the positions, and jumps of positions by full turns.

use super::super::numeric::statistics::span;
use super::super::robot::Robot;
use super::super::run::Run;
use super::levels;
use gelenk_findings::digits::plain;
use gelenk_findings::{Finding, Rule};
use std::f64::consts::{PI, TAU};

/// Sees: jumps of a position by a whole turn.
/// Matters: such jumps are not motion. They are removed.
/// Example: an encoder that counts from -π to π.
/// Fixture: `turns_are_unwrapped` in `log/tests/styles.rs`.
const TURNS: Rule = Rule::note("turns");

/// Sees: a column of velocities that is not the derivative of the positions.
/// Matters: a sign, a unit or the order of columns may be wrong. The velocities themselves are not used.
/// Example: velocities in deg/s next to positions in rad.
/// Fixture: `joints_that_look_wrong_are_named` in `log/tests/styles.rs`.
const VELOCITY_DISAGREES: Rule = Rule::note("velocity-disagrees");

/// Returns findings about the joints. Each finding is based on all runs together.
pub(super) fn findings(runs: &[Run], robot: &dyn Robot) -> Vec<Finding> {
    let (names, units) = (robot.joint_names(), robot.position_units());
    let unit = |joint: usize| units.get(joint).copied().unwrap_or("rad");
    let moving = (0..names.len()).filter(|joint| !stands_still(runs, *joint, unit(*joint)));
    let disagrees =
        |joint: usize| Some(VELOCITY_DISAGREES.found(velocity(runs, joint)?).joint(&names[joint]));
    moving.filter_map(disagrees).collect()
}

/// Returns whether a joint rests in all runs, if outliers are not counted.
fn stands_still(runs: &[Run], joint: usize, unit: &str) -> bool {
    let least = if unit == "m" { 0.1 * levels::TRAVEL.get() } else { levels::TRAVEL.get() };
    let travel = |run: &Run| span(run.positions[joint].clone()).map_or(0.0, |[low, high]| high - low);
    runs.iter().all(|run| travel(run) < least)
}

/// Explanations for a column of velocities whose scale differs from rad/s or m/s: factors, and texts for the message.
const UNITS: [(f64, &str); 5] = [
    (PI / 180.0, "deg/s"),
    (PI / 30.0, "rpm"),
    (TAU, "rev/s"),
    (1e-3, "mm/s or mrad/s, or times in ms that were read as s,"),
    (1e3, "km/s or krad/s, or times in s that were read as ms,"),
];

/// Returns the message about a column of velocities that differs from the derivative of the positions; `None` if they
/// agree. Windows of a few samples are compared.
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
        return Some(
            "its column of velocities is zero although the joint moves. The column is not needed".into(),
        );
    }
    let correlation = qv / (qq * vv).sqrt();
    let ratio = qv / vv;
    if correlation.abs() < levels::RELATED.get() {
        return Some(format!(
            "its column of velocities does not match the derivative of its positions (correlation {correlation:.2}). Check \
             whether the column belongs to another joint or has commanded values"
        ));
    }
    let size = ratio.abs();
    if ratio > 0.0 && (size - 1.0).abs() < levels::SAME_VELOCITY.get() {
        return None;
    }
    let sign = if ratio < 0.0 { "the opposite sign of" } else { "a different scale from" };
    let unit = UNITS.iter().find(|(factor, _)| (size / factor - 1.0).abs() < 0.1);
    let guess = unit.map_or(String::new(), |(_, name)| format!(". Velocities in {name} would explain it"));
    Some(format!(
        "its column of velocities has {sign} the derivative of its positions. The derivative is {} times the column{guess}",
        plain(ratio, 4)
    ))
}

/// Returns the change of the position and the integral of the velocity for each window.
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

/// Removes jumps of positions by a full turn. For example, an encoder jumps if it counts only one turn, or if it is reset.
/// Returns findings about the jumps.
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
        let message = match jumps.len() {
            1 => "its position jumps by a full turn once. The jump is removed".to_owned(),
            count => format!("its position jumps by a full turn {count} times. The jumps are removed"),
        };
        findings.push(TURNS.found(message).joint(&names[joint]).log(source, rows));
    }
    findings
}

/// Removes jumps by a full turn: after each jump by ±2π (within 0.5 rad), 2π is subtracted or added. Returns the indices of
/// the jumps.
///
/// No joint moves by 5.8 rad between two samples, so no real motion is mistaken for a jump by a full turn.
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

    /// The encoder's zero is not in the middle of its range, and a value is missing at a jump.
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
