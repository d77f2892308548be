//! Robot interface of identification, for compiled and interpreted functions alike.

use super::error::{IdentificationError, Result};
use super::pose::QuaternionJoint;
use gelenk_dynamics::dynamics::{Dynamics, Limits, load};
use gelenk_findings::Subject;

/// A robot whose equations of motion are linear in its inertial parameters, `W(y, ẏ, ÿ) π = M ÿ + k − q_g`.
///
/// N joints, M inputs, P parameters. A generated module has these functions; a description that is interpreted
/// has them too. Slices have the lengths stated here: implementations may rely on it.
///
/// Where joints have quaternions ([`Self::quaternion_joints`]), each of their velocities counts as a joint of its own
/// here, and y has one entry more for each of them.
pub trait Robot {
    /// Names of the N joints, as described; of joints with a quaternion those of the velocities.
    fn joint_names(&self) -> Vec<String>;

    /// The part of the robot that a row is about: a joint, or the shaft that takes its row.
    fn subject(&self, row: usize) -> Subject {
        Subject::Joint(self.joint_names().swap_remove(row))
    }

    /// Names of the M inputs, as described.
    fn input_names(&self) -> Vec<String>;

    /// Unit of each joint's position: `rad` or `m`.
    fn position_units(&self) -> Vec<&'static str>;

    /// Limits of each joint.
    fn limits(&self) -> Vec<JointLimits>;

    /// Names of the P inertial parameters: ten for each body (m, m c, moments about the frame's origin), then
    /// one for each rotor, as in a generated module's `INERTIAL_PARAMETER_NAMES`.
    fn parameter_names(&self) -> Vec<String>;

    /// The described values of the parameters, in the same order.
    fn parameters(&self) -> Vec<f64>;

    /// Number of bodies: the first `10 · bodies` parameters are theirs.
    fn bodies(&self) -> usize;

    /// The joints that follow others, with limits of their own; those that follow driven joints are not among them.
    fn followers(&self) -> Vec<FollowerLimits> {
        Vec::new()
    }

    /// The joints with a quaternion, in the order of their positions.
    fn quaternion_joints(&self) -> Vec<QuaternionJoint> {
        Vec::new()
    }

    /// B, `N × M`, rows first: joint forces of unit inputs; columns of inputs that act at frames are zero.
    fn input_matrix(&self) -> Vec<f64>;

    /// For each input, whether it is a current as described, so that B holds its motor constant.
    fn described_currents(&self) -> Vec<bool> {
        vec![false; self.input_names().len()]
    }

    /// Whether inputs act at frames: B depends on the positions then, and efforts must be forces at the
    /// joints.
    fn has_inputs_at_frames(&self) -> bool {
        false
    }

    /// Lowest and highest value of each input, in its unit; infinite if not described.
    fn input_limits(&self) -> Vec<[f64; 2]> {
        vec![[f64::NEG_INFINITY, f64::INFINITY]; self.input_names().len()]
    }

    /// Torque–speed lines of motors.
    fn torque_speed_lines(&self) -> Vec<TorqueSpeedLine> {
        Vec::new()
    }

    /// `B(y) u`, inputs at frames included.
    fn input_forces(&self, y: &[f64], u: &[f64], forces: &mut [f64]) {
        let _ = y;
        for (force, row) in forces.iter_mut().zip(self.input_matrix().chunks_exact(u.len().max(1))) {
            *force = row.iter().zip(u).map(|(b, u)| b * u).sum();
        }
    }

    /// For each joint, whether something else moves it, as a linear axis under a robot: logs have its motion, and not its
    /// force.
    fn unmeasured(&self) -> Vec<bool> {
        vec![false; self.joint_names().len()]
    }

    /// For each joint, whether an input drives it and nothing else. The load of such a gear is known, so that friction
    /// can grow with it.
    fn own_inputs(&self) -> Vec<bool> {
        own_inputs(&self.input_matrix(), self.joint_names().len(), self.input_names().len())
    }

    /// For each row, a joint's or that of one of [`Self::shafts`]: whether additional inertia of its drive may be estimated.
    /// It may not if the drive's rotor is among the parameters, or if no drive could be written with it.
    fn takes_inertia(&self) -> Vec<bool> {
        vec![true; self.joint_names().len()]
    }

    /// Drives that act on several joints, and whose shafts' friction is to be found. None takes the row of a joint that
    /// another one takes, that has a drive of its own, or that something else moves.
    fn shafts(&self) -> Vec<Shaft> {
        Vec::new()
    }

    /// How many times as fast as a joint each row is: terms of friction are looked for at speeds that differ by these.
    fn speed_scales(&self) -> Vec<f64> {
        vec![1.0; self.joint_names().len()]
    }

    /// Terms of the friction that is described on joints whose rows shafts take.
    fn joint_terms(&self) -> Vec<JointTerm> {
        Vec::new()
    }

    /// Values of the functions of these terms, without their factors, at positions y and velocities ẏ.
    fn joint_term_values(&self, y: &[f64], v: &[f64], values: &mut [f64]) {
        let _ = (y, v);
        values.fill(0.0);
    }

    /// Described friction of a row, a joint's or that of one of [`Self::shafts`], at its speed v: the force against the motion,
    /// without friction under load. Zero if none is described.
    fn friction(&self, row: usize, v: f64) -> f64 {
        let _ = (row, v);
        0.0
    }

    /// Gravity in the axes of the base, as described \[m/s²\]; `None` if no other direction of it can be tried
    /// ([`Self::regressor_at_rest`]).
    fn gravity(&self) -> Option<[f64; 3]> {
        None
    }

    /// `W` at positions y and at rest under another gravity \[m/s²\], as [`Self::inertial_regressor`]. Robots with
    /// [`Self::gravity`] have it.
    fn regressor_at_rest(&self, y: &[f64], gravity: [f64; 3], regressor: &mut [f64]) {
        let _ = (y, gravity);
        regressor.fill(0.0);
    }

    /// `W`, `N × P`, rows first, at positions y [rad or m], velocities ẏ and accelerations ÿ.
    fn inertial_regressor(&self, y: &[f64], v: &[f64], a: &[f64], regressor: &mut [f64]);

    /// `M ÿ + k − q` with the described parameters, without friction of joints and of [`Self::shafts`], one entry for each joint [N·m or N].
    /// It contains springs and other forces that are not inertial, which `W π` does not.
    fn rigid_forces(&self, y: &[f64], v: &[f64], a: &[f64], forces: &mut [f64]);
}

/// Positions, velocities and accelerations of all joints at one time.
pub type Instant = [Vec<f64>; 3];

/// A drive that acts on several joints, whose friction is that of its shaft.
#[derive(Debug, Clone, PartialEq)]
pub struct Shaft {
    /// Name of the drive, as described.
    pub name: String,
    /// The joint whose row the shaft takes: one without a drive of its own.
    pub joint: usize,
    /// Motion of the shaft for a unit of motion of each of the N joints: gear ratio times weight [1 or rad/m].
    pub ratios: Vec<f64>,
    /// Largest torque of the motor [N·m]; infinite if it is not described.
    pub torque: f64,
}

/// A motor that gives less torque the faster it turns, `|u + C ẏ| ≤ limit`.
#[derive(Debug, Clone, PartialEq)]
pub struct TorqueSpeedLine {
    /// Number of the input.
    pub input: usize,
    /// C: the torque that the velocity of each of the N joints takes from the input, in its unit.
    pub slopes: Vec<f64>,
    /// Largest input of the motor at rest, in the unit of the input.
    pub limit: f64,
}

impl TorqueSpeedLine {
    /// Lowest and highest input at velocities ẏ.
    #[must_use]
    pub(crate) fn range(&self, v: &[f64]) -> [f64; 2] {
        let taken: f64 = self.slopes.iter().zip(v).map(|(slope, v)| slope * v).sum();
        [-self.limit - taken, self.limit - taken]
    }
}

/// A term of friction that is described on a joint whose row a shaft takes.
#[derive(Debug, Clone, PartialEq)]
pub struct JointTerm {
    /// Number of the joint.
    pub joint: usize,
    /// Function of the joint's velocity `v`, as described.
    pub basis: String,
    /// Its described factor.
    pub coefficient: f64,
}

/// Refuses robots of which something else moves a joint.
///
/// - `what`: the omitted action, as the beginning of a sentence
///
/// # Errors
/// [`IdentificationError::File`] with the name of such a joint.
pub(crate) fn require_no_driven(robot: &dyn Robot, what: &str, help: &str) -> Result<()> {
    let names = robot.joint_names().into_iter().zip(robot.unmeasured());
    match names.filter(|(_, unmeasured)| *unmeasured).map(|(name, _)| name).next() {
        Some(joint) => Err(IdentificationError::File {
            place: format!("joint {joint}"),
            message: format!("{what} where a joint is driven: {help}"),
        }),
        None => Ok(()),
    }
}

/// Refuses robots with quaternions.
///
/// - `what`: the omitted action, as the beginning of a sentence
///
/// # Errors
/// [`IdentificationError::File`] with the name of such a joint.
pub(crate) fn require_no_quaternions(robot: &dyn Robot, what: &str, help: &str) -> Result<()> {
    let Some(joint) = robot.quaternion_joints().into_iter().next() else { return Ok(()) };
    let kind = if joint.is_floating { "floating" } else { "spherical" };
    Err(IdentificationError::File {
        place: format!("joint {}", joint.name),
        message: format!("{what} where a joint is {kind}: {help}"),
    })
}

/// Joints whose row of B has one entry, in a column with no other.
fn own_inputs(b: &[f64], joints: usize, inputs: usize) -> Vec<bool> {
    let acts = |joint: usize, input: usize| b[joint * inputs + input] != 0.0;
    let driven_by = |joint: usize| (0..inputs).filter(move |&input| acts(joint, input));
    let drives_one = |input: usize| (0..joints).filter(|&joint| acts(joint, input)).count() == 1;
    (0..joints).map(|joint| driven_by(joint).count() == 1 && driven_by(joint).all(drives_one)).collect()
}

/// A joint that follows others, and its limits.
#[derive(Debug, Clone, PartialEq)]
pub struct FollowerLimits {
    /// Its name.
    pub name: String,
    /// Its motion for a unit of motion of each of the N joints.
    pub ratios: Vec<f64>,
    /// Its position where all of them stand at 0 [rad or m].
    pub offset: f64,
    /// Lowest and highest position [rad or m].
    pub position: [f64; 2],
    /// Largest speed [rad/s or m/s].
    pub velocity: f64,
}

impl FollowerLimits {
    /// Its position or speed, given those of the joints; `offset` is that of a position, or 0.
    pub(crate) fn sum(&self, values: impl IntoIterator<Item = f64>, offset: f64) -> f64 {
        // Nothing needs to be known of what it does not follow.
        let followed = self.ratios.iter().zip(values).filter(|(ratio, _)| **ratio != 0.0);
        offset + followed.map(|(ratio, value)| ratio * value).sum::<f64>()
    }

    /// The joint that it follows, if it is the only one, with the range that it leaves: position and speed.
    pub(crate) fn allowed(&self) -> Option<(usize, [f64; 2], f64)> {
        let mut followed = self.ratios.iter().enumerate().filter(|(_, ratio)| **ratio != 0.0);
        let ((joint, ratio), None) = (followed.next()?, followed.next()) else { return None };
        let ends = self.position.map(|end| (end - self.offset) / ratio);
        Some((joint, [ends[0].min(ends[1]), ends[0].max(ends[1])], self.velocity / ratio.abs()))
    }
}

/// Limits of the joints, narrowed to what joints allow that follow one of them alone.
pub(crate) fn narrowed_limits(robot: &dyn Robot) -> Vec<JointLimits> {
    let mut limits = robot.limits();
    for (joint, [low, high], speed) in robot.followers().iter().filter_map(FollowerLimits::allowed) {
        let Some(JointLimits { position, velocity, .. }) = limits.get_mut(joint) else { continue };
        *position = [position[0].max(low), position[1].min(high)];
        *velocity = velocity.min(speed);
    }
    limits
}

/// Limits of a joint, as described; infinite if not described.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointLimits {
    /// Lowest and highest position [rad or m].
    pub position: [f64; 2],
    /// Largest speed [rad/s or m/s].
    pub velocity: f64,
    /// Largest force [N·m or N].
    pub effort: f64,
}

impl JointLimits {
    /// Nothing is described.
    pub(crate) const NONE: Self =
        Self { position: [f64::NEG_INFINITY, f64::INFINITY], velocity: f64::INFINITY, effort: f64::INFINITY };
}

/// W at y, ẏ, ÿ, as a generated module's `inertial_regressor`.
type Regressor<const N: usize, const P: usize> = fn(&[f64; N], &[f64; N], &[f64; N]) -> [[f64; P]; N];

/// A generated module as a [`Robot`]: its [`Dynamics`] and its `inertial_regressor`.
///
/// ```
/// use gelenk_generated::powercube as module;
/// use gelenk_identification::robot::{Generated, Robot};
/// gelenk_dynamics::dynamics!(struct PowerCube = gelenk_generated::powercube);
///
/// let robot = Generated {
///     model: PowerCube,
///     units: module::JOINT_UNITS,
///     parameter_names: module::INERTIAL_PARAMETER_NAMES,
///     parameters: module::inertial_parameters(),
///     bodies: 2,
///     regressor: module::inertial_regressor,
/// };
/// assert_eq!(robot.joint_names(), ["beta", "gamma"]);
/// ```
#[derive(Debug, Clone)]
pub struct Generated<D, const N: usize, const M: usize, const P: usize> {
    /// The module's functions.
    pub model: D,
    /// Its `JOINT_UNITS`.
    pub units: [&'static str; N],
    /// Its `INERTIAL_PARAMETER_NAMES`.
    pub parameter_names: [&'static str; P],
    /// Its `inertial_parameters()`.
    pub parameters: [f64; P],
    /// Number of bodies; behind their `10 · bodies` parameters stand those of the rotors.
    pub bodies: usize,
    /// Its `inertial_regressor`.
    pub regressor: Regressor<N, P>,
}

impl<D: Dynamics<N, M>, const N: usize, const M: usize, const P: usize> Robot for Generated<D, N, M, P> {
    fn joint_names(&self) -> Vec<String> {
        self.model.joint_names().map(String::from).to_vec()
    }

    fn input_names(&self) -> Vec<String> {
        self.model.input_names().map(String::from).to_vec()
    }

    fn position_units(&self) -> Vec<&'static str> {
        self.units.to_vec()
    }

    fn limits(&self) -> Vec<JointLimits> {
        let Limits { position, velocity, effort, .. } = self.model.limits();
        let of = |j: usize| JointLimits { position: position[j], velocity: velocity[j], effort: effort[j] };
        (0..N).map(of).collect()
    }

    fn input_limits(&self) -> Vec<[f64; 2]> {
        self.model.limits().peak_input.to_vec()
    }

    fn torque_speed_lines(&self) -> Vec<TorqueSpeedLine> {
        let lines = self.model.limits().torque_speed.iter();
        let line = |line: &gelenk_dynamics::dynamics::TorqueSpeedLine<N>| TorqueSpeedLine {
            input: line.input,
            slopes: line.slopes.to_vec(),
            limit: line.limit,
        };
        lines.map(line).collect()
    }

    fn followers(&self) -> Vec<FollowerLimits> {
        let joints = self.model.limits().dependent.iter().filter(|joint| !joint.follows_driven_joints());
        let limits = joints.map(|joint| FollowerLimits {
            name: joint.name.to_owned(),
            ratios: joint.ratios.to_vec(),
            offset: joint.offset,
            position: joint.position,
            velocity: joint.velocity,
        });
        limits.collect()
    }

    fn parameter_names(&self) -> Vec<String> {
        self.parameter_names.map(String::from).to_vec()
    }

    fn parameters(&self) -> Vec<f64> {
        self.parameters.to_vec()
    }

    fn bodies(&self) -> usize {
        self.bodies
    }

    fn input_matrix(&self) -> Vec<f64> {
        self.model.drive_matrix().concat()
    }

    fn has_inputs_at_frames(&self) -> bool {
        self.model.drives() < M
    }

    fn friction(&self, row: usize, v: f64) -> f64 {
        let speeds = std::array::from_fn(|joint| if joint == row { v } else { 0.0 });
        self.model.friction_torques(&[0.0; N], &speeds)[row]
    }

    fn inertial_regressor(&self, y: &[f64], v: &[f64], a: &[f64], regressor: &mut [f64]) {
        let [y, v, a] = [y, v, a].map(columns::<N>);
        for (row, values) in regressor.chunks_exact_mut(P).zip((self.regressor)(&y, &v, &a)) {
            row.copy_from_slice(&values);
        }
    }

    fn rigid_forces(&self, y: &[f64], v: &[f64], a: &[f64], forces: &mut [f64]) {
        let [y, v, a] = [y, v, a].map(columns::<N>);
        let all = self.model.inverse_dynamics(&y, &v, &a);
        let (friction, shares) = (self.model.friction_torques(&y, &v), self.model.load_friction(&y, &v));
        for (j, force) in forces.iter_mut().enumerate() {
            *force = load(all[j] - friction[j], shares[j]);
        }
    }
}

/// The first N values; the trait promises that there are N.
fn columns<const N: usize>(values: &[f64]) -> [f64; N] {
    std::array::from_fn(|i| values[i])
}
