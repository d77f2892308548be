//! Limits that a planned motion keeps, and assumed limits if the description has none.

use super::super::robot::{JointLimits, Robot};
use super::chart::Chart;
use super::motors::joint_limits;
use super::{ExcitationLimits, PlanSettings};
use std::f64::consts::PI;

/// Limits of the coordinates of the motion. The entries of a rotation vector have limits with which the length of the vector
/// does not exceed the largest rotation.
pub(super) fn usable(robot: &dyn Robot, settings: &PlanSettings, chart: &Chart) -> Vec<ExcitationLimits> {
    let mut halves: Vec<f64> = robot.position_units().iter().map(|unit| half_range(unit, settings)).collect();
    chart.rotations().for_each(|(_, rows)| halves[rows].fill(settings.turn / 3.0_f64.sqrt()));
    let joints = joint_limits(robot).into_iter().zip(halves);
    let limits = joints.map(|(JointLimits { position, velocity, .. }, half)| {
        let [low, high] = if is_bounded(position) { position } else { [-half, half] };
        let speed = if is_limit(velocity) { velocity } else { settings.velocity };
        let (middle, half) = (0.5 * (low + high), 0.5 * settings.position_share * (high - low));
        let velocity = settings.velocity_share * speed;
        let acceleration = settings.acceleration.unwrap_or(2.0 * velocity);
        ExcitationLimits { position: [middle - half, middle + half], velocity, acceleration }
    });
    limits.collect()
}

fn half_range(unit: &str, settings: &PlanSettings) -> f64 {
    if unit == "m" { 0.5 * settings.travel } else { PI }
}

fn is_bounded(position: [f64; 2]) -> bool {
    position.iter().all(|bound| bound.is_finite())
}

fn is_limit(velocity: f64) -> bool {
    velocity.is_finite() && velocity > 0.0
}

pub(super) fn assumptions(robot: &dyn Robot, settings: &PlanSettings, chart: &Chart) -> Vec<String> {
    let (limits, units) = (joint_limits(robot), robot.position_units());
    let (names, turns) = (robot.joint_names(), chart.turns());
    let joints = |unit: &str, lacks: &dyn Fn(usize, &JointLimits) -> bool| {
        let found = (0..names.len()).filter(|i| units[*i] == unit && lacks(*i, &limits[*i]));
        let found: Vec<&str> = found.map(|i| names[i].as_str()).collect();
        (!found.is_empty()).then(|| found.join(", "))
    };
    let ranges = ["rad", "m"].map(|unit| {
        let half = half_range(unit, settings);
        let is_turn = |i: usize| turns[i] && unit == "rad";
        let found = joints(unit, &|i, limits| !is_turn(i) && !is_bounded(limits.position));
        found.map(|names| {
            format!("position limits of ±{half:.2} {unit} are assumed for joints without described limits: {names}")
        })
    });
    let speeds = ["rad", "m"].map(|unit| {
        let found = joints(unit, &|_, limits| !is_limit(limits.velocity));
        found.map(|names| {
            format!(
                "a speed limit of {} {unit}/s is assumed for joints without a described limit: {names}",
                settings.velocity
            )
        })
    });
    let turning: Vec<&str> = chart.rotations().map(|(name, _)| name).collect();
    let turn = (!turning.is_empty()).then(|| {
        format!(
            "these joints have no position limits, so they rotate by up to {:.2} rad from the quaternion 0, 0, 0, 1: {}",
            settings.position_share * settings.turn,
            turning.join(", ")
        )
    });
    ranges.into_iter().chain(speeds).chain([turn]).flatten().collect()
}
