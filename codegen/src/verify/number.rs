//! Number types of the independent evaluation: numbers with rounding errors, and with derivatives.

use core::ops::{Add, Div, Mul, Neg, Sub};

use gelenk_kernels::math;

/// A number with its rounding error, or with derivatives.
pub trait Number:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    fn constant(x: f64) -> Self;
    fn value(self) -> f64;
    fn sin_cos(self) -> (Self, Self);
    fn tanh(self) -> Self;
    fn exp(self) -> Self;
    fn sqrt(self) -> Self;
    fn abs(self) -> Self;
    fn sign(self) -> Self;
    /// This value with the rounding error of another number.
    fn with_error_of(self, other: Self) -> Self;
    /// The larger magnitude and the larger rounding error of two numbers.
    fn larger(self, other: Self) -> Self;
    /// This value with only its own rounding error.
    fn exact(self) -> Self;

    fn zero() -> Self {
        Self::constant(0.0)
    }
}

/// A number with its running error (Higham 2002, section 3.3): a bound of its rounding error in units of the
/// unit roundoff. Numbers of the description count as rounded. Sines and cosines count as numbers of
/// magnitude 1, so a result that is zero at a special angle has the error of nearby angles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    pub value: f64,
    pub error: f64,
}

impl Measured {
    /// A value with the rounding error of its terms and its own rounding error.
    fn rounded(value: f64, error: f64) -> Self {
        Self { value, error: error + value.abs() }
    }
}

impl Add for Measured {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::rounded(self.value + other.value, self.error + other.error)
    }
}

impl Sub for Measured {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Measured {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let of_errors = f64::EPSILON * self.error * other.error;
        let error = self.value.abs() * other.error + other.value.abs() * self.error + of_errors;
        Self::rounded(self.value * other.value, error)
    }
}

impl Div for Measured {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        Self::rounded(value, (self.error + value.abs() * other.error) / other.value.abs())
    }
}

impl Neg for Measured {
    type Output = Self;
    fn neg(self) -> Self {
        Self { value: -self.value, ..self }
    }
}

impl Number for Measured {
    fn constant(x: f64) -> Self {
        Self::rounded(x, 0.0)
    }

    fn value(self) -> f64 {
        self.value
    }

    fn sin_cos(self) -> (Self, Self) {
        let (sine, cosine) = math::sin_cos(self.value);
        (Self { value: sine, error: self.error + 1.0 }, Self { value: cosine, error: self.error + 1.0 })
    }

    fn tanh(self) -> Self {
        Self { value: math::tanh(self.value), error: self.error + 1.0 }
    }

    fn exp(self) -> Self {
        let value = math::exp(self.value);
        Self::rounded(value, value * self.error)
    }

    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        Self::rounded(root, 0.5 * self.error / root)
    }

    fn abs(self) -> Self {
        Self { value: self.value.abs(), ..self }
    }

    fn sign(self) -> Self {
        Self::constant(if self.value == 0.0 { 0.0 } else { self.value.signum() })
    }

    fn with_error_of(self, other: Self) -> Self {
        Self { value: self.value, error: other.error }
    }

    fn larger(self, other: Self) -> Self {
        Self { value: self.value.abs().max(other.value.abs()), error: self.error.max(other.error) }
    }

    fn exact(self) -> Self {
        Self::constant(self.value)
    }
}

/// A number and its derivative (Clifford 1873).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dual<T> {
    pub re: T,
    pub eps: T,
}

impl<T: Number> Dual<T> {
    pub fn fixed(re: T) -> Self {
        Self { re, eps: T::zero() }
    }

    /// Chain rule: a function value f(x), and the derivative of x times f′(x).
    fn chain(self, value: T, slope: T) -> Self {
        Self { re: value, eps: self.eps * slope }
    }
}

impl<T: Number> Add for Dual<T> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { re: self.re + other.re, eps: self.eps + other.eps }
    }
}

impl<T: Number> Sub for Dual<T> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self { re: self.re - other.re, eps: self.eps - other.eps }
    }
}

impl<T: Number> Mul for Dual<T> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self { re: self.re * other.re, eps: self.re * other.eps + self.eps * other.re }
    }
}

impl<T: Number> Div for Dual<T> {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let quotient = self.re / other.re;
        Self { re: quotient, eps: (self.eps - quotient * other.eps) / other.re }
    }
}

impl<T: Number> Neg for Dual<T> {
    type Output = Self;
    fn neg(self) -> Self {
        Self { re: -self.re, eps: -self.eps }
    }
}

impl<T: Number> Number for Dual<T> {
    fn constant(x: f64) -> Self {
        Self::fixed(T::constant(x))
    }

    fn value(self) -> f64 {
        self.re.value()
    }

    fn sin_cos(self) -> (Self, Self) {
        let (sine, cosine) = self.re.sin_cos();
        (self.chain(sine, cosine), self.chain(cosine, -sine))
    }

    fn tanh(self) -> Self {
        let value = self.re.tanh();
        self.chain(value, T::constant(1.0) - value * value)
    }

    fn exp(self) -> Self {
        let value = self.re.exp();
        self.chain(value, value)
    }

    fn sqrt(self) -> Self {
        let value = self.re.sqrt();
        self.chain(value, T::constant(0.5) / value)
    }

    fn abs(self) -> Self {
        self.chain(self.re.abs(), self.re.sign())
    }

    fn sign(self) -> Self {
        Self::fixed(self.re.sign())
    }

    fn with_error_of(self, other: Self) -> Self {
        Self { re: self.re.with_error_of(other.re), eps: self.eps.with_error_of(other.eps) }
    }

    fn larger(self, other: Self) -> Self {
        Self { re: self.re.larger(other.re), eps: self.eps.larger(other.eps) }
    }

    fn exact(self) -> Self {
        Self { re: self.re.exact(), eps: self.eps.exact() }
    }
}
