//! The elementary functions of generated code.

use gelenk_kernels::math;

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
    /// Absolute value. Its derivative is `sign`.
    Abs,
    /// Sign: −1, 0 or 1. Its derivative is set to 0, also at the jump.
    Sign,
    /// Square root. It is NaN for negative numbers.
    Sqrt,
}

impl Function {
    /// All functions, in the order of their declaration.
    pub const ALL: [Self; 7] =
        [Self::Sin, Self::Cos, Self::Tanh, Self::Exp, Self::Abs, Self::Sign, Self::Sqrt];

    /// The function's name in formulas, for example `sin`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Sin => "sin",
            Self::Cos => "cos",
            Self::Tanh => "tanh",
            Self::Exp => "exp",
            Self::Abs => "abs",
            Self::Sign => "sign",
            Self::Sqrt => "sqrt",
        }
    }

    /// Value of the function. `sign` is 0 at 0, unlike [`f64::signum`].
    pub fn evaluate(self, x: f64) -> f64 {
        match self {
            Self::Sin => math::sin_cos(x).0,
            Self::Cos => math::sin_cos(x).1,
            Self::Tanh => math::tanh(x),
            Self::Exp => math::exp(x),
            Self::Abs => x.abs(),
            Self::Sign if x > 0.0 => 1.0,
            Self::Sign if x < 0.0 => -1.0,
            Self::Sign => x * 0.0,
            Self::Sqrt => x.sqrt(),
        }
    }
}
