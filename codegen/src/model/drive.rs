//! Drives: motors behind gears, with rotors and inputs.

use super::{FollowedCoordinate, FrictionTerm};
use gelenk_formula::{Formula, Function};

/// A drive: one input, acting on one coordinate or on the sum of several.
#[derive(Debug, Clone, PartialEq)]
pub struct Drive {
    /// Name in the description, to the letter; that of the joint if the drive has none of its own.
    pub name: String,
    /// The name as a Rust identifier, distinct among the drives.
    pub identifier: String,
    /// The coordinates whose weighted sum its gear turns into the motor's angle; empty if its joint is held:
    /// no input then, but its rotor stays on the carrier.
    pub acts_on: Vec<FollowedCoordinate>,
    /// Gear ratio i: motor angle over that sum.
    pub gear_ratio: Formula,
    /// Axial inertia J_R of the rotor (kg m²).
    pub rotor_inertia: Formula,
    /// Link that carries the rotor.
    pub carrier: usize,
    /// Rotor axis in the carrier link's frame, unit length.
    pub axis: [f64; 3],
    /// How the rotor enters M.
    pub coupling: RotorCoupling,
    /// The kind of the input.
    pub input: Input,
    /// Limits of the input's torque at the motor (N m).
    pub torque: MotorTorque,
    /// Highest speed of its shaft (rad/s). Where it moves one coordinate, that coordinate's limit contains it.
    pub speed: Option<f64>,
    /// Torque that the motor loses with its speed.
    pub line: Option<TorqueSpeedLine>,
    /// Friction of the shaft over its angle `y` and speed `v`, where the drive acts on several coordinates; that of a
    /// drive on one coordinate is part of its joint's.
    pub friction: Vec<FrictionTerm>,
    /// Whether it is described by itself, with `[[drives]]`, and not at a joint.
    pub stands_apart: bool,
}

impl Drive {
    /// Whether friction of its shaft jumps.
    #[must_use]
    pub fn jumps(&self) -> bool {
        let mut terms = self.friction.iter().filter(|term| !term.coefficient.is_zero());
        terms.any(|term| term.basis.calls(Function::Sign))
    }

    /// The coordinate that it moves, where it moves that one alone.
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
    /// The torque that the motor bears continuously.
    pub nominal: Option<f64>,
    /// The torque that the motor bears for a short time.
    pub peak: Option<f64>,
}

/// The torque–speed line of a motor, `|τ + τ₀ ω/ω₀| ≤ τ₀` at its shaft.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TorqueSpeedLine {
    /// τ₀: torque at rest (N m).
    pub stall_torque: f64,
    /// ω₀: speed without load (rad/s).
    pub no_load_speed: f64,
}

/// How the rotor enters the equations of motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RotorCoupling {
    /// A body carried by its link: diagonal i² J_R and the coupling terms.
    Body,
    /// Only i² J_R on the diagonal.
    Diagonal,
}

/// The kind of an input.
#[derive(Debug, Clone, PartialEq)]
pub enum Input {
    /// Motor torque (N m); the input matrix holds the gear ratio.
    Torque,
    /// None: a rotor that moves with joints by itself, or friction of a transmission.
    None,
    /// Motor current (A); the input matrix holds gear ratio times motor constant K_M (N m/A).
    Current(Formula),
}
