//! Closed forms as data: sums of products, without expressions of Symbolica.

use super::symbols::Symbol;
use crate::numeric::{power, sin_cos};
use gelenk_formula::Formula;

/// Closed forms of the terms in the equations of motion `M(y) ÿ + k(y, ẏ) = q(y, ẏ) + B u`, with n
/// coordinates y and m inputs u.
#[derive(Debug, Clone, PartialEq)]
pub struct ClosedForms {
    /// Name of the robot in the description.
    pub robot: String,
    /// Names of the coordinates y₁ … yₙ.
    pub coordinates: Vec<String>,
    /// Names of the inputs u₁ … uₘ.
    pub inputs: Vec<String>,
    /// Symbols for the numbers of the description.
    pub symbols: Vec<Symbol>,
    /// Symbols of the constant angles of joints and rotors that are not multiples of 90°.
    pub angles: Vec<Symbol>,
    /// Definitions of the lumped constants p₁, p₂, … as sums of products of masses, lengths and inertias.
    pub constants: Vec<Vec<Monomial>>,
    /// Mass matrix M, `[n × n]` for n coordinates.
    pub mass_matrix: Vec<Vec<Sum>>,
    /// Coriolis, centrifugal and gyroscopic forces k, `[n]` for n coordinates.
    pub coriolis_forces: Vec<Sum>,
    /// Applied forces q (gravity, springs, friction), `[n]` for n coordinates.
    pub applied_forces: Vec<Sum>,
    /// Input matrix B, `[n × m]` for n coordinates and m inputs.
    pub input_matrix: Vec<Vec<Sum>>,
}

/// A rational number as a factor of a product.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Number {
    /// Value of the number in double precision.
    pub value: f64,
    /// Numerator and denominator; `None` if they are too long to print.
    pub fraction: Option<(i64, i64)>,
}

/// A factor of a product: a constant, a symbol, a coordinate or a velocity.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Factor {
    /// The lumped constant with this index in [`ClosedForms::constants`].
    Constant(usize),
    /// The symbol with this index in [`ClosedForms::symbols`].
    Symbol(usize),
    /// The coordinate with this index. It is the position of a prismatic joint.
    Coordinate(usize),
    /// The velocity of the coordinate with this index.
    Velocity(usize),
}

/// A product `number · Π factorᵉ` with integer exponents e.
#[derive(Debug, Clone, PartialEq)]
pub struct Monomial {
    /// Rational number that multiplies the other factors.
    pub number: Number,
    /// Factors with their non-zero exponents.
    pub factors: Vec<(Factor, i32)>,
}

/// Sine or cosine of a sum of angles with integer multiples.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub enum Wave {
    /// The constant 1 instead of a sine or cosine.
    None,
    /// Cosine `cos(Σ kᵢ αᵢ)` with the multiples k. The angles α are the coordinates, then
    /// [`ClosedForms::angles`].
    Cosine(Vec<i32>),
    /// Sine `sin(Σ kᵢ αᵢ)` with the multiples k. The angles α are the coordinates, then
    /// [`ClosedForms::angles`].
    Sine(Vec<i32>),
}

/// A product `outer · wave · (Σ inner) · basis` of constants, a sine or cosine, velocities and a basis
/// function of a force law.
#[derive(Debug, Clone, PartialEq)]
pub struct Term {
    /// Number and constant symbols of the term.
    pub outer: Monomial,
    /// Sine or cosine in the term, or 1.
    pub wave: Wave,
    /// Sum of products of velocities and coordinates of prismatic joints. It has at least one summand.
    pub inner: Vec<Monomial>,
    /// Basis function of a friction law or spring, and the index of the coordinate whose position y and
    /// velocity ẏ are its arguments; `None` for other terms.
    pub basis: Option<(Formula, usize)>,
}

/// A sum of terms. An empty sum is 0.
pub type Sum = Vec<Term>;

/// Values of the terms M, k, q and B of the equations of motion at one state.
#[derive(Debug, Clone, PartialEq)]
pub struct Values {
    /// Mass matrix M, `[n × n]` for n coordinates.
    pub mass_matrix: Vec<Vec<f64>>,
    /// Coriolis, centrifugal and gyroscopic forces k, `[n]` for n coordinates.
    pub coriolis_forces: Vec<f64>,
    /// Applied forces q (gravity, springs, friction), `[n]` for n coordinates.
    pub applied_forces: Vec<f64>,
    /// Input matrix B, `[n × m]` for n coordinates and m inputs.
    pub input_matrix: Vec<Vec<f64>>,
}

impl ClosedForms {
    /// Evaluates the terms M, k, q and B of the equations of motion at a state. A result is `NaN` if it
    /// depends on a value that is missing in an argument.
    ///
    /// - `parameters`: values of the free parameters
    /// - `y`, `v`: coordinates and velocities, n entries each
    pub fn evaluate(&self, parameters: &[f64], y: &[f64], v: &[f64]) -> Values {
        let state = State::new(self, parameters, y, v);
        let rows = |rows: &[Vec<Sum>]| rows.iter().map(|row| state.sums(row)).collect();
        Values {
            mass_matrix: rows(&self.mass_matrix),
            coriolis_forces: state.sums(&self.coriolis_forces),
            applied_forces: state.sums(&self.applied_forces),
            input_matrix: rows(&self.input_matrix),
        }
    }

    /// Value of the lumped constant `index` for these values of the free parameters; `NaN` if there is no
    /// such constant.
    pub fn constant_value(&self, index: usize, parameters: &[f64]) -> f64 {
        let state = State::new(self, parameters, &[], &[]);
        state.constants.get(index).copied().unwrap_or(f64::NAN)
    }
}

/// Values of the constants, coordinates and velocities that occur in formulas.
struct State<'a> {
    symbols: Vec<f64>,
    constants: Vec<f64>,
    angles: Vec<f64>,
    parameters: &'a [f64],
    y: &'a [f64],
    v: &'a [f64],
}

impl<'a> State<'a> {
    fn new(forms: &ClosedForms, parameters: &'a [f64], y: &'a [f64], v: &'a [f64]) -> Self {
        let value = |symbol: &Symbol| symbol.value.evaluate(parameters, 0.0, 0.0);
        let mut state = Self {
            symbols: forms.symbols.iter().map(value).collect(),
            constants: Vec::new(),
            angles: y.iter().copied().chain(forms.angles.iter().map(value)).collect(),
            parameters,
            y,
            v,
        };
        let constant = |sum: &Vec<Monomial>| sum.iter().map(|part| state.monomial(part)).sum();
        let constants = forms.constants.iter().map(constant).collect();
        state.constants = constants;
        state
    }

    fn sums(&self, sums: &[Sum]) -> Vec<f64> {
        let sum = |sum: &Sum| sum.iter().map(|term| self.term(term)).sum();
        sums.iter().map(sum).collect()
    }

    fn term(&self, term: &Term) -> f64 {
        let wave = match &term.wave {
            Wave::None => 1.0,
            Wave::Cosine(multiples) => sin_cos(self.angle(multiples)).1,
            Wave::Sine(multiples) => sin_cos(self.angle(multiples)).0,
        };
        let inner: f64 = term.inner.iter().map(|part| self.monomial(part)).sum();
        let basis = term.basis.as_ref().map_or(1.0, |(basis, of)| {
            basis.evaluate(self.parameters, entry(self.y, *of), entry(self.v, *of))
        });
        self.monomial(&term.outer) * wave * inner * basis
    }

    fn angle(&self, multiples: &[i32]) -> f64 {
        let parts = multiples.iter().zip(&self.angles);
        parts.map(|(k, angle)| f64::from(*k) * angle).sum()
    }

    fn monomial(&self, monomial: &Monomial) -> f64 {
        let factor = |(factor, exponent): &(Factor, i32)| {
            let base = match *factor {
                Factor::Constant(index) => entry(&self.constants, index),
                Factor::Symbol(index) => entry(&self.symbols, index),
                Factor::Coordinate(index) => entry(self.y, index),
                Factor::Velocity(index) => entry(self.v, index),
            };
            power(base, *exponent)
        };
        monomial.number.value * monomial.factors.iter().map(factor).product::<f64>()
    }
}

fn entry(values: &[f64], index: usize) -> f64 {
    values.get(index).copied().unwrap_or(f64::NAN)
}
