//! An identified load with its uncertainty.

use crate::estimation::Uncertain;
use crate::inertial::PER_BODY;
use gelenk_findings::Finding;

/// Names of a load's ten parameters, in the frame of the body that carries it.
pub(crate) const NAMES: [&str; PER_BODY] =
    ["m", "m cx", "m cy", "m cz", "Ixx", "Ixy", "Iyy", "Ixz", "Iyz", "Izz"];

/// A load, in the frame of the body that carries it.
///
/// The intervals take correlated residuals into account. For parameters that the motion does not determine,
/// they also include possible errors of the description and of the reference ball. The reference ball has
/// 1500 kg/m³ and the load's mass.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Payload {
    /// Index of the body that carries the load, from 0.
    pub body: usize,
    /// Mass of the load \[kg\].
    pub mass: Uncertain,
    /// Centre of mass of the load in the frame of the body that carries it \[m\].
    pub centre_of_mass: [Uncertain; 3],
    /// Moments of inertia Ixx, Ixy, Iyy, Ixz, Iyz, Izz of the load in kg m² about its centre of mass, with
    /// axes parallel to the body's frame.
    pub moments: [Uncertain; 6],
    /// Mass m, first moments m c, and moments of inertia Ixx, Ixy, Iyy, Ixz, Iyz, Izz about the frame's origin, in kg, kg m and
    /// kg m². The sum of these parameters and of the body's parameters describes the body with the load.
    pub parameters: [Uncertain; PER_BODY],
    /// For each of [`Self::parameters`], whether the motion determines it. A parameter counts as determined if its interval is
    /// narrower than the range of this parameter among bodies with the mass of the load. If the motion determines the mass, the
    /// undetermined parameters are those of a ball of 1500 kg/m³ at the centre of mass.
    pub shown: [bool; PER_BODY],
    /// For each joint, the share of a residual sum of squares that the load explains. The residual is that of the log with the
    /// load, if the load is zero and friction is unchanged. A share of one is best. If the share is zero or less, the load
    /// explains nothing. `None` for a joint at rest.
    pub explained: Vec<Option<f64>>,
    /// Standard deviation of each joint's residual [N·m or N]; `None` for a joint at rest.
    pub residuals: Vec<Option<f64>>,
    /// Findings that raise doubts about the load.
    pub findings: Vec<Finding>,
}
