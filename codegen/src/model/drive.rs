//! Drives: motors with gears, rotors and inputs.

use super::{FollowedCoordinate, FrictionTerm};
use gelenk_formula::{Formula, Function};

/// A drive: one input that acts on one coordinate or on a weighted sum of coordinates.
#[derive(Debug, Clone, PartialEq)]
pub struct Drive {
    /// Name of the drive as in the description; the joint's name if the drive has no name.
    pub name: String,
    /// Name of the drive as a Rust identifier, distinct among the drives.
    pub identifier: String,
    /// Coordinates on which the drive acts, with ratios. The gear converts their weighted sum to the motor's
    /// angle. Empty if the drive's joint is held: the drive then has no input, but its rotor stays on the
    /// carrier.
    pub acts_on: Vec<FollowedCoordinate>,
    /// Gear ratio i: motor angle divided by the weighted sum of the coordinates.
    pub gear_ratio: Formula,
    /// Axial inertia J_R of the rotor (kg m²).
    pub rotor_inertia: Formula,
    /// Index of the link that carries the rotor.
    pub carrier: usize,
    /// Axis of the rotor in the frame of the carrier link, with unit length.
    pub axis: [f64; 3],
    /// Effect of the rotor on the mass matrix: as a body, or only on the diagonal.
    pub coupling: RotorCoupling,
    /// Kind of the drive's input: torque, current, or none.
    pub input: Input,
    /// Torque limits of the motor (N m).
    pub torque: MotorTorque,
    /// Speed limit of the motor's shaft (rad/s); `None` without a limit. For a drive on one coordinate, it
    /// also lowers the speed limit of the joint.
    pub speed: Option<f64>,
    /// Torque–speed line of the motor; `None` without a line.
    pub line: Option<TorqueSpeedLine>,
    /// Friction of the shaft as a function of the shaft's angle `y` and speed `v`, for a drive on several
    /// coordinates. Empty for a drive on one coordinate, because the joint's friction includes this friction.
    pub friction: Vec<FrictionTerm>,
    /// Whether the description defines the drive in the list `[[drives]]` and not at a joint.
    pub stands_apart: bool,
}

impl Drive {
    /// Whether the friction of the drive's shaft is discontinuous in the velocity.
    #[must_use]
    pub fn jumps(&self) -> bool {
        let mut terms = self.friction.iter().filter(|term| !term.coefficient.is_zero());
        terms.any(|term| term.basis.calls(Function::Sign))
    }

    /// The coordinate on which the drive acts, if there is exactly one and its ratio is 1; otherwise `None`.
    #[must_use]
    pub fn coordinate(&self) -> Option<usize> {
        match &self.acts_on[..] {
            [only] if only.ratio == Formula::ONE => Some(only.coordinate),
            _ => None,
        }
    }
}

/// Nominal and peak torque of a motor (N m); `None` without a value in the description.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct MotorTorque {
    /// Torque that the motor tolerates continuously (N m).
    pub nominal: Option<f64>,
    /// Torque that the motor tolerates for a short time (N m).
    pub peak: Option<f64>,
}

/// The torque–speed line of a motor: `|τ + τ₀ ω/ω₀| ≤ τ₀` with the torque τ and the speed ω of its shaft.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TorqueSpeedLine {
    /// Stall torque τ₀ of the motor (N m).
    pub stall_torque: f64,
    /// No-load speed ω₀ of the motor's shaft (rad/s).
    pub no_load_speed: f64,
}

/// Effect of a rotor with the gear ratio i and the axial inertia J_R on the equations of motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RotorCoupling {
    /// The rotor is a body on its carrier, with the gear ratio i and the axial inertia J_R. It adds i² J_R to
    /// the diagonal of the mass matrix, and terms that couple it with the motion of its carrier.
    Body,
    /// The rotor only adds i² J_R to the diagonal of the mass matrix, with the gear ratio i and the axial
    /// inertia J_R.
    Diagonal,
}

/// Kind of a drive's input: torque, current, or none.
#[derive(Debug, Clone, PartialEq)]
pub enum Input {
    /// Motor torque (N m) as input. Its entry in the input matrix is the gear ratio.
    Torque,
    /// No input. The drive only describes a rotor that moves with joints, or friction of a transmission.
    None,
    /// Motor current (A) as input. Its entry in the input matrix is the gear ratio times the motor constant
    /// K_M (N m/A).
    Current(Formula),
}
