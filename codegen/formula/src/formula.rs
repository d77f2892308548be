//! Formulas as values, and the limit for their numbers.

use super::function::Function;

/// Largest number of a description. It is far beyond any robot, and products of ten such numbers are finite.
pub const LARGEST_NUMBER: f64 = 1e30;

/// Message for a number beyond [`LARGEST_NUMBER`].
pub fn too_large(what: &str) -> String {
    format!("{what} is beyond {LARGEST_NUMBER:e}, where the equations overflow")
}

/// A scalar expression over parameters and, in force laws, the joint's position `y` and velocity `v`.
///
/// A formula is a tree of plain data, without shared parts. In a model, numbers that may depend on free
/// parameters are formulas (`mass = "m1"`, `xyz = ["l1/2", 0, 0]`). Force laws are formulas, too
/// (`a1*v + a2*tanh(a3*v)`). The derivation of the dynamics converts formulas to nodes of the expression
/// graph. The graph folds, shares and differentiates them.
#[derive(Debug, Clone, PartialEq)]
pub enum Formula {
    /// A finite number.
    Number(f64),
    /// A free parameter: index into `Model::parameters`.
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
    /// `f(a)`
    Call(Function, Box<Formula>),
}
