//! Bounds of a force law over all positions and velocities, by interval arithmetic.

use gelenk_formula::{Formula, Function};

/// Lower and upper bound of a formula's values. Both may be infinite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Range {
    low: f64,
    high: f64,
}

impl Range {
    const ALL: Self = Self { low: f64::NEG_INFINITY, high: f64::INFINITY };

    /// Bounds of a formula over all positions and velocities. `parameters` are the values of free parameters.
    pub(super) fn of(formula: &Formula, parameters: &[f64]) -> Self {
        let go = |part: &Formula| Self::of(part, parameters);
        match formula {
            Formula::Number(_) | Formula::Parameter(_) => Self::at(formula.evaluate(parameters, 0.0, 0.0)),
            Formula::Position | Formula::Velocity => Self::ALL,
            Formula::Negate(a) => go(a).negated(),
            Formula::Add(a, b) => go(a).plus(go(b)),
            Formula::Subtract(a, b) => go(a).plus(go(b).negated()),
            Formula::Multiply(a, b) if a == b => go(a).squared(),
            Formula::Multiply(a, b) => go(a).times(go(b)),
            Formula::Divide(a, b) => go(a).over(go(b)),
            Formula::Power(a, exponent) => go(a).power(*exponent),
            Formula::Call(function, a) => go(a).call(*function),
        }
    }

    /// The largest magnitude of a value within the bounds.
    pub(super) fn magnitude(self) -> f64 {
        self.high.max(-self.low)
    }

    fn at(value: f64) -> Self {
        Self::between(value, value)
    }

    /// The range from `low` to `high`. If a bound is NaN, the range is unbounded.
    fn between(low: f64, high: f64) -> Self {
        if low.is_nan() || high.is_nan() { Self::ALL } else { Self { low, high } }
    }

    fn negated(self) -> Self {
        Self { low: -self.high, high: -self.low }
    }

    fn plus(self, other: Self) -> Self {
        Self::between(self.low + other.low, self.high + other.high)
    }

    fn times(self, other: Self) -> Self {
        let product = |a: f64, b: f64| if a == 0.0 || b == 0.0 { 0.0 } else { a * b };
        let products = [self.low, self.high].map(|a| [product(a, other.low), product(a, other.high)]);
        Self::hull(products.as_flattened())
    }

    fn over(self, other: Self) -> Self {
        if other.low <= 0.0 && other.high >= 0.0 {
            return Self::ALL;
        }
        self.times(Self { low: 1.0 / other.high, high: 1.0 / other.low })
    }

    fn squared(self) -> Self {
        let magnitude = self.call(Function::Abs);
        magnitude.times(magnitude)
    }

    fn power(self, exponent: u32) -> Self {
        match exponent {
            0 => Self::at(1.0),
            1 => self,
            n if n % 2 == 0 => self.squared().power(n / 2),
            n => self.power(n - 1).times(self),
        }
    }

    fn call(self, function: Function) -> Self {
        match function {
            Function::Sin | Function::Cos => Self { low: -1.0, high: 1.0 },
            Function::Tanh | Function::Exp | Function::Sign => {
                Self::between(function.evaluate(self.low), function.evaluate(self.high))
            }
            Function::Sqrt if self.low < 0.0 => Self::ALL,
            Function::Sqrt => Self::between(self.low.sqrt(), self.high.sqrt()),
            Function::Abs if self.low >= 0.0 => self,
            Function::Abs => Self { low: self.high.min(0.0).abs(), high: self.magnitude() },
        }
    }

    fn hull(values: &[f64]) -> Self {
        let low = values.iter().fold(f64::INFINITY, |least, x| least.min(*x));
        let high = values.iter().fold(f64::NEG_INFINITY, |most, x| most.max(*x));
        Self::between(low, high)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test fails by panicking")]
mod tests {
    use super::*;
    use gelenk_formula::{Allowed, parse};
    use std::collections::BTreeMap;

    fn force_law(text: &str) -> Formula {
        parse(text, Allowed::Motion, &BTreeMap::new()).unwrap()
    }

    fn largest(text: &str) -> f64 {
        Range::of(&force_law(text), &[]).magnitude()
    }

    #[test]
    fn laws_that_saturate_are_bounded() {
        assert_eq!(largest("0.1*tanh(50*v)"), 0.1);
        assert_eq!(largest("0.3*sign(v) - 0.2*abs(sign(v))"), 0.5);
        assert_eq!(largest("0.2*(1 + 0.5*cos(y))*tanh(v)"), 0.2 * 1.5);
        assert_eq!(largest("(0.1 + 0.2*exp(-3*abs(v)))*tanh(v)"), 0.1 + 0.2);
        assert_eq!(largest("0.4/(1 + v*v)"), 0.4);
        assert_eq!(largest("0.4/(1 + pow(v, 4))"), 0.4);
    }

    #[test]
    fn laws_that_grow_are_not() {
        for text in ["0.01*v", "v*exp(-abs(v))", "exp(v)", "0.1/v", "y*tanh(v)", "0.1*abs(v)"] {
            assert_eq!(largest(text), f64::INFINITY, "{text}");
        }
    }

    #[test]
    fn bounds_hold_on_a_grid() {
        let texts = [
            "0.5*sin(3*y)*tanh(2*v) + pow(cos(v), 3)",
            "exp(-pow(v, 2))*sign(y) - 0.3/(2 + sin(v))",
            "abs(tanh(v) - 0.4)*abs(sin(y) - 2)",
        ];
        for text in texts {
            let (formula, bound) = (force_law(text), largest(text));
            for k in 0..400 {
                let (y, v) = (f64::from(k % 20) - 9.7, f64::from(k / 20) - 9.9);
                let value = formula.evaluate(&[], y, v);
                assert!(value.abs() <= bound, "{text} is {value} at {y}, {v}, beyond {bound}");
            }
        }
    }
}
