//! Scalar formulas as a description writes them: numbers, parameters, the joint's own position and velocity.
//!
//! A [`Formula`] is plain data without sharing. It is what a model carries wherever a number may also be a
//! free parameter (`mass = "m1"`, `xyz = ["l1/2", 0, 0]`) and what force laws are (`a1*v + a2*tanh(a3*v)`).
//! The dynamics turn it into nodes of the expression graph, where it is folded, shared and differentiated.

mod arithmetic;
mod display;
mod energy;
pub(crate) mod error;
mod habits;
pub(crate) mod parse;
mod terms;

/// Largest number of a description: far beyond any robot, and products of ten of them are finite.
pub(crate) const LARGEST_NUMBER: f64 = 1e30;

/// The message about a number beyond [`LARGEST_NUMBER`].
pub(crate) fn too_large(what: &str) -> String {
    format!("{what} is beyond {LARGEST_NUMBER:e}, where the equations overflow")
}

/// A scalar expression over parameters and, in force laws, the joint's position `y` and velocity `v`.
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

/// The functions of one argument that a formula may call.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Function {
    /// Sine of an angle in radians.
    Sin,
    /// Cosine of an angle in radians.
    Cos,
    /// Hyperbolic tangent.
    Tanh,
    /// Natural exponential.
    Exp,
    /// Absolute value; its derivative is `sign`.
    Abs,
    /// −1, 0 or 1; exact in the value, derivative zero.
    Sign,
    /// Square root; NaN of negative numbers.
    Sqrt,
}

impl Formula {
    /// Tells whether the formula calls a function.
    pub fn calls(&self, function: Function) -> bool {
        match self {
            Self::Number(_) | Self::Parameter(_) | Self::Position | Self::Velocity => false,
            Self::Negate(a) | Self::Power(a, _) => a.calls(function),
            Self::Add(a, b) | Self::Subtract(a, b) | Self::Multiply(a, b) | Self::Divide(a, b) => {
                a.calls(function) || b.calls(function)
            }
            Self::Call(called, a) => *called == function || a.calls(function),
        }
    }
}
