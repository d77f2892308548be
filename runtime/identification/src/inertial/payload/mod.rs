//! The load at a robot's hand, from a log without and a log with it.
//!
//! Both logs obey `W(y, ẏ, ÿ) (π + δ) + F φ = B u`: δ is what the description has wrong, F φ the friction and
//! an offset of each joint. The log with the load has `W_b π_L` more, the columns of the body that carries it.
//! All are fitted together, each joint weighted by its own noise; δ is held at the description where the logs
//! do not show it, so that for equal motions π_L explains the difference of the efforts, `W_b π_L = Δτ`.
//! The load is a body that can exist (pseudo-inertia ⪰ 0).
//!
//! Samples at which a joint stands still say nothing about the load, since its dry friction holds a part of it.
//! Friction and offset are the same in both logs: gears whose friction grows with their load make the load
//! heavier by what they add.

mod equations;
mod report;

use super::consistent::{ConsistentProblem, ConsistentSolution, solve};
use super::pseudo_inertia::{PER_BODY, from_pseudo_inertia};
use super::regularized::towards;
use crate::error::{IdentificationError, Result, require_setting};
use crate::robot::{Robot, require_plain};
use crate::run::PreparedRun;
use equations::{Equations, Reduced};
use nalgebra::{DMatrix, Matrix4};

/// Names of a load's ten parameters, in the frame of the body that carries it.
pub const NAMES: [&str; PER_BODY] = ["m", "m cx", "m cy", "m cz", "Ixx", "Ixy", "Iyy", "Ixz", "Iyz", "Izz"];

/// Density of the ball that stands for what the motion does not show of a load [kg/m³]: plastics, or
/// half as much metal as air.
const DENSITY: f64 = 1500.0;

/// How far from the frame's origin a load's mass is, before anything is known of it [m].
const REACH: f64 = 0.3;

/// Weight of the ball as a share of [`PayloadSettings::weight`]: the spread of a load's mass is known to a factor
/// of about three.
const BALL: f64 = 0.1;

/// Reweightings of the joints by their residuals; three change nothing that matters any more.
const REWEIGHTINGS: usize = 5;

/// What an estimate of a payload takes for granted.
#[derive(Debug, Clone, PartialEq)]
pub struct PayloadSettings {
    /// Body that carries the load, from 0; the last one unless stated.
    pub body: Option<usize>,
    /// K_M of each input [N·m/A or N/A], needed where logs hold currents.
    pub gains: Option<Vec<f64>>,
    /// Cost of a body at distance one from its description, in samples with an error of one standard deviation,
    /// as in [`towards`].
    pub weight: f64,
    /// Share of intervals that hold the truth, e.g. 0.95.
    pub confidence: f64,
}

impl Default for PayloadSettings {
    fn default() -> Self {
        Self { body: None, gains: None, weight: 1.0, confidence: 0.95 }
    }
}

/// A load, in the frame of the body that carries it.
#[derive(Debug, Clone, PartialEq)]
pub struct Payload {
    /// The body that carries the load, from 0.
    pub body: usize,
    /// Mass, in kg.
    pub mass: Estimate,
    /// Centre of mass, in m.
    pub centre_of_mass: [Estimate; 3],
    /// Ixx, Ixy, Iyy, Ixz, Iyz, Izz about the centre of mass, axes parallel to the body's frame [kg m²].
    pub moments: [Estimate; 6],
    /// The ten parameters as [`NAMES`] has them, about the frame's origin: what is added to the body's.
    pub parameters: [Estimate; PER_BODY],
    /// Whether the motion shows each parameter: its interval is smaller than what bodies of this mass differ
    /// by. The others are those of a ball of 1500 kg/m³ at the centre of mass, if the mass is seen.
    pub shown: [bool; PER_BODY],
    /// Share of the efforts' change that the load explains, for each joint: R² of the log with the load, with
    /// against without the load's columns, at equal friction. One is best; zero or less explains nothing. `None`
    /// for a joint that stood still.
    pub explained: Vec<Option<f64>>,
    /// Standard deviation of each joint's residual [N·m or N]; `None` for a joint that stood still.
    pub residuals: Vec<Option<f64>>,
    /// What a reader has to know, as sentences.
    pub warnings: Vec<String>,
}

/// A value and its confidence interval: it allows for residuals that are correlated over time, and for a
/// description and a ball that are wrong by their own size where the motion does not show them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// The value.
    pub value: f64,
    /// Lower and upper end.
    pub interval: [f64; 2],
}

/// Estimates a load from runs without and with it.
///
/// - `without`, `with`: prepared alike; the same motion is best, any that moves the last joints helps
///
/// # Errors
/// No runs of one kind, shapes that disagree with the robot, efforts of different kinds, currents without
/// gains, settings out of range, too few samples, or as [`solve`].
pub fn estimate(
    robot: &dyn Robot,
    without: &[PreparedRun],
    with: &[PreparedRun],
    settings: &PayloadSettings,
) -> Result<Payload> {
    let body = check(robot, settings)?;
    let equations = Equations::new(robot, without, with, body, settings)?;
    let weights = equations.weights()?;
    let reduced = equations.reduced(&weights)?;
    let degrees = equations.blocks() - 1;
    // First any load of about the robot's size. A mass that is seen then says where a ball is, which decides
    // what the motion does not show; around a mass that is not seen there is no such place.
    let mut found = Found::near(anything(robot), &equations, &weights, &reduced, settings)?;
    let half = report::quantile(degrees, settings.confidence)? * found.covariance[(0, 0)].sqrt();
    if found.load.parameters[0] > half {
        let ball = ball(found.load.parameters.as_slice());
        found = Found::near(ball, &equations, &weights, &reduced, settings)?;
    }
    report::payload(report::Parts {
        names: robot.joint_names(),
        body,
        load: &found.load,
        covariance: &found.covariance,
        sizes: &found.sizes,
        degrees,
        confidence: settings.confidence,
        explained: equations.explained(&reduced, &found.load.parameters),
        residuals: weights.iter().map(|&w| (w > 0.0).then(|| 1.0 / w.sqrt())).collect(),
    })
}

fn check(robot: &dyn Robot, settings: &PayloadSettings) -> Result<usize> {
    let help = "identify the whole robot from its logs with the load";
    require_plain(robot, "payloads are not estimated", help)?;
    let bodies = robot.bodies();
    let body = settings.body.unwrap_or(bodies.saturating_sub(1));
    require_setting(
        "body of the load",
        body as f64,
        body < bodies,
        "it must be one of the robot's bodies, from 0",
    )?;
    let positive = "it must be positive";
    require_setting("weight of the description", settings.weight, settings.weight > 0.0, positive)?;
    let inside = settings.confidence > 0.0 && settings.confidence < 1.0;
    require_setting("confidence", settings.confidence, inside, "it must lie between 0 and 1")?;
    for gain in settings.gains.iter().flatten() {
        require_setting("gain of an input", *gain, *gain != 0.0, "it must not be zero")?;
    }
    Ok(body)
}

/// A load near a reference.
struct Found {
    load: ConsistentSolution,
    covariance: DMatrix<f64>,
    /// By how much bodies at distance one from the reference differ in each parameter.
    sizes: Vec<f64>,
}

impl Found {
    fn near(
        reference: [f64; PER_BODY],
        equations: &Equations,
        weights: &[f64],
        reduced: &Reduced,
        settings: &PayloadSettings,
    ) -> Result<Self> {
        let weight = BALL * settings.weight;
        let held = towards(&reference, weight)?;
        let load = solve(&ConsistentProblem {
            hessian: &reduced.hessian + &held.hessian,
            linear: &reduced.linear + &held.linear,
            bodies: 1,
            nonnegative: Vec::new(),
        })?;
        let covariance = equations.covariance(weights, reduced, &held.hessian, &load.parameters)?;
        Ok(Self { covariance, sizes: prior_sizes(&held.hessian, weight)?, load })
    }
}

/// A load of the robot's own size: the median mass of its bodies, spread around the frame's origin.
fn anything(robot: &dyn Robot) -> [f64; PER_BODY] {
    let parameters = robot.parameters();
    let bodies = parameters.chunks_exact(PER_BODY).take(robot.bodies());
    let mut masses: Vec<f64> = bodies.map(|pi| pi[0]).filter(|&m| m > 0.0).collect();
    masses.sort_by(f64::total_cmp);
    let mass = masses.get(masses.len() / 2).copied().unwrap_or(1.0);
    let spread = mass * REACH * REACH;
    from_pseudo_inertia(&Matrix4::from_diagonal(&[spread, spread, spread, mass].into()))
}

/// A ball with mass and centre of a body.
fn ball(pi: &[f64]) -> [f64; PER_BODY] {
    let mass = pi[0];
    let radius = (mass * 3.0 / (4.0 * std::f64::consts::PI * DENSITY)).cbrt();
    let mut j = Matrix4::from_diagonal_element(mass * radius * radius / 5.0);
    for r in 0..3 {
        for c in 0..3 {
            j[(r, c)] += pi[1 + r] * pi[1 + c] / mass;
        }
        j[(r, 3)] = pi[1 + r];
        j[(3, r)] = pi[1 + r];
    }
    j[(3, 3)] = mass;
    from_pseudo_inertia(&j)
}

/// By how much bodies at distance one from the ball differ in each parameter.
fn prior_sizes(hessian: &DMatrix<f64>, weight: f64) -> Result<Vec<f64>> {
    let sizes = hessian.diagonal().map(f64::sqrt);
    let unit = DMatrix::from_fn(PER_BODY, PER_BODY, |r, c| hessian[(r, c)] / (sizes[r] * sizes[c]));
    let inverse = unit.cholesky().ok_or_else(|| singular("the load's reference"))?.inverse();
    Ok((0..PER_BODY).map(|k| (weight * inverse[(k, k)]).sqrt() / sizes[k]).collect())
}

fn singular(what: &str) -> IdentificationError {
    IdentificationError::NotConverged {
        what: what.into(),
        iterations: 1,
        detail: "its equations are singular up to rounding".into(),
    }
}

#[cfg(test)]
mod tests;
