//! Drives: motors behind gears, with rotors and inputs.

use super::{FollowedCoordinate, FrictionTerm};
use gelenk_formula::{Formula, Function};

/// A drive: one input that acts on one coordinate or on a sum of several.
#[derive(Debug, Clone, PartialEq)]
pub struct Drive {
    /// Name exactly as described; the joint's name if the drive has none.
    pub name: String,
    /// The name as a Rust identifier, distinct among the drives.
    pub identifier: String,
    /// Coordinates whose weighted sum the gear converts to the motor's angle. Empty if its joint is held: the
    /// drive then has no input, but its rotor stays on the carrier.
    pub acts_on: Vec<FollowedCoordinate>,
    /// Gear ratio i: motor angle divided by this sum.
    pub gear_ratio: Formula,
    /// Axial inertia J_R of the rotor (kg m²).
    pub rotor_inertia: Formula,
    /// Link that carries the rotor.
    pub carrier: usize,
    /// Rotor axis in the carrier link's frame, unit length.
    pub axis: [f64; 3],
    /// Effect of the rotor on M.
    pub coupling: RotorCoupling,
    /// The kind of the input.
    pub input: Input,
    /// Torque limits of the motor (N m).
    pub torque: MotorTorque,
    /// Speed limit of the shaft (rad/s). For a drive on one coordinate, that coordinate's limit includes it.
    pub speed: Option<f64>,
    /// Torque–speed line of the motor.
    pub line: Option<TorqueSpeedLine>,
    /// Friction of the shaft as a function of its angle `y` and speed `v`, for a drive on several
    /// coordinates. For a drive on one coordinate it is part of the joint's friction.
    pub friction: Vec<FrictionTerm>,
    /// Whether the drive is described under `[[drives]]` and not at a joint.
    pub stands_apart: bool,
}

impl Drive {
    /// Whether friction of its shaft is discontinuous.
    #[must_use]
    pub fn jumps(&self) -> bool {
        let mut terms = self.friction.iter().filter(|term| !term.coefficient.is_zero());
        terms.any(|term| term.basis.calls(Function::Sign))
    }

    /// The coordinate if it moves only one.
    #[must_use]
    pub fn coordinate(&self) -> Option<usize> {
        match &self.acts_on[..] {
            [only] if only.ratio == Formula::ONE => Some(only.coordinate),
            _ => None,
        }
    }
}

/// Nominal and peak torque of a motor (N m), `None` if not described.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct MotorTorque {
    /// Continuous torque.
    pub nominal: Option<f64>,
    /// Short-time torque.
    pub peak: Option<f64>,
}

/// The torque–speed line of a motor, `|τ + τ₀ ω/ω₀| ≤ τ₀` at its shaft.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TorqueSpeedLine {
    /// τ₀: stall torque (N m).
    pub stall_torque: f64,
    /// ω₀: no-load speed (rad/s).
    pub no_load_speed: f64,
}

/// Effect of a rotor on the equations of motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RotorCoupling {
    /// The rotor is a body on its carrier: i² J_R on the diagonal and coupling terms.
    Body,
    /// The rotor only adds i² J_R to the diagonal.
    Diagonal,
}

/// The kind of an input.
#[derive(Debug, Clone, PartialEq)]
pub enum Input {
    /// Motor torque (N m); the input matrix holds the gear ratio.
    Torque,
    /// No input: a rotor that moves with joints, or friction of a transmission.
    None,
    /// Motor current (A); the input matrix holds gear ratio times motor constant K_M (N m/A).
    Current(Formula),
}
