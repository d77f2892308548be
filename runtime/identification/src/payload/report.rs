//! Report on a load: mass, centre of mass, moments of inertia about the centre of mass, intervals, findings.

use super::result::{NAMES, Payload};
use crate::estimation::Uncertain;
use crate::inertial::PER_BODY;
use crate::inertial::consistent::ConsistentSolution;
use gelenk_findings::digits::plain;
use gelenk_findings::{Finding, Rule};
use nalgebra::{DMatrix, DVector, RowDVector};

/// Sees: a mass of the load whose interval contains zero.
/// Matters: there may be no load.
/// Example: logs without and with an empty gripper.
/// Fixture: `payload/tests.rs`.
const NO_LOAD: Rule = Rule::warning("no-load");

/// Sees: values of the load that the motion does not excite.
/// Matters: these values are set to those of a ball of the load's mass.
/// Example: moments of a load that never turned.
/// Fixture: `payload/tests.rs`.
const HIDDEN: Rule = Rule::warning("load-hidden");

/// Sees: efforts whose best fit is a load that is not physically possible.
/// Matters: the nearest possible load is reported.
/// Example: a mass below 0.
/// Fixture: `payload/tests.rs`.
const IMPOSSIBLE: Rule = Rule::warning("load-impossible");

/// Sees: joints that do not move in logs of a load.
/// Matters: their efforts are not used.
/// Example: a wrist that was held.
/// Fixture: `payload/tests.rs`.
const NOT_USED: Rule = Rule::warning("load-efforts-not-used");

/// Sees: joints whose residuals the load makes larger.
/// Matters: friction or offset differ between the logs.
/// Example: a cold robot without the load, and a warm one with it.
/// Fixture: `payload/tests.rs`.
const WORSE: Rule = Rule::warning("load-residuals");

/// The values of a load with their intervals.
///
/// - `sizes`: for each parameter, its range among bodies with the mass of the load
/// - `factor`: half width of an interval in standard errors
pub(super) fn values(
    parameters: &DVector<f64>,
    covariance: &DMatrix<f64>,
    sizes: &DVector<f64>,
    factor: f64,
) -> Payload {
    let pi: [f64; PER_BODY] = std::array::from_fn(|k| parameters[k]);
    let half = |gradient: &[f64; PER_BODY]| {
        let g = RowDVector::from_row_slice(gradient);
        factor * (&g * covariance * g.transpose())[0].max(0.0).sqrt()
    };
    let of = |function: &dyn Fn(&[f64; PER_BODY]) -> f64| {
        let (value, half) = (function(&pi), half(&gradient(function, &pi)));
        Uncertain { value, standard_error: half / factor, interval: [value - half, value + half] }
    };
    let parameters: [Uncertain; PER_BODY] = std::array::from_fn(|k| of(&move |pi| pi[k]));
    let shown = std::array::from_fn(|k| {
        let [low, high] = parameters[k].interval;
        0.5 * (high - low) < sizes[k]
    });
    Payload {
        mass: parameters[0],
        centre_of_mass: std::array::from_fn(|k| of(&move |pi| pi[1 + k] / pi[0])),
        moments: std::array::from_fn(|k| of(&move |pi| central_moments(pi)[k])),
        parameters,
        shown,
        ..Payload::default()
    }
}

/// Gradient by central differences with steps of the parameters' size. The functions are smooth if the mass is positive.
fn gradient(function: &dyn Fn(&[f64; PER_BODY]) -> f64, pi: &[f64; PER_BODY]) -> [f64; PER_BODY] {
    let scale = pi.iter().fold(0.0, |s: f64, x| s.max(x.abs()));
    std::array::from_fn(|k| {
        let step = 1e-6 * if k == 0 { pi[0] } else { scale };
        let at = |sign: f64| {
            let mut moved = *pi;
            moved[k] += sign * step;
            function(&moved)
        };
        (at(1.0) - at(-1.0)) / (2.0 * step)
    })
}

/// Moments about the centre of mass, in the order of the parameters.
fn central_moments(pi: &[f64; PER_BODY]) -> [f64; 6] {
    let [m, hx, hy, hz, xx, xy, yy, xz, yz, zz] = *pi;
    [
        xx - (hy * hy + hz * hz) / m,
        xy + hx * hy / m,
        yy - (hx * hx + hz * hz) / m,
        xz + hx * hz / m,
        yz + hy * hz / m,
        zz - (hx * hx + hy * hy) / m,
    ]
}

pub(super) fn findings(payload: &Payload, load: &ConsistentSolution, names: &[String]) -> Vec<Finding> {
    let [low, high] = payload.mass.interval;
    let none = (low <= 0.0).then(|| {
        NO_LOAD.found(format!(
            "the logs show no load. The interval of its mass, {} to {} kg, contains zero",
            plain(low, 3),
            plain(high, 3)
        ))
    });
    let hidden: Vec<&str> =
        NAMES.iter().zip(payload.shown).filter(|(_, shown)| !shown).map(|(name, _)| *name).collect();
    let hidden = (!hidden.is_empty()).then(|| {
        let instead = if low > 0.0 {
            ". Their values are those of a solid ball of the same mass with 1500 kg/m³"
        } else {
            ""
        };
        HIDDEN.found(format!("the motion does not determine {} of the load{instead}", hidden.join(", ")))
    });
    let bound = (!load.on_boundary.is_empty()).then(|| {
        IMPOSSIBLE.found(
            "the efforts correspond to a load that is physically impossible. The nearest possible load is reported. The intervals \
             ignore this constraint",
        )
    });
    let of = |is_meant: &dyn Fn(usize) -> bool| -> Vec<&str> {
        names
            .iter()
            .enumerate()
            .filter(|(joint, _)| is_meant(*joint))
            .map(|(_, name)| name.as_str())
            .collect()
    };
    let still = of(&|joint| payload.residuals[joint].is_none());
    let still = (!still.is_empty()).then(|| {
        let message =
            "the efforts of these joints were not used. The joints do not move, so dry friction may hold a part of the load";
        NOT_USED.found(format!("{}: {message}", still.join(", ")))
    });
    let worse = of(&|joint| payload.explained[joint].is_some_and(|share| share < -0.05));
    let worse = (!worse.is_empty()).then(|| {
        let message =
            "the load increases the residuals of these joints. Friction or offset differ between the logs";
        WORSE.found(format!("{}: {message}", worse.join(", ")))
    });
    [none, hidden, bound, still, worse].into_iter().flatten().collect()
}
