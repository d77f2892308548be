//! Converts Symbolica's expanded sums to real Fourier sums. Pairs of phases `E = e^{iα}` and E⁻¹ become sines
//! and cosines.

use std::collections::BTreeMap;

use symbolica::atom::{Atom, AtomView};
use symbolica::coefficient::{Coefficient, CoefficientView};
use symbolica::domains::rational::Rational;

use super::algebra::{Kind, Variables};
use super::terms::{Factor, Wave};
use crate::diagnostic::{Diagnostic, Diagnostics};

/// A summand: the product of a rational number, constants, velocities, positions, and a sine or cosine
/// (wave).
#[derive(Debug, Clone)]
pub(super) struct Part {
    pub number: Rational,
    /// Constant symbols of the summand, with exponents.
    pub constants: Vec<(Factor, i32)>,
    /// Velocities, and coordinates of prismatic joints, in the summand, with exponents.
    pub motion: Vec<(Factor, i32)>,
    pub wave: Wave,
}

impl Part {
    /// The summand with the opposite sign.
    pub fn negated(self) -> Self {
        Self { number: -self.number, ..self }
    }
}

/// Constants, velocities and coordinates of a summand. Summands that agree in them differ only in sines and
/// cosines.
type Key = (Vec<(Factor, i32)>, Vec<(Factor, i32)>);

/// Complex factors (real part, imaginary part) of products of phases `E = e^{iα}`. The key contains the
/// exponent of each phase.
type Spectrum = BTreeMap<Vec<i32>, (Rational, Rational)>;

/// Converts an expanded expression to its real summands, in a fixed order. For a product `E^k` of powers of
/// phases `E = e^{iα}`, the two conjugate terms become
///
/// `c E^k + c̄ E^−k = 2 Re c cos(k·α) − 2 Im c sin(k·α)`
///
/// - `phases`: number of angles that have a phase
///
/// # Errors
/// Returns `symbolica-form` if the expression is not a real sum of products of variables. This error is a
/// defect of gelenk.
pub(super) fn parts(variables: Variables<'_>, sum: &Atom, phases: usize) -> Result<Vec<Part>, Diagnostics> {
    let mut spectra: BTreeMap<Key, Spectrum> = BTreeMap::new();
    let view = sum.as_view();
    match view {
        AtomView::Add(summands) => {
            for summand in summands.iter() {
                add(variables, summand, phases, &mut spectra)?;
            }
        }
        single => add(variables, single, phases, &mut spectra)?,
    }
    let mut parts = Vec::new();
    for ((constants, motion), spectrum) in spectra {
        for (number, wave) in real(&spectrum)? {
            parts.push(Part { number, constants: constants.clone(), motion: motion.clone(), wave });
        }
    }
    Ok(parts)
}

fn add(
    variables: Variables<'_>,
    summand: AtomView<'_>,
    phases: usize,
    spectra: &mut BTreeMap<Key, Spectrum>,
) -> Result<(), Diagnostics> {
    let mut product = Product {
        number: (Rational::from(1), Rational::from(0)),
        constants: BTreeMap::new(),
        motion: BTreeMap::new(),
        phases: vec![0; phases],
    };
    match summand {
        AtomView::Mul(factors) => {
            for factor in factors.iter() {
                product.multiply(variables, factor)?;
            }
        }
        single => product.multiply(variables, single)?,
    }
    let key = (product.constants.into_iter().collect(), product.motion.into_iter().collect());
    let zero = || (Rational::from(0), Rational::from(0));
    let place = spectra.entry(key).or_default().entry(product.phases).or_insert_with(zero);
    place.0 = &place.0 + &product.number.0;
    place.1 = &place.1 + &product.number.1;
    Ok(())
}

/// A product of a number, symbols and phases that is read from an expression.
struct Product {
    number: (Rational, Rational),
    constants: BTreeMap<Factor, i32>,
    motion: BTreeMap<Factor, i32>,
    phases: Vec<i32>,
}

impl Product {
    fn multiply(&mut self, variables: Variables<'_>, factor: AtomView<'_>) -> Result<(), Diagnostics> {
        let defect = || unexpected(&factor.to_string());
        let (base, exponent) = match factor {
            AtomView::Num(number) => {
                self.number = number_of(number.get_coeff_view()).ok_or_else(defect)?;
                return Ok(());
            }
            AtomView::Pow(power) => {
                let (base, exponent) = power.get_base_exp();
                let exponent = i32::try_from(exponent).map_err(|_| defect())?;
                (base, exponent)
            }
            single => (single, 1),
        };
        let AtomView::Var(variable) = base else {
            return Err(defect());
        };
        match variables.recognize(variable.get_symbol()).ok_or_else(defect)? {
            (Kind::Constant, k) => *self.constants.entry(Factor::Symbol(k)).or_default() += exponent,
            (Kind::Coordinate, k) => *self.motion.entry(Factor::Coordinate(k)).or_default() += exponent,
            (Kind::Velocity, k) => *self.motion.entry(Factor::Velocity(k)).or_default() += exponent,
            (Kind::Phase, k) => *self.phases.get_mut(k).ok_or_else(defect)? += exponent,
        }
        Ok(())
    }
}

fn number_of(number: CoefficientView<'_>) -> Option<(Rational, Rational)> {
    match number.to_owned() {
        Coefficient::Complex(number) => Some((number.re, number.im)),
        _ => None,
    }
}

/// Converts products of phases `E = e^{iα}` with complex factors to sines and cosines with real factors. The
/// first non-zero multiple of an angle in each sine or cosine is positive.
fn real(spectrum: &Spectrum) -> Result<Vec<(Rational, Wave)>, Diagnostics> {
    let mut waves = Vec::new();
    let zero = Rational::from(0);
    let two = Rational::from(2);
    for (multiples, (re, im)) in spectrum {
        let opposite: Vec<i32> = multiples.iter().map(|k| -k).collect();
        let partner = spectrum.get(&opposite);
        if partner.is_none_or(|(other_re, other_im)| other_re != re || *other_im != -im.clone()) {
            return Err(unexpected("an expression that is not real"));
        }
        match multiples.iter().find(|&&k| k != 0) {
            None => waves.push((re.clone(), Wave::None)),
            Some(&first) if first > 0 => {
                waves.push((&two * re, Wave::Cosine(multiples.clone())));
                waves.push((-(&two * im), Wave::Sine(multiples.clone())));
            }
            Some(_) => {}
        }
    }
    waves.retain(|(number, _)| *number != zero);
    Ok(waves)
}

fn unexpected(what: &str) -> Diagnostics {
    let defect =
        Diagnostic::error("symbolica-form", format!("the closed form contains an unexpected part: {what}"))
            .help("this is a defect of gelenk; please report it with the description");
    Diagnostics::new(vec![defect])
}
