//! Experiments in which friction is identified: claims 5 to 9.

use crate::study::Experiment;

/// In the order of the report.
pub const EXPERIMENTS: &[Experiment] = &[];
