//! Formulas as values, and the limit for their numbers.

use super::function::Function;

/// Largest magnitude of a number in a description. Products of ten such numbers do not overflow.
pub const LARGEST_NUMBER: f64 = 1e30;

/// Message for the number `what`, whose magnitude exceeds [`LARGEST_NUMBER`].
pub fn too_large(what: &str) -> String {
    format!("{what} exceeds the largest number {LARGEST_NUMBER:e}; the equations would overflow")
}

/// A scalar expression over parameters and, in force laws, the joint's position `y` and velocity `v`.
///
/// Numbers of a model that may depend on free parameters are formulas (`mass = "m1"`, `xyz = ["l1/2", 0, 0]`).
/// Force laws are formulas, too (`a1*v + a2*tanh(a3*v)`). A formula is a tree without shared parts. The
/// derivation of the dynamics converts formulas to nodes of the expression graph, which folds, shares and
/// differentiates them.
#[derive(Debug, Clone, PartialEq)]
pub enum Formula {
    /// A finite number as constant.
    Number(f64),
    /// A free parameter of the robot, as an index into `Model::parameters`.
    Parameter(usize),
    /// The position `y` of the joint that carries the force law (rad or m).
    Position,
    /// The velocity `v` of the joint that carries the force law (rad/s or m/s).
    Velocity,
    /// `-a`
    Negate(Box<Formula>),
    /// `a + b`
    Add(Box<Formula>, Box<Formula>),
    /// `a - b`
    Subtract(Box<Formula>, Box<Formula>),
    /// `a * b`
    Multiply(Box<Formula>, Box<Formula>),
    /// `a / b`
    Divide(Box<Formula>, Box<Formula>),
    /// `a.powi(n)` with n ≥ 0
    Power(Box<Formula>, u32),
    /// `f(a)` with an elementary function `f`, for example `sin(a)`
    Call(Function, Box<Formula>),
}
