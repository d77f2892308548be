//! Do the force laws of a joint have finite values, and does its friction brake?
//!
//! Both are looked at on a grid: positions within the joint's limits, speeds up to its limit, at the described values of free
//! parameters.

use super::super::JointKind;
use super::super::description::JointDescription;
use crate::diagnostic::Report;
use crate::formula::Formula;

/// Largest speed [rad/s or m/s] looked at where a joint has no limit.
const SPEED: f64 = 10.0;
/// Speeds in each direction. They are spaced by equal factors, since laws are steep near standstill.
const SPEEDS: i32 = 61;
/// Ratio of neighbours: 10^(−1/15), so that the smallest is 1e-4 of the largest.
const FACTOR: f64 = 0.857_695_898_590_894_1;
/// Positions looked at, both limits included.
const POSITIONS: i32 = 21;
/// Friction below this part of the largest does not count: it is rounding.
const ROUNDING: f64 = 1e-9;

/// Reports laws without a finite value, and friction that drives.
pub(super) fn check(joint: &JointDescription, defaults: &[f64], report: &mut Report) {
    let law = Law { joint, defaults };
    if let Some(springs) = &joint.springs {
        let force = |y, v| {
            springs
                .value
                .iter()
                .map(|spring| law.value(spring, y, v))
                .sum()
        };
        if let Some(at) = law.first_not_finite(&force) {
            let message = law.not_finite("spring", &force, at);
            report.error(springs.span, "force-not-finite", message);
            report.help(NOT_FINITE);
        }
    }
    let Some(friction) = &joint.friction else {
        return;
    };
    let torque = |y, v| {
        let terms = friction.value.iter();
        let term = |coefficient, basis| law.value(coefficient, y, v) * law.value(basis, y, v);
        terms.map(|each| term(&each.coefficient, &each.basis)).sum()
    };
    if let Some(at) = law.first_not_finite(&torque) {
        let message = law.not_finite("friction", &torque, at);
        report.error(friction.span, "force-not-finite", message);
        report.help(NOT_FINITE);
        return;
    }
    match law.driving(&torque) {
        Driving::Never => {}
        Driving::Always => {
            let message = format!(
                "the friction of joint `{}` drives it at every speed",
                joint.name.value
            );
            report.error(friction.span, "friction-drives", message);
            report.help("friction is positive for positive velocity: change the sign");
        }
        Driving::Between(ranges) => {
            let message = format!(
                "the friction of joint `{}` drives it {}",
                joint.name.value,
                law.speeds(&ranges)
            );
            report.note(Some(friction.span), "friction-drives", message);
            report.help("friction that has the sign of the velocity brakes; what drives gives the joint energy");
        }
    }
}

const NOT_FINITE: &str = "a force law has a finite value at every position and speed within the limits, standstill included";

/// Where friction has the sign against the velocity.
enum Driving {
    Never,
    Always,
    /// Between these velocities.
    Between(Vec<[f64; 2]>),
}

struct Law<'a> {
    joint: &'a JointDescription,
    defaults: &'a [f64],
}

impl Law<'_> {
    fn value(&self, formula: &Formula, position: f64, velocity: f64) -> f64 {
        formula.evaluate(self.defaults, position, velocity)
    }

    fn unit(&self) -> &'static str {
        match self.joint.kind {
            Some(JointKind::Prismatic) => "m",
            _ => "rad",
        }
    }

    fn positions(&self) -> impl Iterator<Item = f64> {
        let widest = match self.joint.kind {
            Some(JointKind::Prismatic) => 1.0,
            _ => std::f64::consts::PI,
        };
        let limits = self.joint.limits.position.as_ref();
        let [low, high] = limits.map_or([-widest, widest], |limits| limits.value);
        let steps = f64::from(POSITIONS - 1);
        let inner = (0..POSITIONS).map(move |k| low + (high - low) * f64::from(k) / steps);
        let zero = (low <= 0.0 && high >= 0.0).then_some(0.0);
        inner.chain(zero)
    }

    /// Speeds, ascending and positive.
    fn speeds_of_grid(&self) -> impl Iterator<Item = f64> + use<> {
        let limit = self.joint.limits.velocity.as_ref();
        let most = limit.map_or(SPEED, |limit| limit.value);
        let most = if most > 0.0 { most } else { SPEED };
        (0..SPEEDS).rev().map(move |k| most * FACTOR.powi(k))
    }

    /// Velocities, ascending, standstill included.
    fn velocities(&self) -> Vec<f64> {
        let forward: Vec<f64> = self.speeds_of_grid().collect();
        let backward = forward.iter().rev().map(|speed| -speed);
        backward
            .chain([0.0])
            .chain(forward.iter().copied())
            .collect()
    }

    fn first_not_finite(&self, force: &dyn Fn(f64, f64) -> f64) -> Option<[f64; 2]> {
        let velocities = self.velocities();
        let states = self
            .positions()
            .flat_map(|y| velocities.iter().map(move |v| [y, *v]));
        // Standstill is what a message should name, where it is at fault.
        let still = self.positions().map(|y| [y, 0.0]);
        still
            .chain(states)
            .find(|[y, v]| !force(*y, *v).is_finite())
    }

    fn not_finite(&self, what: &str, force: &dyn Fn(f64, f64) -> f64, [y, v]: [f64; 2]) -> String {
        let unit = self.unit();
        format!(
            "the {what} of joint `{}` is {} at y = {y:.3} {unit}, v = {v:.3} {unit}/s",
            self.joint.name.value,
            force(y, v)
        )
    }

    fn driving(&self, torque: &dyn Fn(f64, f64) -> f64) -> Driving {
        let positions: Vec<f64> = self.positions().collect();
        let velocities = self.velocities();
        let at = |v: f64| positions.iter().map(move |y| torque(*y, v));
        let largest = velocities
            .iter()
            .flat_map(|v| at(*v))
            .fold(0.0, |most: f64, torque| most.max(torque.abs()));
        let drives =
            |v: f64| v != 0.0 && at(v).any(|torque| torque * v.signum() < -ROUNDING * largest);
        let moving = velocities.iter().filter(|v| **v != 0.0);
        if moving.clone().all(|v| drives(*v)) {
            return Driving::Always;
        }
        let mut ranges: Vec<[f64; 2]> = Vec::new();
        let mut last = false;
        for &v in &velocities {
            match (drives(v), last, ranges.last_mut()) {
                (true, true, Some(range)) => range[1] = v,
                (true, ..) => ranges.push([v, v]),
                (false, ..) => {}
            }
            last = drives(v);
        }
        match ranges.is_empty() {
            true => Driving::Never,
            false => Driving::Between(ranges),
        }
    }

    /// `at speeds from −0.1 to −0.001 rad/s and from 3 to 10 rad/s`
    fn speeds(&self, ranges: &[[f64; 2]]) -> String {
        let unit = self.unit();
        let text = |[low, high]: &[f64; 2]| format!("from {low:.3} to {high:.3} {unit}/s");
        let ranges: Vec<String> = ranges.iter().map(text).collect();
        format!("at velocities {}", ranges.join(" and "))
    }
}
