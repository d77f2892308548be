//! Building, folding and evaluating formulas.

use super::formula::{Formula, LARGEST_NUMBER};
use super::function::Function;

impl Formula {
    /// The number 0.
    pub const ZERO: Self = Self::Number(0.0);
    /// The number 1.
    pub const ONE: Self = Self::Number(1.0);

    /// Value of a formula that is a number; `None` for all other formulas.
    pub fn as_number(&self) -> Option<f64> {
        match self {
            Self::Number(value) => Some(*value),
            _ => None,
        }
    }

    /// Whether the formula is the number 0.
    pub fn is_zero(&self) -> bool {
        self.as_number() == Some(0.0)
    }

    /// Evaluates the formula.
    ///
    /// - `parameters`: values in the order of `Model::parameters`; a parameter without a value is NaN
    /// - `position`, `velocity`: position and velocity of the joint with the force law
    pub fn evaluate(&self, parameters: &[f64], position: f64, velocity: f64) -> f64 {
        let value = |part: &Self| part.evaluate(parameters, position, velocity);
        match self {
            Self::Number(number) => *number,
            Self::Parameter(index) => parameters.get(*index).copied().unwrap_or(f64::NAN),
            Self::Position => position,
            Self::Velocity => velocity,
            Self::Negate(a) => -value(a),
            Self::Add(a, b) => value(a) + value(b),
            Self::Subtract(a, b) => value(a) - value(b),
            Self::Multiply(a, b) => value(a) * value(b),
            Self::Divide(a, b) => value(a) / value(b),
            Self::Power(a, exponent) => power(value(a), *exponent),
            Self::Call(function, a) => function.evaluate(value(a)),
        }
    }

    /// Value of the formula for these parameters. `None` if the formula depends on other parameters, on
    /// position or on velocity.
    pub fn value(&self, parameters: &[f64]) -> Option<f64> {
        let is_open = |part: &Self| match part {
            Self::Position | Self::Velocity => true,
            Self::Parameter(index) => *index >= parameters.len(),
            _ => false,
        };
        (!self.any(&is_open)).then(|| self.evaluate(parameters, f64::NAN, f64::NAN))
    }

    /// Whether `test` is true for any operation, number or name in the formula.
    pub fn any(&self, test: &dyn Fn(&Self) -> bool) -> bool {
        test(self)
            || match self {
                Self::Number(_) | Self::Parameter(_) | Self::Position | Self::Velocity => false,
                Self::Negate(a) | Self::Power(a, _) | Self::Call(_, a) => a.any(test),
                Self::Add(a, b) | Self::Subtract(a, b) | Self::Multiply(a, b) | Self::Divide(a, b) => {
                    a.any(test) || b.any(test)
                }
            }
    }

    /// Whether the formula calls a function.
    pub fn calls(&self, function: Function) -> bool {
        self.any(&|node| matches!(node, Self::Call(called, _) if *called == function))
    }

    /// Whether the value depends on the joint's position or velocity.
    pub fn depends_on_motion(&self) -> bool {
        self.any(&|node| matches!(node, Self::Position | Self::Velocity))
    }

    /// Whether the value depends on the joint's position.
    pub fn depends_on_position(&self) -> bool {
        self.any(&|node| matches!(node, Self::Position))
    }

    /// Whether every number in the formula is finite.
    pub fn is_finite(&self) -> bool {
        !self.any(&|node| matches!(node, Self::Number(value) if !value.is_finite()))
    }

    /// Whether the magnitude of a number in the formula exceeds [`LARGEST_NUMBER`].
    pub fn is_too_large(&self) -> bool {
        self.any(&|node| matches!(node, Self::Number(value) if value.abs() > LARGEST_NUMBER))
    }

    /// The sum `a + b`. Numbers are added, and zeros are dropped.
    pub fn sum(a: Self, b: Self) -> Self {
        match (&a, &b) {
            (Self::Number(x), Self::Number(y)) => Self::Number(x + y),
            (Self::Number(0.0), _) => b,
            (_, Self::Number(0.0)) => a,
            _ => Self::Add(Box::new(a), Box::new(b)),
        }
    }

    /// The difference `a - b`. Numbers are subtracted, and zeros are dropped.
    pub fn difference(a: Self, b: Self) -> Self {
        match (&a, &b) {
            (Self::Number(x), Self::Number(y)) => Self::Number(x - y),
            (Self::Number(0.0), _) => Self::negation(b),
            (_, Self::Number(0.0)) => a,
            _ => Self::Subtract(Box::new(a), Box::new(b)),
        }
    }

    /// The product `a * b`. Numbers are multiplied, and factors 0, 1 and −1 are simplified.
    pub fn product(a: Self, b: Self) -> Self {
        match (&a, &b) {
            (Self::Number(x), Self::Number(y)) => Self::Number(x * y),
            (Self::Number(0.0), _) | (_, Self::Number(0.0)) => Self::ZERO,
            (Self::Number(1.0), _) => b,
            (_, Self::Number(1.0)) => a,
            (Self::Number(-1.0), _) => Self::negation(b),
            (_, Self::Number(-1.0)) => Self::negation(a),
            _ => Self::Multiply(Box::new(a), Box::new(b)),
        }
    }

    /// The quotient `a / b`. Numbers are divided, and a divisor of 1 is dropped.
    pub fn quotient(a: Self, b: Self) -> Self {
        match (&a, &b) {
            (Self::Number(x), Self::Number(y)) => Self::Number(x / y),
            (_, Self::Number(1.0)) => a,
            _ => Self::Divide(Box::new(a), Box::new(b)),
        }
    }

    /// The negation `-a`. A number is negated, and `-(-a)` becomes `a`.
    pub fn negation(a: Self) -> Self {
        match a {
            Self::Number(value) => Self::Number(0.0 - value),
            Self::Negate(inner) => *inner,
            other => Self::Negate(Box::new(other)),
        }
    }

    /// The power `aⁿ` with n ≥ 0. Powers of numbers are evaluated, and the exponents 0 and 1 are simplified.
    pub fn power(a: Self, exponent: u32) -> Self {
        match (a, exponent) {
            (_, 0) => Self::ONE,
            (a, 1) => a,
            (Self::Number(value), _) => Self::Number(power(value, exponent)),
            (a, _) => Self::Power(Box::new(a), exponent),
        }
    }

    /// Returns the formula with replaced parts: if `other` returns a formula for a part, this formula replaces
    /// the part. Constants are folded again.
    pub fn substituted(&self, other: &dyn Fn(&Self) -> Option<Self>) -> Self {
        if let Some(other) = other(self) {
            return other;
        }
        let go = |part: &Self| part.substituted(other);
        match self {
            Self::Number(_) | Self::Parameter(_) | Self::Position | Self::Velocity => self.clone(),
            Self::Negate(a) => Self::negation(go(a)),
            Self::Add(a, b) => Self::sum(go(a), go(b)),
            Self::Subtract(a, b) => Self::difference(go(a), go(b)),
            Self::Multiply(a, b) => Self::product(go(a), go(b)),
            Self::Divide(a, b) => Self::quotient(go(a), go(b)),
            Self::Power(a, exponent) => Self::power(go(a), *exponent),
            Self::Call(function, a) => Self::call(*function, go(a)),
        }
    }

    /// The formula with `tanh(slope · x)` instead of `sign x`, and with `tanh²(slope · x)` instead of
    /// `|sign x|`. Both replacements are smooth.
    pub fn with_smooth_sign(&self, slope: f64) -> Self {
        let smooth = |x: &Self| {
            let x = x.with_smooth_sign(slope);
            Self::call(Function::Tanh, Self::product(Self::Number(slope), x))
        };
        self.substituted(&|part| match part {
            Self::Call(Function::Sign, x) => Some(smooth(x)),
            Self::Call(Function::Abs, a) => match &**a {
                Self::Call(Function::Sign, x) => Some(Self::power(smooth(x), 2)),
                _ => None,
            },
            _ => None,
        })
    }

    /// The formula with position and velocity multiplied by `ratio`, for example the gear ratio.
    pub fn geared(&self, ratio: &Self) -> Self {
        self.substituted(&|part| {
            let is_motion = matches!(part, Self::Position | Self::Velocity);
            is_motion.then(|| Self::product(ratio.clone(), part.clone()))
        })
    }

    /// The function value `f(a)`, for example `sin(a)`.
    pub fn call(function: Function, a: Self) -> Self {
        match a {
            Self::Number(value) => Self::Number(function.evaluate(value)),
            other => Self::Call(function, Box::new(other)),
        }
    }
}

fn power(base: f64, exponent: u32) -> f64 {
    (0..exponent).fold(1.0, |product, _| product * base)
}
