//! A load, with how far to trust it.

use crate::estimation::Uncertain;
use crate::inertial::PER_BODY;
use gelenk_findings::Finding;

/// Names of a load's ten parameters, in the frame of the body that carries it.
pub(crate) const NAMES: [&str; PER_BODY] =
    ["m", "m cx", "m cy", "m cz", "Ixx", "Ixy", "Iyy", "Ixz", "Iyz", "Izz"];

/// A load, in the frame of the body that carries it. Intervals allow for residuals that are correlated over time, and for a
/// description and a ball that are wrong by their own size if the motion does not show them.
#[derive(Debug, Clone, PartialEq)]
pub struct Payload {
    /// The body that carries the load, from 0.
    pub body: usize,
    /// Mass, in kg.
    pub mass: Uncertain,
    /// Centre of mass, in m.
    pub centre_of_mass: [Uncertain; 3],
    /// Ixx, Ixy, Iyy, Ixz, Iyz, Izz about the centre of mass, axes parallel to the body's frame [kg m²].
    pub moments: [Uncertain; 6],
    /// m, m c and the moments Ixx, Ixy, Iyy, Ixz, Iyz, Izz about the frame's origin, which are added to the body's.
    pub parameters: [Uncertain; PER_BODY],
    /// Whether the motion shows each parameter: its interval is smaller than what bodies of this mass differ
    /// by. The others are those of a ball of 1500 kg/m³ at the centre of mass, if the mass is seen.
    pub shown: [bool; PER_BODY],
    /// Share of the efforts' change that the load explains, for each joint: R² of the log with the load, with
    /// against without the load's columns, at equal friction. One is best; zero or less explains nothing. `None`
    /// for a joint that stood still.
    pub explained: Vec<Option<f64>>,
    /// Standard deviation of each joint's residual [N·m or N]; `None` for a joint that stood still.
    pub residuals: Vec<Option<f64>>,
    /// Doubts.
    pub findings: Vec<Finding>,
}
