//! Formulas as values, and the largest numbers in them.

use super::function::Function;

/// Largest number of a description: far beyond any robot, and products of ten of them are finite.
pub const LARGEST_NUMBER: f64 = 1e30;

/// The message about a number beyond [`LARGEST_NUMBER`].
pub fn too_large(what: &str) -> String {
    format!("{what} is beyond {LARGEST_NUMBER:e}, where the equations overflow")
}

/// A scalar expression over parameters and, in force laws, the joint's position `y` and velocity `v`.
///
/// A formula is plain data without sharing. It is what a model carries wherever a number may also be a free
/// parameter (`mass = "m1"`, `xyz = ["l1/2", 0, 0]`) and what force laws are (`a1*v + a2*tanh(a3*v)`). The dynamics
/// turn it into nodes of the expression graph, which folds, shares and differentiates it.
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
    /// `a.powi(n)`, n ≥ 0
    Power(Box<Formula>, u32),
    /// `f(a)`
    Call(Function, Box<Formula>),
}
