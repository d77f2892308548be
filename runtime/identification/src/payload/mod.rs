//! The load at a robot's hand, from a log without and a log with it.
//!
//! Both logs obey `W(y, ẏ, ÿ) (π + δ) + F φ = B u`: δ is the difference of the description, F φ the friction and
//! an offset of each joint. The log with the load has `W_b π_L` more, the columns of the body that carries it.
//! The load is ten more unknowns of the common estimate: for equal motions π_L explains the difference of the efforts, `W_b π_L = Δτ`.
//! It is a body that can exist (pseudo-inertia ⪰ 0).
//!
//! Samples at which a joint rests say nothing about the load, since dry friction holds a part of it.
//! Friction and offset are the same in both logs: gears whose friction grows with their load make the load
//! heavier by their weight.

mod identify;
mod levels;
mod report;
mod result;
mod settings;

pub use identify::{CarriedLoad, identify_load};
pub use result::Payload;
pub use settings::PayloadSettings;

use crate::error::{Result, require_setting};
use crate::estimation::{EstimationSettings, Load, LoadFit, Offsets, distance, estimate_load};
use crate::inertial::{PER_BODY, from_pseudo_inertia};
use crate::methods::confidence::quantile;
use crate::robot::{Robot, require_no_driven};
use crate::run::PreparedRun;
use nalgebra::Matrix4;

/// Estimates a load from runs without and with it.
///
/// - `without`, `with`: prepared alike; the same motion is best, any that moves the last joints helps
/// - `estimation`: settings of the common estimate. Offsets are common to all runs, because one of each run would take up the weight
///
/// # Errors
/// No runs of one kind, shapes that disagree with the robot, joints that something else moves, efforts of different kinds, currents
/// whose motor constants are not described, settings out of range, too few samples, or no minimum.
pub(crate) fn estimate(
    robot: &dyn Robot,
    runs: [&[PreparedRun]; 2],
    settings: &PayloadSettings,
    estimation: &EstimationSettings,
) -> Result<Payload> {
    let body = check(robot, settings)?;
    // First any load of about the robot's size. A mass that is seen then says where a ball is, which decides
    // what the motion does not show; around a mass that is not seen there is no such place.
    let second = |found: &LoadFit| {
        let half = quantile(settings.confidence, found.freedom as f64)? * found.covariance[(0, 0)].sqrt();
        Ok((found.values[0] > half).then(|| near(ball(&found.values))))
    };
    let estimation =
        EstimationSettings { offsets: Some(Offsets::Common), delays: None, ..estimation.clone() };
    let found = estimate_load(robot, runs, (body, &estimation), near(anything(robot)), &second)?;
    report::payload(robot.joint_names(), body, found, settings.confidence)
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
        "it must be one of the robot's bodies, from 0",
    )?;
    let inside = settings.confidence > 0.0 && settings.confidence < 1.0;
    require_setting("confidence", settings.confidence, inside, "it must lie between 0 and 1")?;
    Ok(body)
}

/// A load near a reference.
fn near(reference: [f64; PER_BODY]) -> Load {
    Load { mean: reference, precision: distance(&reference, 1).0 * (2.0 * levels::BALL.get()) }
}

/// A load of the robot's own size: the median mass of its bodies, spread around the frame's origin.
fn anything(robot: &dyn Robot) -> [f64; PER_BODY] {
    let parameters = robot.parameters();
    let bodies = parameters.chunks_exact(PER_BODY).take(robot.bodies());
    let mut masses: Vec<f64> = bodies.map(|pi| pi[0]).filter(|&m| m > 0.0).collect();
    masses.sort_by(f64::total_cmp);
    let mass = masses.get(masses.len() / 2).copied().unwrap_or(1.0);
    let spread = mass * levels::REACH.get().powi(2);
    from_pseudo_inertia(&Matrix4::from_diagonal(&[spread, spread, spread, mass].into()))
}

/// A ball with mass and centre of a body.
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
