//! Experiments in which friction is identified: claims 5 to 9.

mod angle;
mod cases;
mod data;
mod joints;
mod law;
mod library;
mod methods;
mod methods_figures;
mod plants;
#[cfg(test)]
mod tests;
mod velocity;

use crate::study::Experiment;

/// Experiments in the order of the report.
pub const EXPERIMENTS: &[Experiment] = &[
    ("velocities from encoders", velocity::experiment),
    ("friction and the angle", angle::experiment),
    ("library and choice of terms", library::experiment),
    ("SINDy and nonlinear regression", methods::experiment),
    ("friction of the joints, and load", joints::experiment),
];
