//! Interface of a robot for the identification.

use super::error::{Result, at_joint};
use super::pose::QuaternionJoint;
use gelenk_findings::Subject;

/// A robot whose equations of motion are linear in its inertial parameters π, `W(y, ẏ, ÿ) π = M ÿ + k − q_g`. W is the
/// regressor, y are the joint positions, M is the mass matrix, k is the bias force, and q_g is the gravity force.
///
/// In the lengths of vectors and matrices, N is the number of joints, M is the number of inputs, and P is the number of
/// parameters. Implementations may rely on slices of the lengths that are stated here.
///
/// If joints have quaternions ([`Self::quaternion_joints`]), each of their velocities counts as one joint here, and y has one
/// more entry for each joint with a quaternion.
///
/// A row is one of the N equations. The equation of a shaft may replace the row of a joint ([`Self::shafts`]).
pub trait Robot {
    /// Names of the N joints in the description. For a joint with a quaternion, these are the names of its velocities.
    fn joint_names(&self) -> Vec<String>;

    /// The part of the robot to which a row of the equations belongs: a joint, or the shaft that replaces the joint.
    fn subject(&self, row: usize) -> Subject {
        Subject::Joint(self.joint_names().swap_remove(row))
    }

    /// Names of the M inputs in the description.
    fn input_names(&self) -> Vec<String>;

    /// Unit of each joint's position: `rad` or `m`.
    fn position_units(&self) -> Vec<&'static str>;

    /// Limits of position, speed and force of each joint.
    fn limits(&self) -> Vec<JointLimits>;

    /// Names of the P inertial parameters: ten for each body (mass m, first moments m c, moments of inertia about the
    /// frame's origin), then one for each rotor, as in `INERTIAL_PARAMETER_NAMES` of a generated module.
    fn parameter_names(&self) -> Vec<String>;

    /// Values of the inertial parameters in the description, in the order of [`Self::parameter_names`] [kg,
    /// kg m, kg m²].
    fn parameters(&self) -> Vec<f64>;

    /// Number of bodies. The first `10 · bodies` parameters are those of the bodies.
    fn bodies(&self) -> usize;

    /// The joints that follow other joints (mimic joints) and have limits. Followers of joints that are moved from outside are
    /// not included.
    fn followers(&self) -> Vec<FollowerLimits> {
        Vec::new()
    }

    /// The joints with a quaternion, in the order of their positions.
    fn quaternion_joints(&self) -> Vec<QuaternionJoint> {
        Vec::new()
    }

    /// Input matrix B, `N × M`, row by row: joint forces per unit of each input. Columns of inputs that act at frames are
    /// zero.
    fn input_matrix(&self) -> Vec<f64>;

    /// For each input, whether it is a current in the description. The input matrix B then contains the motor constant.
    fn described_currents(&self) -> Vec<bool> {
        vec![false; self.input_names().len()]
    }

    /// Whether inputs act at frames. The input matrix B then depends on the positions, and recorded efforts must be forces at
    /// the joints.
    fn has_inputs_at_frames(&self) -> bool {
        false
    }

    /// Lowest and highest value of each input, in the unit of the input; infinite if the description has no limit.
    fn input_limits(&self) -> Vec<[f64; 2]> {
        vec![[f64::NEG_INFINITY, f64::INFINITY]; self.input_names().len()]
    }

    /// Torque–speed lines of the motors; empty if the description has none.
    fn torque_speed_lines(&self) -> Vec<TorqueSpeedLine> {
        Vec::new()
    }

    /// Computes the joint forces `B(y) u` of all inputs u, including inputs at frames, at the positions y.
    fn input_forces(&self, y: &[f64], u: &[f64], forces: &mut [f64]) {
        let _ = y;
        for (force, row) in forces.iter_mut().zip(self.input_matrix().chunks_exact(u.len().max(1))) {
            *force = row.iter().zip(u).map(|(b, u)| b * u).sum();
        }
    }

    /// For each joint, whether it is a driven joint, which is moved from outside. An example is a linear axis that carries the
    /// robot. Logs have the motion of such a joint, but not its force.
    fn unmeasured(&self) -> Vec<bool> {
        vec![false; self.joint_names().len()]
    }

    /// For each joint, whether a single input drives it and this input drives no other joint. The load of the joint's gear
    /// is then known, so that load-dependent friction can be estimated.
    fn own_inputs(&self) -> Vec<bool> {
        own_inputs(&self.input_matrix(), self.joint_names().len(), self.input_names().len())
    }

    /// For each row (of a joint, or of one of [`Self::shafts`]), whether additional inertia of its drive may be estimated.
    /// The entry is false if the drive's rotor is among the parameters, or if the description could not hold the inertia.
    fn takes_inertia(&self) -> Vec<bool> {
        vec![true; self.joint_names().len()]
    }

    /// Shafts of drives that act on several joints, if the friction of the shaft is to be identified. The equation of each
    /// shaft replaces the row of one joint. This joint has no separate drive and is not moved from outside. Two shafts never
    /// replace the same joint.
    fn shafts(&self) -> Vec<Shaft> {
        Vec::new()
    }

    /// For each row of the equations, the ratio of its speed to the speed of a joint: 1 for a joint, and the
    /// largest of [`Shaft::ratios`] for a shaft. The search for friction terms scales speeds by this ratio.
    fn speed_scales(&self) -> Vec<f64> {
        vec![1.0; self.joint_names().len()]
    }

    /// Described friction terms of the joints that are replaced by shafts.
    fn joint_terms(&self) -> Vec<JointTerm> {
        Vec::new()
    }

    /// Computes the functions of [`Self::joint_terms`] without their factors, at positions y and velocities ẏ.
    fn joint_term_values(&self, y: &[f64], v: &[f64], values: &mut [f64]) {
        let _ = (y, v);
        values.fill(0.0);
    }

    /// Described friction of a row (of a joint, or of one of [`Self::shafts`]) at its speed v: the force against the motion
    /// [N·m or N], without load-dependent friction. Zero if the description has no friction.
    fn friction(&self, row: usize, v: f64) -> f64 {
        let _ = (row, v);
        0.0
    }

    /// Described gravity in the axes of the base \[m/s²\]; `None` if the robot has no [`Self::regressor_at_rest`] for other
    /// directions.
    fn gravity(&self) -> Option<[f64; 3]> {
        None
    }

    /// Computes the regressor W at positions y and at rest for another gravity vector \[m/s²\], in the shape
    /// of [`Self::inertial_regressor`]. Robots whose [`Self::gravity`] is not `None` implement this function.
    fn regressor_at_rest(&self, y: &[f64], gravity: [f64; 3], regressor: &mut [f64]) {
        let _ = (y, gravity);
        regressor.fill(0.0);
    }

    /// Computes the regressor W, row by row, at positions y [rad or m], velocities ẏ and accelerations ÿ: one
    /// row for each joint, one column for each inertial parameter.
    fn inertial_regressor(&self, y: &[f64], v: &[f64], a: &[f64], regressor: &mut [f64]);

    /// Computes `M ÿ + k − q` with the described parameters, one entry for each joint [N·m or N]. M is the mass matrix, k is
    /// the bias force, and q are gravity, springs and all other forces except inputs and friction. Of the forces q, `W π`
    /// contains only gravity.
    fn rigid_forces(&self, y: &[f64], v: &[f64], a: &[f64], forces: &mut [f64]);
}

/// Positions y, velocities ẏ and accelerations ÿ of all joints at one time, in this order.
pub type Instant = [Vec<f64>; 3];

/// Shaft of a drive that acts on several joints. The friction of the drive acts on this shaft.
#[derive(Debug, Clone, PartialEq)]
pub struct Shaft {
    /// Name of the drive in the description.
    pub name: String,
    /// Index of the joint whose row the shaft's equation replaces. This joint has no separate drive.
    pub joint: usize,
    /// Motion of the shaft per unit of motion of each of the N joints [1 or rad/m]: the gear ratio of the drive times the
    /// weight of the joint in the drive.
    pub ratios: Vec<f64>,
    /// Largest torque of the drive's motor [N·m]; infinite if the description has no limit.
    pub torque: f64,
}

/// Torque–speed line of a motor: the limit `|u + C ẏ| ≤ limit` of the input u, in which the row C makes the largest input fall
/// with the joint velocities ẏ.
#[derive(Debug, Clone, PartialEq)]
pub struct TorqueSpeedLine {
    /// Index of the input u.
    pub input: usize,
    /// Row C: for each of the N joints, the decrease of the largest input per unit of the joint's velocity, in the unit of the
    /// input per rad/s or m/s.
    pub slopes: Vec<f64>,
    /// Largest input of the motor at rest, in the unit of the input.
    pub limit: f64,
}

impl TorqueSpeedLine {
    /// Lowest and highest input at velocities ẏ.
    pub(crate) fn range(&self, v: &[f64]) -> [f64; 2] {
        let taken: f64 = self.slopes.iter().zip(v).map(|(slope, v)| slope * v).sum();
        [-self.limit - taken, self.limit - taken]
    }
}

/// A described friction term of a joint that is replaced by a shaft ([`Robot::shafts`]).
#[derive(Debug, Clone, PartialEq)]
pub struct JointTerm {
    /// Index of the joint.
    pub joint: usize,
    /// Function of the joint's velocity `v` in the description.
    pub basis: String,
    /// Described coefficient, by which the function is multiplied.
    pub coefficient: f64,
}

/// Refuses robots with a joint that is moved from outside.
///
/// - `what`: the action that is not possible, as the beginning of the message
/// - `help`: the end of the message
///
/// # Errors
/// [`IdentificationError::File`](crate::error::IdentificationError::File) with the name of the first joint of this kind.
pub(crate) fn require_no_driven(robot: &dyn Robot, what: &str, help: &str) -> Result<()> {
    let names = robot.joint_names().into_iter().zip(robot.unmeasured());
    match names.filter(|(_, unmeasured)| *unmeasured).map(|(name, _)| name).next() {
        Some(joint) => Err(at_joint(joint)
            .fault(format!("{what} if the motion of a joint is prescribed (`driven`): {help}"))),
        None => Ok(()),
    }
}

/// Refuses robots with quaternions.
///
/// - `what`: the action that is not possible, as the beginning of the message
/// - `help`: the end of the message
///
/// # Errors
/// [`IdentificationError::File`](crate::error::IdentificationError::File) with the name of the first joint with a quaternion.
pub(crate) fn require_no_quaternions(robot: &dyn Robot, what: &str, help: &str) -> Result<()> {
    let Some(joint) = robot.quaternion_joints().into_iter().next() else { return Ok(()) };
    let kind = if joint.is_floating { "floating" } else { "spherical" };
    Err(at_joint(joint.name).fault(format!("{what} if a joint is {kind}: {help}")))
}

/// For each joint, whether its row of the input matrix B has a single entry whose column has no other entry.
fn own_inputs(b: &[f64], joints: usize, inputs: usize) -> Vec<bool> {
    let acts = |joint: usize, input: usize| b[joint * inputs + input] != 0.0;
    let driven_by = |joint: usize| (0..inputs).filter(move |&input| acts(joint, input));
    let drives_one = |input: usize| (0..joints).filter(|&joint| acts(joint, input)).count() == 1;
    (0..joints).map(|joint| driven_by(joint).count() == 1 && driven_by(joint).all(drives_one)).collect()
}

/// A joint that follows other joints, and its limits.
#[derive(Debug, Clone, PartialEq)]
pub struct FollowerLimits {
    /// Name of the following joint.
    pub name: String,
    /// Motion of the following joint per unit of motion of each of the N joints.
    pub ratios: Vec<f64>,
    /// Position of the following joint if all N joints are at 0 [rad or m].
    pub offset: f64,
    /// Lowest and highest position [rad or m].
    pub position: [f64; 2],
    /// Largest speed [rad/s or m/s].
    pub velocity: f64,
}

impl FollowerLimits {
    /// Position or speed of the following joint.
    ///
    /// - `values`: positions or speeds of the N joints
    /// - `offset`: [`Self::offset`] for positions, 0 for speeds
    pub(crate) fn sum(&self, values: impl IntoIterator<Item = f64>, offset: f64) -> f64 {
        // Values of joints that are not followed may be NaN.
        let followed = self.ratios.iter().zip(values).filter(|(ratio, _)| **ratio != 0.0);
        offset + followed.map(|(ratio, value)| ratio * value).sum::<f64>()
    }

    /// Index of the followed joint, and the range of positions and the speed of that joint with which this
    /// joint keeps its limits. `None` if this joint follows several joints.
    pub(crate) fn allowed(&self) -> Option<(usize, [f64; 2], f64)> {
        let mut followed = self.ratios.iter().enumerate().filter(|(_, ratio)| **ratio != 0.0);
        let ((joint, ratio), None) = (followed.next()?, followed.next()) else { return None };
        let ends = self.position.map(|end| (end - self.offset) / ratio);
        Some((joint, [ends[0].min(ends[1]), ends[0].max(ends[1])], self.velocity / ratio.abs()))
    }
}

/// Limits of the joints, narrowed by the limits of joints that follow a single joint.
pub(crate) fn narrowed_limits(robot: &dyn Robot) -> Vec<JointLimits> {
    let mut limits = robot.limits();
    for (joint, [low, high], speed) in robot.followers().iter().filter_map(FollowerLimits::allowed) {
        let Some(JointLimits { position, velocity, .. }) = limits.get_mut(joint) else { continue };
        *position = [position[0].max(low), position[1].min(high)];
        *velocity = velocity.min(speed);
    }
    limits
}

/// Limits of a joint in the description; infinite if the description has none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointLimits {
    /// Lowest and highest position [rad or m].
    pub position: [f64; 2],
    /// Largest speed [rad/s or m/s].
    pub velocity: f64,
    /// Largest force or torque of the drive at the joint [N·m or N].
    pub effort: f64,
}

impl JointLimits {
    /// The limits of a joint without described limits.
    pub(crate) const NONE: Self =
        Self { position: [f64::NEG_INFINITY, f64::INFINITY], velocity: f64::INFINITY, effort: f64::INFINITY };
}
