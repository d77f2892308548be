//! Checks of force laws. Values must be finite, friction must brake, and load-dependent friction must be
//! smaller than the load.
//!
//! The laws are evaluated on a grid of positions and speeds within the limits, at the description's values of
//! free parameters.

use super::range::Range;
use crate::description::JointDescription;
use crate::diagnostic::{At, Report, Span};
use crate::model::{FrictionTerm, JointKind};
use crate::numeric;
use crate::wording::three_digits;
use gelenk_formula::Formula;

/// Largest speed at which force laws are tested if the joint has no speed limit (rad/s or m/s).
const SPEED: f64 = 10.0;
/// Largest motor speed at which friction is tested if the joint has no speed limit (rad/s).
const MOTOR_SPEED: f64 = 1000.0;
/// Number of tested speeds in each direction. Neighbouring speeds have a constant ratio, because force laws
/// are steep near standstill.
const SPEEDS: i32 = 61;
/// Ratio of neighbouring tested speeds, 10^(−1/15). The smallest speed is 1e-4 of the largest.
const FACTOR: f64 = 0.857_695_898_590_894_1;
/// Number of tested positions, both limits included.
const POSITIONS: i32 = 21;
/// Friction below this fraction of the largest friction counts as a rounding error.
const ROUNDING: f64 = 1e-9;

/// Reports springs and friction of a joint whose value is not finite. Also reports friction that accelerates
/// the joint, and load-dependent friction that is not smaller than the load.
pub(super) fn check(joint: &JointDescription, defaults: &[f64], report: &mut Report) {
    let grid = Grid::of_joint(joint);
    if let Some(springs) = &joint.springs {
        let summands = springs.value.iter().map(|spring| (&Formula::ONE, spring));
        let law = Law { what: "spring", summands: summands.collect(), defaults };
        is_finite(&law, &grid, springs.span, report);
    }
    if let Some(friction) = &joint.friction {
        let law = Law::of("friction", &friction.value.terms, defaults);
        // `quaternion_joints` reports laws of the position at a joint with a quaternion.
        let is_refused = joint.part_of.is_some() && law.depends_on_position();
        if is_finite(&law, &grid, friction.span, report) && !is_refused {
            brakes(&law, &grid, friction.span, report);
        }
        if let Some(load) = &friction.value.load {
            let law = Law::of(OF_THE_LOAD, &load.value, defaults);
            if is_finite(&law, &grid, load.span, report) && is_below_one(&law, &grid, load.span, report) {
                brakes(&law, &grid, load.span, report);
            }
        }
    }
}

/// Reports shaft friction of a drive if its value is not finite or it accelerates the shaft.
///
/// - `speed`: motor speed at the speed limit of the joint (rad/s); `None` without this limit
pub(super) fn check_shaft(
    drive: &str,
    friction: &At<Vec<FrictionTerm>>,
    speed: Option<f64>,
    defaults: &[f64],
    report: &mut Report,
) {
    let grid = Grid {
        owner: format!("drive `{drive}`"),
        unit: "rad",
        widest: std::f64::consts::PI,
        position: None,
        velocity: Some(speed.unwrap_or(MOTOR_SPEED)),
    };
    let law = Law::of("friction", &friction.value, defaults);
    if is_finite(&law, &grid, friction.span, report) {
        brakes(&law, &grid, friction.span, report);
    }
}

/// Name of the load-dependent friction in messages.
const OF_THE_LOAD: &str = "load-dependent friction";

/// Whether the load-dependent friction is smaller than the load. If limits keep the joint within the tested
/// range, the tested values decide. Otherwise bounds of the formula decide in addition.
fn is_below_one(law: &Law<'_>, grid: &Grid, span: Span, report: &mut Report) -> bool {
    let positions = grid.positions();
    let velocities = [0.0].into_iter().chain(grid.velocities());
    let mut states = velocities.flat_map(|v| positions.iter().map(move |y| [*y, v]));
    let (name, unit) = (&grid.owner, grid.unit);
    if let Some([y, v]) = states.find(|[y, v]| law.value(*y, *v).abs() >= 1.0) {
        let message = format!(
            "the load-dependent friction of {name} is {} times the load at v = {} {unit}/s",
            three_digits(law.value(y, v).abs()),
            three_digits(v)
        );
        report.error(span, "load-friction-too-large", message);
        report.help(
            "`load` is friction divided by load, without unit. It must be below 1, otherwise no torque moves the joint",
        );
        return false;
    }
    if grid.holds_all(law) || law.largest() < 1.0 {
        return true;
    }
    let message = format!(
        "the load-dependent friction of {name} may exceed the load, because it depends on a speed or position without limits"
    );
    report.error(span, "load-friction-too-large", message);
    report.help("add position and velocity limits to the joint, or use a law that saturates, for example 0.1*tanh(50*v)");
    false
}

fn is_finite(law: &Law<'_>, grid: &Grid, span: Span, report: &mut Report) -> bool {
    let positions = grid.positions();
    // Standstill comes first, because the message names the first state with a fault.
    let velocities = [0.0].into_iter().chain(grid.velocities());
    let mut states = velocities.flat_map(|v| positions.iter().map(move |y| [*y, v]));
    let Some([y, v]) = states.find(|[y, v]| !law.value(*y, *v).is_finite()) else {
        return true;
    };
    let value = match law.value(y, v).is_nan() {
        true => "undefined",
        false => "infinite",
    };
    let (unit, what, name) = (grid.unit, law.what, &grid.owner);
    let mut message = format!("the {what} of {name} is {value} at v = {} {unit}/s", three_digits(v));
    if law.depends_on_position() {
        message.push_str(&format!(", y = {} {unit}", three_digits(y)));
    }
    report.error(span, "force-not-finite", message);
    report.help(
        "a force law must be finite at every position and speed within the limits, including standstill",
    );
    false
}

fn brakes(law: &Law<'_>, grid: &Grid, span: Span, report: &mut Report) {
    let (name, what) = (&grid.owner, law.what);
    let driven = driven(law, grid);
    if driven.iter().all(|(_, is_driven)| *is_driven)
        && let Some(y) = braked(law, grid)
    {
        let [driving, braking] = [driving(law, grid).unwrap_or(y), y].map(three_digits);
        let unit = grid.unit;
        let message = format!(
            "the {what} of {name} accelerates the joint at every speed at y = {driving} {unit}, but not at \
             y = {braking} {unit}"
        );
        report.error(span, "friction-drives", message);
        report.help(
            "the law must have the sign of the velocity at every position within the limits. Make the position-dependent \
             factor positive, for example with a square, `abs` or an added constant",
        );
    } else if driven.iter().all(|(_, is_driven)| *is_driven) {
        report.error(
            span,
            "friction-drives",
            format!("the {what} of {name} accelerates the joint at every speed"),
        );
        report.help("friction must be positive for positive velocity: change the sign");
    } else if driven.iter().any(|(_, is_driven)| *is_driven) {
        let ranges = driven.chunk_by(|(_, first), (_, second)| first == second);
        let ranges = ranges.filter(|range| range[0].1);
        let text = |range: &[(f64, bool)]| {
            let [low, high] = [range[0].0, range[range.len() - 1].0].map(three_digits);
            format!("from {low} to {high} {}/s", grid.unit)
        };
        let ranges: Vec<String> = ranges.map(text).collect();
        let message =
            format!("the {what} of {name} accelerates the joint at velocities {}", ranges.join(" and "));
        report.note(Some(span), "friction-drives", message);
        report.help("friction brakes the joint if it has the sign of the velocity, and adds energy if it has the opposite sign");
    }
}

/// A tested position at which friction brakes at every speed.
fn braked(law: &Law<'_>, grid: &Grid) -> Option<f64> {
    by_sign(law, grid, 1.0)
}

/// A tested position at which friction accelerates the joint at every speed.
fn driving(law: &Law<'_>, grid: &Grid) -> Option<f64> {
    by_sign(law, grid, -1.0)
}

fn by_sign(law: &Law<'_>, grid: &Grid, sign: f64) -> Option<f64> {
    let velocities: Vec<f64> = grid.velocities().collect();
    let has_sign = |y: &f64| velocities.iter().all(|v| sign * law.value(*y, *v) * v.signum() > 0.0);
    grid.positions().into_iter().filter(has_sign).min_by(|a, b| a.abs().total_cmp(&b.abs()))
}

/// The tested velocities. The flag of a velocity is set if friction accelerates the joint at some position.
fn driven(law: &Law<'_>, grid: &Grid) -> Vec<(f64, bool)> {
    let positions = grid.positions();
    let velocities: Vec<f64> = grid.velocities().collect();
    let torques = |v: f64| positions.iter().map(move |y| law.value(*y, v));
    let all = velocities.iter().flat_map(|v| torques(*v));
    let largest = all.fold(0.0, |most: f64, torque| most.max(torque.abs()));
    let drives = |v: f64| torques(v).any(|torque| torque * v.signum() < -ROUNDING * largest);
    velocities.iter().map(|v| (*v, drives(*v))).collect()
}

/// A force law as a sum of products of a coefficient and a function of the motion.
struct Law<'a> {
    what: &'static str,
    summands: Vec<(&'a Formula, &'a Formula)>,
    defaults: &'a [f64],
}

impl<'a> Law<'a> {
    fn of(what: &'static str, terms: &'a [FrictionTerm], defaults: &'a [f64]) -> Self {
        let summands = terms.iter().map(|term| (&term.coefficient, &term.basis));
        Self { what, summands: summands.collect(), defaults }
    }

    /// A bound of the law's magnitude over all positions and velocities; infinite if no bound is known.
    fn largest(&self) -> f64 {
        let products = self.summands.iter();
        let magnitudes = products.map(|(coefficient, basis)| {
            let factor = coefficient.evaluate(self.defaults, 0.0, 0.0).abs();
            factor * Range::of(basis, self.defaults).magnitude()
        });
        magnitudes.sum()
    }

    fn value(&self, position: f64, velocity: f64) -> f64 {
        let value = |formula: &Formula| formula.evaluate(self.defaults, position, velocity);
        let summands = self.summands.iter();
        summands.map(|(coefficient, basis)| value(coefficient) * value(basis)).sum()
    }

    fn depends_on_position(&self) -> bool {
        self.summands.iter().any(|(_, basis)| basis.depends_on_position())
    }
}

/// Positions and velocities at which the laws of a joint or shaft are evaluated.
struct Grid {
    /// Kind and name of the joint or shaft, for messages.
    owner: String,
    unit: &'static str,
    /// Largest tested position if there are no position limits.
    widest: f64,
    /// Limits of the joint's position; `None` without limits.
    position: Option<[f64; 2]>,
    /// Limit of the joint's speed; `None` without a limit.
    velocity: Option<f64>,
}

impl Grid {
    fn of_joint(joint: &JointDescription) -> Self {
        let (unit, widest) = match joint.kind {
            Some(JointKind::Prismatic) => ("m", 1.0),
            _ => ("rad", std::f64::consts::PI),
        };
        let limits = &joint.limits;
        Self {
            owner: format!("joint `{}`", joint.name.value),
            unit,
            widest,
            position: limits.position.as_ref().map(|limits| limits.value),
            velocity: limits.velocity.as_ref().map(|limit| limit.value),
        }
    }

    /// Whether limits keep the joint within the range of tested positions and velocities.
    fn holds_all(&self, law: &Law<'_>) -> bool {
        self.velocity.is_some() && (self.position.is_some() || !law.depends_on_position())
    }

    /// Tested positions in ascending order. If the limits contain 0, it is added at the end.
    fn positions(&self) -> Vec<f64> {
        let [low, high] = self.position.unwrap_or([-self.widest, self.widest]);
        let part = |k: i32| f64::from(k) / f64::from(POSITIONS - 1);
        let zero = (low <= 0.0 && high >= 0.0).then_some(0.0);
        let positions = (0..POSITIONS).map(|k| low + (high - low) * part(k));
        positions.chain(zero).collect()
    }

    /// Tested velocities in ascending order, without 0.
    fn velocities(&self) -> impl Iterator<Item = f64> + use<> {
        let most = self.velocity.unwrap_or(SPEED);
        // A limit that is not positive has its own message.
        let most = if most > 0.0 { most } else { SPEED };
        let backward = (0..SPEEDS).map(move |k| -most * numeric::power(FACTOR, k));
        let forward = (0..SPEEDS).rev().map(move |k| most * numeric::power(FACTOR, k));
        backward.chain(forward)
    }
}
