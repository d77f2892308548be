//! Experiments in which the arm is controlled: claims 1 to 4, and 10 to 12.

use crate::study::Experiment;

/// In the order of the report.
pub const EXPERIMENTS: &[Experiment] = &[];
