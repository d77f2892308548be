//! Identification of a load at a robot's hand, from logs without and logs with the load.
//!
//! Both logs satisfy `W(y, ẏ, ÿ) (π + δ) + F φ = B u` with the regressor W and the error δ of the described parameters π. F φ
//! is friction and an offset of each joint, and B u are the forces of the inputs. The log with the load has the additional
//! term `W_b π_L`, with the columns W_b of the body that carries the load and the parameters π_L of the load. All unknowns are
//! fitted together. The weight of each joint follows from its noise. If the logs do not determine δ, it stays near zero. For
//! equal motions π_L then explains the difference of the efforts, `W_b π_L = Δτ`. The load must be a physically possible body
//! (pseudo-inertia ⪰ 0).
//!
//! The rows of joints with a quaternion have neither friction nor an offset, and all their samples are used.
//! In the rows of other joints, samples at rest are left out, because the dry friction of the joint then
//! holds a part of the load.
//!
//! Friction and offset are assumed to be the same in both logs. Therefore load-dependent friction makes the estimated load too
//! heavy.

mod equations;
mod identify;
mod levels;
mod report;
mod result;
mod settings;

pub use identify::{CarriedLoad, identify_load};
pub use result::Payload;
pub use settings::PayloadSettings;

use crate::error::{Result, require_setting};
use crate::estimation::{distance, inverse};
use crate::inertial::consistent::{ConsistentProblem, ConsistentSolution, solve};
use crate::inertial::{PER_BODY, from_pseudo_inertia};
use crate::methods::confidence::quantile;
use crate::numeric::statistics::median;
use crate::robot::{Robot, require_no_driven};
use crate::run::PreparedRun;
use equations::Equations;
use nalgebra::{DMatrix, DVector, Matrix4};

/// Estimates a load from runs without and with the load.
///
/// - `without`, `with`: runs that were prepared in the same way. The same motion is best, but any motion of the last joints
///   is useful.
///
/// # Errors
/// The call fails if
/// - there are no runs with the load or no runs without it,
/// - shapes do not match the robot, or a joint is moved from outside,
/// - efforts are of different kinds, or currents without described motor constants,
/// - a setting is out of its range, or there are too few samples, or
/// - no minimum is found.
pub(crate) fn estimate(
    robot: &dyn Robot,
    without: &[PreparedRun],
    with: &[PreparedRun],
    settings: &PayloadSettings,
) -> Result<Payload> {
    let body = check(robot, settings)?;
    let equations = Equations::new(robot, without, with, body, settings)?;
    let factor = quantile(settings.confidence, (equations.blocks() - 1).max(1) as f64)?;
    // The first reference is a load of about the robot's size. If the motion determines the mass, the second reference is a
    // ball at the estimated centre. If the motion does not determine the mass, it does not determine a centre either.
    let mut found = Found::near(anything(robot), &equations, settings)?;
    if found.load.parameters[0] > factor * found.covariance[(0, 0)].sqrt() {
        let ball = ball(found.load.parameters.as_slice());
        found = Found::near(ball, &equations, settings)?;
    }
    let explained = equations.explained(&found.load.parameters.clone().push(-1.0));
    let residuals = equations.weights.iter().map(|&w| (w > 0.0).then(|| 1.0 / w.sqrt())).collect();
    let values = report::values(&found.load.parameters, &found.covariance, &found.sizes, factor);
    let mut payload = Payload { body, explained, residuals, ..values };
    payload.findings = report::findings(&payload, &found.load, &robot.joint_names());
    Ok(payload)
}

fn check(robot: &dyn Robot, settings: &PayloadSettings) -> Result<usize> {
    let help = "identify the whole robot from its logs with the load";
    require_no_driven(robot, "payloads are not estimated", help)?;
    let bodies = robot.bodies();
    let body = settings.body.unwrap_or(bodies.saturating_sub(1));
    require_setting(
        "body of the load",
        body as f64,
        body < bodies,
        "it must be the index of the body that carries the load, counted from 0",
    )?;
    let positive = "it must be positive";
    require_setting("weight of the description", settings.weight, settings.weight > 0.0, positive)?;
    let inside = settings.confidence > 0.0 && settings.confidence < 1.0;
    require_setting("confidence", settings.confidence, inside, "it must lie between 0 and 1")?;
    Ok(body)
}

/// An estimated load that stays near a reference in directions that the motion does not determine.
struct Found {
    load: ConsistentSolution,
    covariance: DMatrix<f64>,
    /// For each parameter, the difference between the reference and a body at the distance 1 from the
    /// reference, as measured by [`PayloadSettings::weight`].
    sizes: DVector<f64>,
}

impl Found {
    fn near(reference: [f64; PER_BODY], equations: &Equations, settings: &PayloadSettings) -> Result<Self> {
        let weight = levels::BALL.get() * settings.weight;
        // The objective of the program is half of the sum of squares, so the distance has the factor two.
        let held = distance(&reference, 1).0 * (2.0 * weight);
        let sizes = inverse(&held)?.diagonal().map(|square| (weight * square).sqrt());
        let (hessian, linear) = equations.normal();
        let held = held.resize(linear.len(), linear.len(), 0.0);
        let reference = DVector::from_row_slice(&reference).resize_vertically(linear.len(), 0.0);
        let problem = ConsistentProblem {
            hessian: hessian + &held,
            linear: linear + &held * reference,
            bodies: 1,
            nonnegative: Vec::new(),
        };
        let load = solve(&problem)?;
        let values = load.parameters.clone().push(-1.0);
        Ok(Self { covariance: equations.covariance(&problem.hessian, &held, &values)?, sizes, load })
    }
}

/// A load with the median mass of the robot's bodies, which is spread around the frame's origin.
fn anything(robot: &dyn Robot) -> [f64; PER_BODY] {
    let parameters = robot.parameters();
    let bodies = parameters.chunks_exact(PER_BODY).take(robot.bodies());
    let mass = median(bodies.map(|pi| pi[0]).filter(|&m| m > 0.0)).unwrap_or(1.0);
    let spread = mass * levels::REACH.get().powi(2);
    from_pseudo_inertia(&Matrix4::from_diagonal(&[spread, spread, spread, mass].into()))
}

/// A ball with the mass and centre of a body.
fn ball(pi: &[f64]) -> [f64; PER_BODY] {
    let mass = pi[0];
    let radius = (mass * 3.0 / (4.0 * std::f64::consts::PI * levels::DENSITY.get())).cbrt();
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

#[cfg(test)]
mod tests;
