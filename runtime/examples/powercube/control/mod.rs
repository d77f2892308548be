//! Experiments in which the arm is controlled: claims 1 to 4, and 10 to 14.

mod adaptation;
mod changes;
mod gap;
mod identified;
mod limits;
mod nonlinear;
mod regimes;
mod run;
mod show;
#[cfg(test)]
mod tests;
mod timing;
mod tracking;

use crate::study::Experiment;

/// Experiments in the order of the report. They precede the experiments with friction.
pub const EXPERIMENTS: &[Experiment] = &[
    ("LTV-MPC and feed-forward alone", tracking::experiment),
    ("old and identified friction", gap::experiment),
    ("ideal and realistic regimes", regimes::experiment),
    ("nonlinear MPC", nonlinear::experiment),
    ("limits as constraints", limits::experiment),
    ("time", timing::experiment),
    ("friction that changes", adaptation::experiment),
    ("gears that warm up, and a load", changes::experiment),
];
