//! Vectors and matrices of Symbolica's expressions (atoms).
//!
//! Sines and cosines are written with phases `E = e^{iα}`: `cos α = (E + E⁻¹)/2`, `sin α = (E − E⁻¹)/2i`.
//! Trigonometric identities become plain arithmetic. Expansion is enough for simplification, because equal
//! expressions become the same Fourier sum.

use symbolica::atom::{Atom, AtomCore, Symbol};
use symbolica::symbol;

use super::lock::Instance;
use gelenk_formula::Formula;

/// A vector of three expressions.
pub(super) type Vector = [Atom; 3];

/// A 3 × 3 matrix of expressions, as a list of rows.
pub(super) type Matrix = [[Atom; 3]; 3];

/// Largest number of variables of one kind, for example of velocities.
const VARIABLES: usize = 1000;

/// Symbolica's variables of a derivation, each with a kind and an index. They borrow the [`Instance`] that
/// permits the use of Symbolica.
#[derive(Debug, Clone, Copy)]
pub(super) struct Variables<'i> {
    _instance: &'i Instance,
}

/// Quantity for which a variable stands in Symbolica's expressions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// Constant of the model, for example a mass or a length.
    Constant,
    /// Phase `e^{iα}` of an angle α.
    Phase,
    /// Coordinate of a prismatic joint, which occurs in expressions without a phase.
    Coordinate,
    /// Velocity of a coordinate, with the index of the coordinate.
    Velocity,
}

impl Kind {
    const ALL: [Self; 4] = [Self::Constant, Self::Phase, Self::Coordinate, Self::Velocity];

    fn prefix(self) -> &'static str {
        match self {
            Self::Constant => "c",
            Self::Phase => "e",
            Self::Coordinate => "y",
            Self::Velocity => "v",
        }
    }
}

impl<'i> Variables<'i> {
    pub fn new(instance: &'i Instance) -> Self {
        Self { _instance: instance }
    }

    pub fn symbol(self, kind: Kind, index: usize) -> Symbol {
        symbol!(format!("gelenk::{}{index}", kind.prefix()))
    }

    pub fn atom(self, kind: Kind, index: usize) -> Atom {
        Atom::var(self.symbol(kind, index))
    }

    /// Kind and index of the variable with this symbol; `None` if the symbol is not a variable of the
    /// derivation.
    pub fn recognize(self, symbol: Symbol) -> Option<(Kind, usize)> {
        let name = symbol.get_stripped_name();
        let kind = Kind::ALL.into_iter().find(|kind| name.starts_with(kind.prefix()))?;
        let index = name.get(1..)?.parse().ok().filter(|&index| index < VARIABLES)?;
        Some((kind, index))
    }

    /// Power `e^{i n α}` of the phase of an angle α with the integer `n`.
    fn phase(self, index: usize, exponent: i64) -> Atom {
        self.atom(Kind::Phase, index).pow(Atom::num(exponent))
    }

    pub fn cosine(self, index: usize) -> Atom {
        (self.phase(index, 1) + self.phase(index, -1)) * Atom::num((1, 2))
    }

    pub fn sine(self, index: usize) -> Atom {
        (self.phase(index, -1) - self.phase(index, 1)) * Atom::num((1, 2)) * Atom::i()
    }

    /// Derivative `∂f/∂y = i E ∂f/∂E` with respect to the angle y with this index. E is the phase `e^{iy}`.
    pub fn by_angle(self, f: &Atom, index: usize) -> Atom {
        let slope = f.derivative(self.symbol(Kind::Phase, index));
        (slope * self.phase(index, 1) * Atom::i()).expand()
    }

    /// Derivative `∂f/∂y` with respect to the coordinate y of a prismatic joint.
    pub fn by_position(self, f: &Atom, index: usize) -> Atom {
        f.derivative(self.symbol(Kind::Coordinate, index)).expand()
    }

    /// Derivative `∂f/∂ẏ` with respect to the velocity ẏ with this index.
    pub fn by_velocity(self, f: &Atom, index: usize) -> Atom {
        f.derivative(self.symbol(Kind::Velocity, index)).expand()
    }

    /// Converts a formula of numbers and parameters to an expression. Divisors of the formula must be
    /// products, and the formula must not call functions.
    pub fn formula(self, formula: &Formula) -> Atom {
        let go = |part: &Formula| self.formula(part);
        match formula {
            Formula::Number(value) => number(*value),
            Formula::Parameter(index) => self.atom(Kind::Constant, *index),
            Formula::Negate(a) => -go(a),
            Formula::Add(a, b) => go(a) + go(b),
            Formula::Subtract(a, b) => go(a) - go(b),
            Formula::Multiply(a, b) => go(a) * go(b),
            Formula::Divide(a, b) => go(a) / go(b),
            Formula::Power(a, exponent) => go(a).pow(Atom::num(i64::from(*exponent))),
            // This case does not occur, because the caller replaces these parts by symbols.
            Formula::Position | Formula::Velocity | Formula::Call(..) => zero(),
        }
    }
}

pub(super) fn zero() -> Atom {
    Atom::num(0)
}

/// The number as an exact decimal fraction.
pub(super) fn number(value: f64) -> Atom {
    let shown = format!("{value:e}");
    let (mantissa, exponent) = shown.split_once('e').unwrap_or((&shown, "0"));
    let decimals = mantissa.split_once('.').map_or(0, |(_, digits)| digits.len() as i64);
    // An i64 holds the digits, of which there are at most 17. The exponent of an f64 has at most three
    // digits.
    let digits: i64 = mantissa.replace('.', "").parse().unwrap_or(0);
    let exponent = exponent.parse::<i64>().unwrap_or(0) - decimals;
    Atom::num(digits) * Atom::num(10).pow(Atom::num(exponent))
}

/// Scalar product `a · b`.
pub(super) fn dot(a: &Vector, b: &Vector) -> Atom {
    let sum = (0..3).fold(zero(), |sum, k| sum + &a[k] * &b[k]);
    sum.expand()
}

/// Product `R v` of a matrix R and a vector v.
pub(super) fn rotate(r: &Matrix, v: &Vector) -> Vector {
    std::array::from_fn(|i| dot(&r[i], v))
}

/// Product `A B` of two matrices.
pub(super) fn product(a: &Matrix, b: &Matrix) -> Matrix {
    let b = transpose(b);
    std::array::from_fn(|i| std::array::from_fn(|j| dot(&a[i], &b[j])))
}

/// Transposed matrix `Rᵀ`.
pub(super) fn transpose(r: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| r[j][i].clone()))
}

/// Sum of two vectors.
pub(super) fn sum(a: &Vector, b: &Vector) -> Vector {
    std::array::from_fn(|k| (&a[k] + &b[k]).expand())
}

/// Rotation about x (`axis` = 0), y (1) or z (2) by the angle with this sine and cosine.
pub(super) fn rotation(axis: usize, sine: &Atom, cosine: &Atom) -> Matrix {
    let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
    std::array::from_fn(|i| {
        std::array::from_fn(|j| match (i, j) {
            _ if i == axis || j == axis => Atom::num(i64::from(i == j)),
            _ if i == j => cosine.clone(),
            (i, j) if (i, j) == (last, next) => sine.clone(),
            _ => -sine,
        })
    })
}

/// The 3 × 3 unit matrix.
pub(super) fn identity() -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| Atom::num(i64::from(i == j))))
}
