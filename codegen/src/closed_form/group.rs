//! Groups constants. A sum of constants that is a common factor becomes a lumped constant, which gets one
//! symbol. Summands with common factors are collected in brackets.

use std::collections::BTreeMap;

use symbolica::domains::rational::Rational;

use super::fourier::Part;
use super::symbols::Symbol;
use super::terms::{Factor, Monomial, Number, Sum, Term, Wave};
use gelenk_formula::Formula;

/// A product of symbols, each with its exponent.
type Factors = Vec<(Factor, i32)>;

/// A sum of products with rational numbers.
type Polynomial = Vec<(Factors, Rational)>;

/// Largest number of symbols in a constant product that gets no symbol of its own.
const SHORT: i32 = 2;

/// The lumped constants that were found so far. A lumped constant is a constant sum of products with its own
/// symbol.
#[derive(Debug, Default)]
pub(super) struct Constants {
    found: Vec<Polynomial>,
}

impl Constants {
    /// Groups the summands of one entry of the equations of motion.
    ///
    /// - `basis`: function that multiplies all summands, with the index of its coordinate
    /// - `symbols`: all symbols; visible symbols do not become part of a lumped constant
    pub fn group(&mut self, parts: &[Part], symbols: &[Symbol], basis: Option<&(Formula, usize)>) -> Sum {
        let mut hidden: BTreeMap<(Wave, Factors, Factors), Polynomial> = BTreeMap::new();
        for part in parts {
            let (visible, lumped) = part
                .constants
                .iter()
                .partition(|(factor, _)| matches!(factor, Factor::Symbol(k) if symbols[*k].is_visible));
            let key = (part.wave.clone(), visible, part.motion.clone());
            let summand = (lumped, part.number.clone());
            hidden.entry(key).or_default().push(summand);
        }
        let mut bracketed: BTreeMap<(Wave, Factors), Polynomial> = BTreeMap::new();
        for ((wave, visible, motion), polynomial) in hidden {
            let (number, mut factors) = self.letter(polynomial);
            factors.extend(visible);
            let inner = bracketed.entry((wave, factors)).or_default();
            inner.push((motion, number));
        }
        let term = |((wave, factors), inner): ((Wave, Factors), Polynomial)| {
            let content = content(&inner);
            Term {
                outer: monomial(&content, factors),
                wave,
                inner: inner
                    .into_iter()
                    .map(|(motion, number)| monomial(&(&number / &content), motion))
                    .collect(),
                basis: basis.cloned(),
            }
        };
        bracketed.into_iter().map(term).collect()
    }

    /// Definitions of the lumped constants as sums of monomials.
    pub fn definitions(self) -> Vec<Vec<Monomial>> {
        let definition = |polynomial: Polynomial| {
            let summands = polynomial.into_iter();
            summands.map(|(factors, number)| monomial(&number, factors)).collect()
        };
        self.found.into_iter().map(definition).collect()
    }

    /// Writes a constant polynomial as the product of a number and symbols. A long polynomial becomes a
    /// lumped constant with its own symbol.
    fn letter(&mut self, mut polynomial: Polynomial) -> (Rational, Factors) {
        polynomial.sort_by(|a, b| a.0.cmp(&b.0));
        if let [(factors, number)] = polynomial.as_slice()
            && factors.iter().map(|(_, exponent)| exponent.abs()).sum::<i32>() <= SHORT
        {
            return (number.clone(), factors.clone());
        }
        let known = self
            .found
            .iter()
            .enumerate()
            .find_map(|(index, known)| ratio(&polynomial, known).map(|ratio| (ratio, index)));
        let (number, index) = known.unwrap_or_else(|| {
            let content = content(&polynomial);
            let scaled = polynomial.into_iter();
            self.found.push(scaled.map(|(factors, number)| (factors, &number / &content)).collect());
            (content, self.found.len() - 1)
        });
        (number, vec![(Factor::Constant(index), 1)])
    }
}

/// The quotient `a / b` if it is a number; otherwise `None`.
fn ratio(a: &Polynomial, b: &Polynomial) -> Option<Rational> {
    let first = &a.first()?.1 / &b.first()?.1;
    let pairs = a.iter().zip(b);
    let is_multiple = a.len() == b.len()
        && pairs.into_iter().all(|((factors, x), (others, y))| factors == others && *x == &first * y);
    is_multiple.then_some(first)
}

/// Factor for all numbers of a sum: the gcd of the numerators divided by the gcd of the denominators. It has
/// the sign of the first number, so the first number is positive after the division by this factor.
fn content(polynomial: &Polynomial) -> Rational {
    let Some((_, first)) = polynomial.first() else {
        return Rational::from(1);
    };
    let (mut numerator, mut denominator) = (first.numerator(), first.denominator());
    for (_, number) in polynomial {
        numerator = numerator.gcd(&number.numerator());
        denominator = denominator.gcd(&number.denominator());
    }
    let size = Rational::from((numerator, denominator));
    if first.is_negative() == size.is_negative() { size } else { -size }
}

fn monomial(number: &Rational, factors: Factors) -> Monomial {
    Monomial { number: shown(number), factors }
}

/// Largest numerator and largest denominator of a number that is printed as a fraction.
const SHORT_FRACTION: i64 = 1000;

fn shown(number: &Rational) -> Number {
    let part = |text: String| text.parse::<i64>().ok();
    let fraction = part(number.numerator().to_string()).zip(part(number.denominator().to_string()));
    Number {
        value: number.to_f64(),
        fraction: fraction.filter(|(n, d)| n.abs() <= SHORT_FRACTION && *d <= SHORT_FRACTION),
    }
}
