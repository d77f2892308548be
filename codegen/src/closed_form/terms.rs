//! Closed forms as data (sums of products), independent of the computer algebra.

use super::symbols::Symbol;
use crate::numeric::{power, sin_cos};
use gelenk_formula::Formula;

/// `M(y) ÿ + k(y, ẏ) = q(y, ẏ) + B u` in closed form, with symbolic parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct ClosedForms {
    /// The robot's name.
    pub robot: String,
    /// Names of the coordinates y₁ … yₙ.
    pub coordinates: Vec<String>,
    /// Names of the inputs u₁ … uₘ.
    pub inputs: Vec<String>,
    /// Symbols for the numbers of the description.
    pub symbols: Vec<Symbol>,
    /// Constant angles of slanted joints and rotors.
    pub angles: Vec<Symbol>,
    /// Lumped constants p₁, p₂, …: sums of products of masses, lengths and inertias.
    pub constants: Vec<Vec<Monomial>>,
    /// M, `[n × n]`.
    pub mass_matrix: Vec<Vec<Sum>>,
    /// k, `[n]`.
    pub coriolis_forces: Vec<Sum>,
    /// q, `[n]`.
    pub applied_forces: Vec<Sum>,
    /// B, `[n × m]`.
    pub input_matrix: Vec<Vec<Sum>>,
}

/// A rational number, also as a fraction if that is short.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Number {
    /// Value of the number.
    pub value: f64,
    /// Numerator and denominator.
    pub fraction: Option<(i64, i64)>,
}

/// A factor of a monomial.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Factor {
    /// Lumped constant, by index.
    Constant(usize),
    /// Symbol, by index.
    Symbol(usize),
    /// Coordinate of a prismatic joint, by index.
    Coordinate(usize),
    /// Velocity, by index.
    Velocity(usize),
}

/// `number · Π factorᵉ`
#[derive(Debug, Clone, PartialEq)]
pub struct Monomial {
    /// The rational factor.
    pub number: Number,
    /// Factors with their non-zero exponents.
    pub factors: Vec<(Factor, i32)>,
}

/// Sine or cosine of an integer combination of angles.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub enum Wave {
    /// The constant 1.
    None,
    /// `cos(Σ kᵢ αᵢ)`; α are the coordinates, then the constant angles.
    Cosine(Vec<i32>),
    /// `sin(Σ kᵢ αᵢ)`
    Sine(Vec<i32>),
}

/// `outer · wave · (Σ inner) · basis`
#[derive(Debug, Clone, PartialEq)]
pub struct Term {
    /// Number and constants.
    pub outer: Monomial,
    /// Sine or cosine.
    pub wave: Wave,
    /// Velocities and prismatic coordinates; never empty.
    pub inner: Vec<Monomial>,
    /// Friction law or spring as a function of one coordinate's y and ẏ, and the index of the coordinate.
    pub basis: Option<(Formula, usize)>,
}

/// A sum of terms; an empty sum is 0.
pub type Sum = Vec<Term>;

/// Values at one state.
#[derive(Debug, Clone, PartialEq)]
pub struct Values {
    /// M, `[n × n]`.
    pub mass_matrix: Vec<Vec<f64>>,
    /// k, `[n]`.
    pub coriolis_forces: Vec<f64>,
    /// q, `[n]`.
    pub applied_forces: Vec<f64>,
    /// B, `[n × m]`.
    pub input_matrix: Vec<Vec<f64>>,
}

impl ClosedForms {
    /// Evaluates the formulas at a state with these values of the free parameters; `NaN` if a value is
    /// missing.
    ///
    /// - `y`, `v`: coordinates and velocities, `n` each
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

    /// Value of a lumped constant.
    pub fn constant_value(&self, index: usize, parameters: &[f64]) -> f64 {
        let state = State::new(self, parameters, &[], &[]);
        state.constants.get(index).copied().unwrap_or(f64::NAN)
    }
}

/// Values of everything that formulas name.
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
